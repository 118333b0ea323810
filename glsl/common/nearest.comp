// Entry of the pass pcss.nearest (src/techniques/pcss/mod.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "common/nearest.glsl"

// Writes the largest w of each node of the map. One invocation handles one node.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform texture2D front_depth;
layout(set = 0, binding = 1, std430) buffer Nearest { float nearest[]; };

layout(push_constant) uniform Push {
    int map;        // the map's side in texels
    float inv_near; // 1 over the map's near plane, 1/m
} push;

void main()
{
    ivec2 node = ivec2(gl_GlobalInvocationID.xy);
    int row = nodes_a_row(push.map);
    if (node.x >= row || node.y >= row) {
        return;
    }
    int side = node_side(push.map);
    ivec2 first = node * side;
    ivec2 end = min(first + side, ivec2(push.map));
    float most = 0.0;
    for (int y = first.y; y < end.y; ++y) {
        for (int x = first.x; x < end.x; ++x) {
            most = max(most, texelFetch(front_depth, ivec2(x, y), 0).x);
        }
    }
    nearest[node.y * row + node.x] = most * push.inv_near;
}
