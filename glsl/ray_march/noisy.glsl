// The visible fraction by rays alone, how widely it is to be filtered, and the surface it is of.

#ifndef RAY_MARCH_NOISY_GLSL
#define RAY_MARCH_NOISY_GLSL

#include "ray_march/normal.glsl"

// The fraction (NO_RECEIVER where there is nothing to filter), the filter's width in metres, the normal.
// Where the fraction is known for sure the width is below 0, and there is no normal.
layout(set = 0, binding = NOISY_BINDING, rgba32f) writeonly uniform image2D noisy;

const float NO_RECEIVER = -1.0;

void put_known(ivec2 p, float v)
{
    imageStore(noisy, p, vec4(v, -1.0, 0.0, 0.0));
}

void put_noisy(ivec2 p, float v, float width, vec3 normal)
{
    imageStore(noisy, p, vec4(v, width, folded(normal)));
}

#endif
