#version 450
#extension GL_GOOGLE_include_directive : require

// The bounds of a level's windows, from those of the level before it, the first from the columns.
// This is an N-buffer's.

#define USUAL
#include "ray_march/level.glsl"
