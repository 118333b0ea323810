#version 450
#extension GL_GOOGLE_include_directive : require
#include "ray_march/column.glsl"

// The bounds of the smallest windows, from the columns.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0, std430) readonly buffer Columns { vec4 columns[]; };
layout(set = 0, binding = 1, std430) buffer Bounds { vec4 bounds[]; };

layout(push_constant) uniform Push {
    int map;  // the map's side in texels
    int kind; // of levels
} push;

#define VALUE vec4

vec4 combine(vec4 a, vec4 b)
{
    return max(a, b);
}

vec4 value_at(int level, int index)
{
    return bounds_of(columns[index]);
}

#include "nbuffer/values.glsl"

void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    Levels l = Levels(push.map, push.kind);
    int side = side_of(l, 1);
    if (p.x < side && p.y < side) {
        bounds[index_of(l, 1, p)] = combined(l, 1, p);
    }
}
