#version 450
#extension GL_GOOGLE_include_directive : require

// The bounds of a level's windows, from those of the level before it, the first from the columns.
// The same for any kind.

#include "ray_march/level.glsl"
