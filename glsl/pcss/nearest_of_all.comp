// Entry of the pass pcss.nearest_of_all (src/techniques/pcss/mod.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "common/nearest.glsl"

// Writes the largest w of all nodes behind theirs.

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, std430) buffer Nearest { float nearest[]; };

layout(push_constant) uniform Push {
    int map; // the map's side in texels
} push;

shared float largest[64];

void main()
{
    uint l = gl_LocalInvocationIndex;
    int nodes = nodes_a_row(push.map) * nodes_a_row(push.map);
    float most = 0.0;
    for (int i = int(l); i < nodes; i += 64) {
        most = max(most, nearest[i]);
    }
    largest[l] = most;
    barrier();
    if (l == 0u) {
        for (int i = 1; i < 64; ++i) {
            most = max(most, largest[i]);
        }
        nearest[nodes] = most;
    }
}
