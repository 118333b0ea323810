// Entered from hierarchy/split.comp, hierarchy/order.comp, hierarchy/boxes.comp and hierarchy/nodes.comp.
//
// The tree's shape. With n leaves, its nodes are numbered 0 to n - 2, the inner ones, with the root first, and from n - 1
// on, the leaves. An inner node is (its first leaf, its last leaf, the last leaf of its first child).

#ifndef HIERARCHY_TOPOLOGY_GLSL
#define HIERARCHY_TOPOLOGY_GLSL

#include "common/lists.glsl"
#include "hierarchy/texels.glsl"

layout(local_size_x = 64) in;

layout(push_constant) uniform Push {
    uint leaves; // how many leaves there are, from 1 on
    uint start;  // the place of a level of the pyramid, and how many boxes it has
    uint count;
} push;

const uint NO_NODE = 0xffffffffu;

// The most bits of two keys, and so the most nodes on a path from a leaf to the root.
const uint DEEPEST = 64u;

uint nth_invocation()
{
    return nth_group(gl_WorkGroupID.xy) * gl_WorkGroupSize.x + gl_LocalInvocationIndex;
}

uint leaf_node(uint leaf)
{
    return push.leaves - 1u + leaf;
}

// The children of an inner node.
uint first_child(uint first, uint split)
{
    return first == split ? leaf_node(split) : split;
}

uint second_child(uint split, uint last)
{
    return split + 1u == last ? leaf_node(last) : split + 1u;
}

#endif
