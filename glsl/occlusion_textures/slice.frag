#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// Counts faces in the channel of their slice, up to 255; blending adds. No order of the faces and no
// optional feature is needed: every device blends into four images of four times eight bits at once.

#define FIRST 0
#include "occlusion_textures/slice.glsl"
