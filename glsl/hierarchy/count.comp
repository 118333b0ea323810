// Entry of the passes hierarchy.count_even and hierarchy.count_odd (src/stages/hierarchy/sort.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "hierarchy/sort.glsl"

// Counts the digits of each run of keys.

layout(set = 0, binding = 0, std430) readonly buffer Keys { uvec2 keys[]; };
layout(set = 0, binding = 1, std430) buffer Counts { uint counts[]; };

void main()
{
    uint run = nth_invocation();
    if (run >= push.runs) {
        return;
    }
    for (uint digit = 0u; digit < DIGITS; ++digit) {
        counts[count_at(digit, run)] = 0u;
    }
    uint end = min((run + 1u) * RUN, push.keys);
    for (uint i = run * RUN; i < end; ++i) {
        counts[count_at(digit_of(keys[i].x), run)] += 1u;
    }
}
