// Entry of the pass hierarchy.triangles (src/stages/hierarchy/mod.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "hierarchy/mesh.glsl"

// Writes a mesh's triangles, in the hierarchy's space, to their places in the leaves.

layout(set = 0, binding = 0, std430) readonly buffer Places { uint places[]; };
layout(set = 0, binding = 1, rgba32f) writeonly uniform image2D triangles;

#include "hierarchy/texels.glsl"

void main()
{
    uint triangle = nth_group(gl_WorkGroupID.xy) * gl_WorkGroupSize.x + gl_LocalInvocationIndex;
    if (triangle >= push.padded) {
        return;
    }
    vec3 corners[3];
    bool there = triangle_at(triangle, corners);
    uint first = 3u * places[push.first + triangle];
    vec3 origin = vec3(push.origin_x, push.origin_y, push.origin_z);
    for (int i = 0; i < 3; ++i) {
        vec4 p = vec4(corners[i] - origin, 1.0);
        vec3 corner = vec3(dot(push.row_x, p), dot(push.row_y, p), dot(push.row_z, p));
        there = there && is_number(corner.x) && is_number(corner.y) && is_number(corner.z);
        corners[i] = corner;
    }
    // Beside the corners: that there is a triangle, and whether a texture cuts it out; twice its area, and that times the size of its positions.
    vec3 size = max(max(abs(corners[0]), abs(corners[1])), abs(corners[2]));
    vec3 normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
    float most = max(max(abs(normal.x), abs(normal.y)), max(abs(normal.z), 1.0e-30));
    float area = most * max(length(normal / most), 1.0);
    vec3 more = vec3(push.low.w, area, area * (size.x + size.y + size.z));
    for (int i = 0; i < 3; ++i) {
        imageStore(triangles, texel(first + uint(i)), there ? vec4(corners[i], more[i]) : vec4(0.0));
    }
}
