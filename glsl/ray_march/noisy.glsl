// The visible fraction by rays alone, how widely it is to be filtered, and the surface it is of.
//
// A fraction is one number, or three with `#define COLOR`. The including shader says at which bindings the
// images are: NOISY_BINDING, and SURFACE_BINDING with COLOR.

#ifndef RAY_MARCH_NOISY_GLSL
#define RAY_MARCH_NOISY_GLSL

#include "ray_march/fraction.glsl"
#include "ray_march/normal.glsl"

// The fraction (NO_RECEIVER where there is nothing to filter), the filter's width in metres, the normal.
// Where the fraction is known for sure the width is below 0, and there is no normal.
layout(set = 0, binding = NOISY_BINDING, rgba32f) writeonly uniform image2D noisy;
#ifdef COLOR
layout(set = 0, binding = SURFACE_BINDING, rgba32f) writeonly uniform image2D surfaces;
#endif

const float NO_RECEIVER = -1.0;

void put_noisy(ivec2 p, FRACTION v, float width, vec3 normal)
{
#ifdef COLOR
    imageStore(noisy, p, vec4(v, width));
    imageStore(surfaces, p, vec4(folded(normal), 0.0, 0.0));
#else
    imageStore(noisy, p, vec4(v, width, folded(normal)));
#endif
}

void put_known(ivec2 p, float v)
{
    put_noisy(p, FRACTION(v), -1.0, vec3(0.0, 0.0, 1.0));
}

#endif
