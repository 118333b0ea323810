// Entry of the pass hierarchy.order (src/stages/hierarchy/mod.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "hierarchy/topology.glsl"

// The place of each node in depth-first order: a first child lies behind its parent, a second child behind the subtree
// of the first, which has two nodes less one for each leaf.

layout(set = 0, binding = 0, std430) readonly buffer Inner { uvec4 inner[]; };
layout(set = 0, binding = 1, std430) readonly buffer Parents { uint parents[]; };
layout(set = 0, binding = 2, std430) buffer Order { uint order[]; };

void main()
{
    uint node = nth_invocation();
    if (node > 2u * (push.leaves - 1u)) {
        return;
    }
    uint place = 0u;
    uint child = node;
    uint parent = parents[node];
    for (uint i = 0u; i < DEEPEST && parent != NO_NODE; ++i) {
        uvec4 of = inner[parent];
        place += child == first_child(of.x, of.z) ? 1u : 2u * (of.z - of.x + 1u);
        child = parent;
        parent = parents[parent];
    }
    order[node] = place;
}
