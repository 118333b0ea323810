// Entry of the pass pcss.nearest_of_all (src/techniques/pcss/mod.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "common/nearest.glsl"

// Writes the largest w of all nodes behind theirs.

layout(local_size_x = 1) in;

layout(set = 0, binding = 0, std430) buffer Nearest { float nearest[]; };

layout(push_constant) uniform Push {
    int map; // the map's side in texels
} push;

void main()
{
    int nodes = nodes_a_row(push.map) * nodes_a_row(push.map);
    float most = 0.0;
    for (int i = 0; i < nodes; ++i) {
        most = max(most, nearest[i]);
    }
    nearest[nodes] = most;
}
