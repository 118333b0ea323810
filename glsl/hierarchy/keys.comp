// Entry of the pass hierarchy.keys (src/stages/hierarchy/sort.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "hierarchy/mesh.glsl"

// The key by which a triangle is sorted: the mesh's bits, and below them a Morton code of the triangle's middle in the
// mesh's own box. So the triangles of a mesh stay together however the mesh moves.

layout(set = 0, binding = 0, std430) writeonly buffer Keys { uvec2 keys[]; };

// The low 10 bits of a number, two zeros behind each.
uint spread(uint x)
{
    x &= 0x3ffu;
    x = (x | x << 16u) & 0x030000ffu;
    x = (x | x << 8u) & 0x0300f00fu;
    x = (x | x << 4u) & 0x030c30c3u;
    x = (x | x << 2u) & 0x09249249u;
    return x;
}

void main()
{
    uint triangle = nth_group(gl_WorkGroupID.xy) * gl_WorkGroupSize.x + gl_LocalInvocationIndex;
    if (triangle >= push.padded) {
        return;
    }
    // What is no triangle comes last in its mesh.
    uint code = 0x3fffffffu;
    vec3 corners[3];
    if (triangle_at(triangle, corners)) {
        vec3 low = min(min(corners[0], corners[1]), corners[2]);
        vec3 high = max(max(corners[0], corners[1]), corners[2]);
        uvec3 cell = uvec3(clamp((0.5 * (low + high) - push.low.xyz) * push.cells.xyz, 0.0, 1023.0));
        code = spread(cell.x) << 2u | spread(cell.y) << 1u | spread(cell.z);
    }
    uint place = push.first + triangle;
    keys[place] = uvec2(push.key | code >> 30u - push.key_bits, place);
}
