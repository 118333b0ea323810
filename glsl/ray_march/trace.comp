#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// The rays of the listed pixels.

#define USUAL
#include "ray_march/trace.glsl"
