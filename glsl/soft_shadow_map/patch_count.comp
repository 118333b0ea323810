// Entry of the passes soft_shadow_map.patch_count_back and soft_shadow_map.patch_count_front (src/techniques/soft_shadow_map/receiver_map.rs).
#version 450

// Occupied texels of each group of 64 blocks, the first step of giving every micro-patch its place.
// One invocation a group.

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, std430) readonly buffer Blocks { uvec4 blocks[]; };
layout(set = 0, binding = 1, std430) buffer Groups { uint groups[]; };

layout(push_constant) uniform Push {
    int blocks; // of one side
    int side;
} push;

const int GROUP = 64;

void main()
{
    int group = int(gl_GlobalInvocationID.x);
    if (group * GROUP >= push.blocks) {
        return;
    }
    uint count = 0u;
    for (int i = group * GROUP; i < min((group + 1) * GROUP, push.blocks); ++i) {
        count += uint(uintBitsToFloat(blocks[2 * (push.side * push.blocks + i)].x));
    }
    groups[group] = count;
}
