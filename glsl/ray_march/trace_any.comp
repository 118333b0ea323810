#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// The rays of the listed pixels.
// The same with any settings.

#include "ray_march/trace.glsl"
