#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// The same at the pixels of the listed tiles.

#define LISTED
#include "baseline/pcss.glsl"
