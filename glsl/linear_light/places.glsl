// The image of a light's lines and their samples, a row a line, as pixels ask for them:
//   0     the line's x along the light's x and y; its middle, m
//   1     least and largest u at its first end, at its last
//   2     least and largest v; its length, m; its share of the light
//   3     the number of its samples
//   4...  of each: how far along it is, 0 to 1

#ifndef LINEAR_LIGHT_PLACES_GLSL
#define LINEAR_LIGHT_PLACES_GLSL

const int SAMPLES_AT = 4;

#endif
