// Entry of the pass traced.sums (src/techniques/traced/passes.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "traced/lists.glsl"

// Sums a block of slots: the triangles of its shafts, its shafts, and its dense shafts.

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, std430) readonly buffer Slots { Slot slots[]; };
layout(set = 0, binding = 1, std430) buffer Sums { uvec4 sums[]; };

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
    uvec4 sum = uvec4(0u);
    uint end = min((block + 1u) * BLOCK, push.slots);
    for (uint slot = block * BLOCK; slot < end; ++slot) {
        uint count = slots[slot].shaft.count;
        if (is_listed(count, push.most)) {
            sum.xy += uvec2(room_of(count), 1u);
        }
        sum.z += is_dense(count, push.most) ? 1u : 0u;
    }
    sums[block] = sum;
}
