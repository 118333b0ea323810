#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// The visible fraction: kernels of slices from summed-area tables, combined (Eisemann and Decoret 2008,
// sections 3.3 and 3.5).

#include "occlusion_textures/pixels.glsl"

layout(set = 0, binding = 3) uniform utexture2D filtered;

#include "occlusion_textures/sat.glsl"
#include "occlusion_textures/visibility.glsl"
