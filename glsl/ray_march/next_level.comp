#version 450
#extension GL_GOOGLE_include_directive : require

// The bounds of a level's windows, from those of the level before it.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0, std430) buffer Bounds { vec4 bounds[]; };

layout(push_constant) uniform Push {
    int map;   // the map's side in texels
    int kind;  // of levels
    int level; // the one to make
} push;

#define VALUE vec4

vec4 combine(vec4 a, vec4 b)
{
    return max(a, b);
}

vec4 value_at(int level, int index)
{
    return bounds[index];
}

#include "nbuffer/values.glsl"

void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    Levels l = Levels(push.map, push.kind);
    int side = side_of(l, push.level);
    if (p.x < side && p.y < side) {
        bounds[index_of(l, push.level, p)] = combined(l, push.level, p);
    }
}
