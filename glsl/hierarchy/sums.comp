// Entry of the pass hierarchy.sums (src/stages/hierarchy/sort.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "hierarchy/sort.glsl"

// Replaces each count by the sum of those before it in its block of DIGITS counts, and writes the block's total.

layout(set = 0, binding = 0, std430) buffer Counts { uint counts[]; };
layout(set = 0, binding = 1, std430) buffer Totals { uint totals[]; };

void main()
{
    uint block = nth_invocation();
    // There are DIGITS counts a run, and so as many blocks as runs.
    if (block >= push.runs) {
        return;
    }
    uint sum = 0u;
    for (uint i = block * DIGITS; i < (block + 1u) * DIGITS; ++i) {
        uint count = counts[i];
        counts[i] = sum;
        sum += count;
    }
    totals[block] = sum;
}
