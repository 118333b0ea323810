// Entry of the pass traced.totals (src/techniques/traced/passes.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "traced/lists.glsl"

// Replaces each block's sums by those of the blocks before it, and writes the sizes of the dispatches over the lists. From
// the block on whose triangles do not fit into the lists, all shafts are worked off by rays.

layout(local_size_x = 64) in;

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

// Each invocation has a run of blocks, and here its sum of them; of triangles no sum counts beyond one more than the
// lists hold, so that none overflows.
shared uint triangles[gl_WorkGroupSize.x];
shared uvec2 shafts[gl_WorkGroupSize.x];

uint with_triangles(uint sum, uint more)
{
    return min(sum + min(more, push.capacity + 1u), push.capacity + 1u);
}

// The shafts of a block that are listed, and those that send rays.
uvec2 shafts_of(uvec4 block, bool fits)
{
    return fits ? block.yz : uvec2(0u, block.y + block.z);
}

void main()
{
    uint lane = gl_LocalInvocationIndex;
    uint run = (push.blocks + gl_WorkGroupSize.x - 1u) / gl_WorkGroupSize.x;
    uint begin = min(lane * run, push.blocks);
    uint end = min(begin + run, push.blocks);
    uint own = 0u;
    for (uint block = begin; block < end; ++block) {
        own = with_triangles(own, sums[block].x);
    }
    triangles[lane] = own;
    barrier();
    uint before = 0u;
    for (uint i = 0u; i < lane; ++i) {
        before = with_triangles(before, triangles[i]);
    }
    uint sum = before;
    uvec2 counted = uvec2(0u);
    for (uint block = begin; block < end; ++block) {
        uvec4 of = sums[block];
        sum = with_triangles(sum, of.x);
        counted += shafts_of(of, sum <= push.capacity);
    }
    shafts[lane] = counted;
    barrier();
    uvec2 places = uvec2(0u);
    uvec2 all = uvec2(0u);
    for (uint i = 0u; i < gl_WorkGroupSize.x; ++i) {
        all += shafts[i];
        places = i + 1u == lane ? all : places;
    }
    sum = before;
    for (uint block = begin; block < end; ++block) {
        uvec4 of = sums[block];
        uint with = with_triangles(sum, of.x);
        bool fits = with <= push.capacity;
        sums[block] = uvec4(sum, places, fits ? 1u : 0u);
        sum = with;
        places += shafts_of(of, fits);
    }
    if (lane == 0u) {
        head.shafts = all.x;
        head.dense = all.y;
        // 32 shafts a workgroup gather triangles; a dense one is traced by one workgroup.
        write_groups(0u, (all.x + 31u) / 32u);
        write_groups(4u, all.y);
        head.shadowed = 0u;
        head.groups = uint[3](0u, 0u, 1u);
    }
}
