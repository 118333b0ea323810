#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// The gather at the pixels of the listed tiles.

#define LISTED
#include "soft_shadow_map/gather_pixels.glsl"
