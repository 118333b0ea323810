// Entry of the pass traced.list (src/techniques/traced/passes.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "traced/lists.glsl"

// Lists the shafts of a block of slots, each with the place of its triangles, and those that rays work off.

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, std430) readonly buffer Slots { Slot slots[]; };
layout(set = 0, binding = 1, std430) readonly buffer Sums { uvec4 sums[]; };
layout(set = 0, binding = 2, std430) buffer Entries { uint shaft_count; uint dense_count; Entry entries[]; };

layout(push_constant) uniform Push {
    uint slots;
    uint blocks;
    uint most;
    uint capacity;
} push;

void main()
{
    uint block = nth_group(gl_WorkGroupID.xy) * gl_WorkGroupSize.x + gl_LocalInvocationIndex;
    if (block >= push.blocks) {
        return;
    }
    uvec4 at = sums[block];
    bool fits = at.w != 0u;
    uint end = min((block + 1u) * BLOCK, push.slots);
    for (uint slot = block * BLOCK; slot < end; ++slot) {
        uint count = slots[slot].shaft.count;
        if (is_listed(count, push.most) && fits) {
            entries[at.y].slot = slot;
            entries[at.y].first = at.x;
            at.xy += uvec2(room_of(count), 1u);
        } else if (count > 0u) {
            // From the end backwards.
            entries[push.slots - 1u - at.z].slot = slot;
            at.z += 1u;
        }
    }
}
