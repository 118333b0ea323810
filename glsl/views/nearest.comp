// Entry of the pass views.nearest (src/stages/views/inner.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "common/nearest.glsl"

// Writes the largest w of all nodes among the constants of the passes over the pixels: the nearest occluder before the
// finer view's receivers. It is no less than what keeps the finer view's region within that of the map's own view, whose
// own nearest occluder is there already; below 0 it is none.

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, std430) readonly buffer Nodes { float nodes[]; };
layout(set = 0, binding = 1, std430) buffer Constants { float constants[]; };

layout(push_constant) uniform Push {
    int map; // the map's side in texels
    int at;  // where the number is among the constants of the passes over the pixels
    int own; // where that of the map's own view is
    float most;  // the largest of the own view that counts, 1/m
    float slack; // how much nearer than the finer view's the own view's may be
} push;

shared float largest[64];

void main()
{
    uint l = gl_LocalInvocationIndex;
    int count = nodes_a_row(push.map) * nodes_a_row(push.map);
    float most = 0.0;
    for (int i = int(l); i < count; i += 64) {
        most = max(most, nodes[i]);
    }
    largest[l] = most;
    barrier();
    if (l == 0u) {
        for (int i = 1; i < 64; ++i) {
            most = max(most, largest[i]);
        }
        float own = constants[push.own];
        constants[push.at] = own < 0.0 ? most : max(most, min(own, push.most) - push.slack);
    }
}
