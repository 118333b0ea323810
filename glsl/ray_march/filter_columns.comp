#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// The listed pixels, filtered along their columns.

#define COLUMNS
#include "ray_march/filter_pass.glsl"
