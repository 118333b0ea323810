#version 450
#extension GL_GOOGLE_include_directive : require
#include "linear_light/tree.glsl"

// A line has its two ends for samples, and its middle is open.

layout(local_size_x = 32) in;

layout(set = 0, binding = 0, std430) buffer Tree {
    float left;
    Node nodes[NODES];
};

void main()
{
    uint node = gl_GlobalInvocationID.x;
    if (node >= uint(NODES)) {
        return;
    }
    uint taken = node < 2u ? 1u : 0u;
    nodes[node] = Node(node < 3u ? 1u : 0u, taken, 0u, 0u);
    if (node == 0u) {
        left = 0.0;
    }
}
