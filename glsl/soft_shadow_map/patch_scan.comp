// Entry of the passes soft_shadow_map.patch_scan_back and soft_shadow_map.patch_scan_front (src/techniques/soft_shadow_map/receiver_map.rs).
#version 450

// Turns the groups' counts into the place of each group's first micro-patch, and writes the arguments of the draw.
// One workgroup does it, of which each invocation has a run of the groups, 4096 at most: the order is that of the groups in
// every frame.

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, std430) readonly buffer Groups { uint groups[]; };
layout(set = 0, binding = 1, std430) buffer Offsets { uint offsets[]; };
// VkDrawIndirectCommand
layout(set = 0, binding = 2, std430) buffer Arguments { uint arguments[4]; };

layout(push_constant) uniform Push {
    int groups;
} push;

const uint VERTICES = 6u; // two triangles a micro-patch

// The micro-patches of each invocation's groups.
shared uint counts[gl_WorkGroupSize.x];

void main()
{
    int lane = int(gl_LocalInvocationIndex);
    int run = (push.groups + int(gl_WorkGroupSize.x) - 1) / int(gl_WorkGroupSize.x);
    int begin = min(lane * run, push.groups);
    int end = min(begin + run, push.groups);
    uint own = 0u;
    for (int i = begin; i < end; ++i) {
        own += groups[i];
    }
    counts[lane] = own;
    barrier();
    uint before = 0u;
    for (int i = 0; i < lane; ++i) {
        before += counts[i];
    }
    uint offset = before;
    for (int i = begin; i < end; ++i) {
        offsets[i] = offset;
        offset += groups[i];
    }
    if (lane == int(gl_WorkGroupSize.x) - 1) {
        arguments[0] = (before + own) * VERTICES;
        arguments[1] = 1u;
        arguments[2] = 0u;
        arguments[3] = 0u;
    }
}
