#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "linear_light/tree.glsl"
#include "linear_light/segment.glsl"

// For every open node of a round: how many receivers are in shadow, and how many of them only this node sees, which
// would be in umbra without it (section 3.3).

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform texture2DArray seen;
layout(set = 0, binding = 1, std430) buffer Tree {
    float left;
    Node nodes[NODES];
};

layout(push_constant) uniform Push {
    vec4 u_window; // least and largest u at the line's first end, at its last
    float line;    // its length, m
    int map;       // the maps' side in texels
    int round;
} push;

// Whether a sample's map has something in front of a receiver that another sees at u and w. Its own surface is in
// none of three neighbours at once, whichever way it leans.
bool is_hidden(int node, float apart, float u, float w, int row)
{
    vec2 window = window_at(push.u_window, along_of(node));
    float x = (u + apart * w - window.x) / (window.y - window.x) * float(push.map);
    int column = int(floor(x));
    if (x < 1.0 || column + 1 >= push.map) {
        return false;
    }
    bool hidden = true;
    for (int i = -1; i <= 1; ++i) {
        float occluder = texelFetch(seen, ivec3(column + i, row, node), 0).x;
        hidden = hidden && occluder > w * (1.0 + 1.0e-6);
    }
    return hidden;
}

void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    int nth = int(gl_GlobalInvocationID.z);
    int node = first_node(push.round) + nth;
    if (p.x >= push.map || p.y >= push.map || nodes[node].open == 0u) {
        return;
    }
    vec2 w = texelFetch(seen, ivec3(p, node), 0).xy;
    if (w.y <= 0.0) {
        return;
    }
    bool hidden = w.x > w.y;
    vec2 window = window_at(push.u_window, along_of(node));
    float u = mix(window.x, window.y, (float(p.x) + 0.5) / float(push.map));
    bool beside = true;
    bool shadowed = hidden;
    for (int i = 0; i < 2; ++i) {
        int other = node_at(2 * (nth + i), push.round);
        float apart = (along_of(node) - along_of(other)) * push.line;
        bool from_there = is_hidden(other, apart, u, w.y, p.y);
        beside = beside && from_there;
        shadowed = shadowed || from_there;
    }
    if (shadowed) {
        atomicAdd(nodes[node].shadowed, 1u);
    }
    if (beside && !hidden) {
        atomicAdd(nodes[node].unseen, 1u);
    }
}
