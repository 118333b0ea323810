// Entry of the pass views.nearest (src/stages/views/inner.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "common/nearest.glsl"

// Writes the largest w of all nodes among the constants of the passes over the pixels.

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, std430) readonly buffer Nodes { float nodes[]; };
layout(set = 0, binding = 1, std430) buffer Constants { float constants[]; };

layout(push_constant) uniform Push {
    int map; // the map's side in texels
    int at;  // where the number is among the constants of the passes over the pixels
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
        constants[push.at] = most;
    }
}
