#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// The same at the pixels of the listed tiles.

#define LISTED
#include "occlusion_textures/pixels.glsl"

layout(set = 0, binding = 3) uniform utexture2D filtered;

#include "occlusion_textures/sat.glsl"
#include "occlusion_textures/visibility.glsl"
