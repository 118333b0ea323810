// Entry of the pass hierarchy.opacities (src/stages/hierarchy/mod.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "hierarchy/cut_out_push.glsl"
#include "hierarchy/texels.glsl"

// Copies the alpha of an opacity texture, times the mesh's factor, to its place among those of all textures: a byte each. A
// texture that is halved has the means of what its texels stand for. One invocation makes four texels.

layout(set = 0, binding = 0, r32ui) writeonly uniform uimage2D copies;

layout(set = 1, binding = 1) uniform texture2D opacities;

// The mean alpha of the texels that one of a halved texture stands for.
float alpha_of(ivec2 at, ivec2 size)
{
    ivec2 whole = textureSize(opacities, 0);
    ivec2 low = at << int(push.halved);
    ivec2 high = mix(low + (1 << int(push.halved)), whole, equal(at, size - 1));
    float sum = 0.0;
    for (int y = low.y; y < high.y; ++y) {
        for (int x = low.x; x < high.x; ++x) {
            sum += texelFetch(opacities, ivec2(x, y), 0).w;
        }
    }
    ivec2 sides = max(high - low, ivec2(1));
    return sum / float(sides.x * sides.y);
}

void main()
{
    uint nth = nth_group(gl_WorkGroupID.xy) * gl_WorkGroupSize.x + gl_LocalInvocationIndex;
    ivec2 size = ivec2(push.cut_out.extent & 0xffffu, push.cut_out.extent >> 16u);
    uint count = uint(size.x) * uint(size.y);
    if (4u * nth >= count) {
        return;
    }
    uint word = 0u;
    for (uint i = 0u; i < 4u && 4u * nth + i < count; ++i) {
        uint at = 4u * nth + i;
        float alpha = alpha_of(ivec2(at % uint(size.x), at / uint(size.x)), size) * push.cut_out.v.w;
        word |= uint(round(255.0 * clamp(alpha, 0.0, 1.0))) << 8u * i;
    }
    imageStore(copies, texel(push.cut_out.texels / 4u + nth), uvec4(word, 0u, 0u, 0u));
}
