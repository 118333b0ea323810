// Entry of the pass views.nodes (src/stages/views/inner.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "common/nearest.glsl"

// Finds the nearest occluder before the receivers of the next finer view: the largest w of each node of a wider view's
// map within the region that opens from the light's rim as widely as the finer view's window. No ray from a receiver in
// that region leaves it. One invocation handles one node.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform texture2D front_depth;
layout(set = 0, binding = 1, std430) buffer Nodes { float nodes[]; };

layout(push_constant) uniform Push {
    vec2 texels_per_uv; // map texels a unit of u and v
    vec2 middle;        // texel coordinates of the middle of the finer view's window
    vec2 half_light;    // half the light's width and height, m
    vec2 tangents;      // half the finer view's window in u and in v
    float inv_near;     // the w of the map's near plane
    int map;            // the map's side in texels
} push;

void main()
{
    ivec2 node = ivec2(gl_GlobalInvocationID.xy);
    int row = nodes_a_row(push.map);
    if (node.x >= row || node.y >= row) {
        return;
    }
    int side = node_side(push.map);
    ivec2 begin = node * side;
    ivec2 end = min(begin + side, ivec2(push.map));
    float most = 0.0;
    for (int y = begin.y; y < end.y; ++y) {
        for (int x = begin.x; x < end.x; ++x) {
            float w = texelFetch(front_depth, ivec2(x, y), 0).x * push.inv_near;
            // The texel counts by its point that is nearest to that middle.
            vec2 off = max(abs(vec2(x, y) + 0.5 - push.middle) - 0.5, vec2(0.0)) / push.texels_per_uv;
            bool within = all(lessThanEqual(off, push.half_light * w + push.tangents));
            most = max(most, within ? w : 0.0);
        }
    }
    nodes[node.y * row + node.x] = most;
}
