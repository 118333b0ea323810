#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// Which tiles of pixels meet nothing, by summed-area tables.

#include "occlusion_textures/tiles_sat.glsl"
