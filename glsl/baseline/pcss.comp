#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// Percentage-closer soft shadows (Fernando 2005): the blockers around a pixel's place in the map say how
// far away they are, and with that how wide the penumbra is that the comparisons are averaged over.

#include "baseline/pcss.glsl"
