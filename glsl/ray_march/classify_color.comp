#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// Which pixels are lit or in umbra for sure, and a list of the others, in color.

#define COLOR
#include "ray_march/classify.glsl"
