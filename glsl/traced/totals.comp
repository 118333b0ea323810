// Entry of the pass traced.totals (src/techniques/traced/passes.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "traced/lists.glsl"

// Replaces each block's sums by those of the blocks before it, and writes the sizes of the dispatches over the lists. From
// the block on whose triangles do not fit into the lists, all shafts are worked off by rays.

layout(local_size_x = 1) in;

layout(set = 0, binding = 0, std430) buffer Sums { uvec4 sums[]; };
layout(set = 0, binding = 1, std430) buffer Entries { Head head; Entry entries[]; };
layout(set = 0, binding = 2, std430) buffer Arguments { uint groups[8]; };

layout(push_constant) uniform Push {
    uint slots;
    uint blocks;
    uint most;
    uint capacity;
} push;

void write_groups(uint first, uint count)
{
    uvec2 size = count > 0u ? groups_as_far_as(count - 1u) : uvec2(0u);
    groups[first] = size.x;
    groups[first + 1u] = size.y;
    groups[first + 2u] = 1u;
}

void main()
{
    uvec4 sum = uvec4(0u);
    for (uint block = 0u; block < push.blocks; ++block) {
        uvec4 of = sums[block];
        bool fits = sum.w == 0u && of.x <= push.capacity - sum.x;
        sums[block] = uvec4(sum.xyz, fits ? 1u : 0u);
        sum += fits ? uvec4(of.xyz, 0u) : uvec4(0u, 0u, of.y + of.z, 1u);
    }
    head.shafts = sum.y;
    head.dense = sum.z;
    // 32 shafts a workgroup gather triangles; a dense one is traced by one workgroup.
    write_groups(0u, (sum.y + 31u) / 32u);
    write_groups(4u, sum.z);
    head.shadowed = 0u;
    head.groups = uint[3](0u, 0u, 1u);
}
