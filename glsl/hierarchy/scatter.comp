// Entry of the passes hierarchy.scatter_even and hierarchy.scatter_odd (src/stages/hierarchy/sort.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "hierarchy/sort.glsl"

// Moves the keys of each run to their places by this digit, in order.

layout(set = 0, binding = 0, std430) readonly buffer From { uvec2 from[]; };
layout(set = 0, binding = 1, std430) buffer Counts { uint counts[]; };
layout(set = 0, binding = 2, std430) readonly buffer Totals { uint totals[]; };
layout(set = 0, binding = 3, std430) buffer To { uvec2 to[]; };

void main()
{
    uint run = nth_invocation();
    if (run >= push.runs) {
        return;
    }
    uint end = min((run + 1u) * RUN, push.keys);
    for (uint i = run * RUN; i < end; ++i) {
        uvec2 key = from[i];
        uint at = count_at(digit_of(key.x), run);
        uint before = counts[at];
        counts[at] = before + 1u;
        to[totals[at / DIGITS] + before] = key;
    }
}
