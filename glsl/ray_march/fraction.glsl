// What a visible fraction is: of all the light, or with `#define COLOR` of its red, green and blue.

#ifndef RAY_MARCH_FRACTION_GLSL
#define RAY_MARCH_FRACTION_GLSL

#ifdef COLOR
#define FRACTION vec3
#define FRACTION_FORMAT rgba32f
#else
#define FRACTION float
#define FRACTION_FORMAT r32f
#endif

// As an image holds it: alpha is 1, and so are green and blue where there is no color.
vec4 stored_fraction(FRACTION v)
{
#ifdef COLOR
    return vec4(v, 1.0);
#else
    return vec4(v);
#endif
}

#endif
