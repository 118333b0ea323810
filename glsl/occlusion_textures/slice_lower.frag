#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// The same for slices from the seventeenth on.

#define FIRST 16
#include "occlusion_textures/slice.glsl"
