// Entry of the pass traced.list (src/techniques/traced/passes.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "traced/lists.glsl"

// Lists the shafts of a block of slots, each with the place of its triangles, and those that rays work off.

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, std430) readonly buffer Slots { Slot slots[]; };
layout(set = 0, binding = 1, std430) readonly buffer Sums { uvec4 sums[]; };
layout(set = 0, binding = 2, std430) buffer Entries { Head head; Entry entries[]; };

layout(push_constant) uniform Push {
    uint slots;
    uint blocks;
    uint most;
    uint capacity;
} push;

// Shafts with few leaves, and with more of them: 0 to 3.
uint size_of(uint count)
{
    return uint(count > 12u) + uint(count > 40u) + uint(count > 130u);
}

void main()
{
    uint block = nth_group(gl_WorkGroupID.xy) * gl_WorkGroupSize.x + gl_LocalInvocationIndex;
    if (block >= push.blocks) {
        return;
    }
    uvec4 at = sums[block];
    bool fits = at.w != 0u;
    uint end = min((block + 1u) * BLOCK, push.slots);
    // Those with equally many leaves are neighbours in the list, so that neighbouring invocations take equally long.
    uvec4 of_size = uvec4(0u);
    for (uint slot = block * BLOCK; slot < end; ++slot) {
        uint count = slots[slot].shaft.count;
        of_size += is_listed(count, push.most) && fits ? uvec4(equal(uvec4(size_of(count)), uvec4(0u, 1u, 2u, 3u))) : uvec4(0u);
    }
    uvec4 place = at.y + uvec4(0u, of_size.x, of_size.x + of_size.y, of_size.x + of_size.y + of_size.z);
    for (uint slot = block * BLOCK; slot < end; ++slot) {
        uint count = slots[slot].shaft.count;
        if (is_listed(count, push.most) && fits) {
            uvec4 here = uvec4(equal(uvec4(size_of(count)), uvec4(0u, 1u, 2u, 3u)));
            uvec4 mine = place * here;
            uint nth = mine.x + mine.y + mine.z + mine.w;
            entries[nth].slot = slot;
            entries[nth].first = at.x;
            at.x += room_of(count);
            place += here;
        } else if (count > 0u) {
            // From the end backwards.
            entries[push.slots - 1u - at.z].slot = slot;
            at.z += 1u;
        }
    }
}
