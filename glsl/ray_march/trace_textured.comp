#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// The rays of the listed pixels, each weighed by what the light sends out where it goes.

#define TEXTURED
#include "ray_march/trace.glsl"
