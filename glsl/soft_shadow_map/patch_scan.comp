// Entry of the passes soft_shadow_map.patch_scan_back and soft_shadow_map.patch_scan_front (src/techniques/soft_shadow_map/receiver_map.rs).
#version 450

// Group counts to the place of each group's first micro-patch, and the arguments of the draw.
// One invocation: at most 4096 groups, and an order that is the same in every frame.

layout(local_size_x = 1) in;

layout(set = 0, binding = 0, std430) readonly buffer Groups { uint groups[]; };
layout(set = 0, binding = 1, std430) buffer Offsets { uint offsets[]; };
// VkDrawIndirectCommand
layout(set = 0, binding = 2, std430) buffer Arguments { uint arguments[4]; };

layout(push_constant) uniform Push {
    int groups;
} push;

const uint VERTICES = 6u; // a micro-patch: two triangles

void main()
{
    uint total = 0u;
    for (int i = 0; i < push.groups; ++i) {
        offsets[i] = total;
        total += groups[i];
    }
    arguments[0] = total * VERTICES;
    arguments[1] = 1u;
    arguments[2] = 0u;
    arguments[3] = 0u;
}
