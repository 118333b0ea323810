// Entry of the pass traced.list (src/techniques/traced/passes.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "traced/lists.glsl"

// Lists the shafts of a block of slots, each with the place of its triangles, and those that rays work off.

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, std430) readonly buffer Counts { uint counts[]; };
layout(set = 0, binding = 1, std430) readonly buffer Sums { uvec4 sums[]; };
layout(set = 0, binding = 2, std430) writeonly buffer Listed { uvec2 listed[]; };
layout(set = 0, binding = 3, std430) writeonly buffer Dense { uint dense[]; };

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
        uint count = counts[slot];
        if (is_shaft(count, push.most) && fits) {
            listed[at.y] = uvec2(slot, at.x);
            at.xy += uvec2(room_of(count), 1u);
        } else if (count > 0u) {
            dense[at.z] = slot;
            at.z += 1u;
        }
    }
}
