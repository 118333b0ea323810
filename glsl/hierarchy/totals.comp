// Entry of the pass hierarchy.totals (src/stages/hierarchy/sort.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "hierarchy/sort.glsl"

// Replaces each block's total by the sum of those before it. One invocation sums all of them: there is one for 256 keys.

layout(set = 0, binding = 0, std430) buffer Totals { uint totals[]; };

void main()
{
    if (nth_invocation() != 0u) {
        return;
    }
    uint sum = 0u;
    for (uint i = 0u; i < push.runs; ++i) {
        uint total = totals[i];
        totals[i] = sum;
        sum += total;
    }
}
