// Entry of the pass hierarchy.cut_outs (src/stages/hierarchy/mod.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "hierarchy/cut_out_push.glsl"
#include "hierarchy/texels.glsl"

// Writes the places of a mesh's triangles in its opacity texture, and the texture, to the triangles' places in the leaves:
// three texels each, as hierarchy/cut.glsl reads them.

layout(set = 0, binding = 0, std430) readonly buffer Places { uint places[]; };
layout(set = 0, binding = 1, rgba32f) writeonly uniform image2D cut_outs;

layout(set = 1, binding = 0, std430) readonly buffer Coordinates { float coordinates[]; };
layout(set = 1, binding = 2, std430) readonly buffer Indices { uint indices[]; };

// The number of the vertex at a corner; one that no buffer holds where there is none.
uint vertex_at(uint corner)
{
    if (push.index_bits == 0u) {
        return corner;
    }
    uint at = push.indices + corner;
    uint word = push.index_bits == 16u ? at >> 1u : at;
    if (word >= uint(indices.length())) {
        return 0xffffffffu;
    }
    uint value = indices[word];
    return push.index_bits == 16u ? value >> 16u * (at & 1u) & 0xffffu : value;
}

vec2 place_of(uint vertex)
{
    uint stride = push.cut_out.bits & STRIDE_BITS;
    uint most = (uint(coordinates.length()) - min(push.cut_out.first, uint(coordinates.length()))) / stride;
    uint at = push.cut_out.first + vertex * stride;
    bool there = vertex <= most && at + 1u < uint(coordinates.length());
    vec3 given = there ? vec3(coordinates[at], coordinates[at + 1u], 1.0) : vec3(0.0, 0.0, 1.0);
    return vec2(dot(push.cut_out.u.xyz, given), dot(push.cut_out.v.xyz, given));
}

void main()
{
    uint triangle = nth_group(gl_WorkGroupID.xy) * gl_WorkGroupSize.x + gl_LocalInvocationIndex;
    if (triangle >= push.count) {
        return;
    }
    uint at = 3u * places[push.first + triangle];
    vec2 a = place_of(vertex_at(3u * triangle));
    vec2 b = place_of(vertex_at(3u * triangle + 1u));
    vec2 c = place_of(vertex_at(3u * triangle + 2u));
    // Whole numbers below 2^24 are exact as floats, which keep them whatever they are as bits.
    vec2 begins = vec2(push.cut_out.texels / 4u >> 12u, push.cut_out.texels / 4u & 0xfffu);
    vec2 size = vec2(push.cut_out.extent & 0xffffu, push.cut_out.extent >> 16u);
    imageStore(cut_outs, texel(at), vec4(a, b));
    imageStore(cut_outs, texel(at + 1u), vec4(c, float(push.cut_out.bits >> 16u), push.cut_out.u.w));
    imageStore(cut_outs, texel(at + 2u), vec4(begins, size));
}
