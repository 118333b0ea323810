#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// The same with what correlated slices have.

#define CORRELATED
#include "occlusion_textures/tiles_sat.glsl"
