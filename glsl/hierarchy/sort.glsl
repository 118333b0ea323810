// Entered from hierarchy/count.comp, hierarchy/sums.comp, hierarchy/totals.comp and hierarchy/scatter.comp.
//
// A radix sort, one digit of eight bits in four passes: each invocation counts the digits of a run of keys, the counts
// are summed digit by digit, and each invocation moves the keys of its run to where the sums say. Equal keys keep their
// order, and no invocation waits for another, so that the result is the same on every device.

#ifndef HIERARCHY_SORT_GLSL
#define HIERARCHY_SORT_GLSL

#include "common/lists.glsl"

layout(local_size_x = 64) in;

// Keys a run, and counts a sum (src/stages/hierarchy/sort.rs).
const uint RUN = 256u;
const uint DIGITS = 256u;

layout(push_constant) uniform Push {
    uint keys;  // how many keys there are
    uint runs;  // how many runs they make
    uint shift; // the digit's first bit
} push;

uint nth_invocation()
{
    return nth_group(gl_WorkGroupID.xy) * gl_WorkGroupSize.x + gl_LocalInvocationIndex;
}

uint digit_of(uint key)
{
    return key >> push.shift & DIGITS - 1u;
}

// The place of a run's count of a digit: all runs of digit 0, then those of digit 1, and so on.
uint count_at(uint digit, uint run)
{
    return digit * push.runs + run;
}

#endif
