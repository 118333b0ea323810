#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// The gather at the G-buffer's own pixels: no receiver map, no resampling, and no split into occluders
// and receivers, because a texel counts only where it lies above the pixel's own plane. One invocation
// 2x2 pixels, one lane of each vec4 a pixel.

#include "soft_shadow_map/gather_pixels.glsl"
