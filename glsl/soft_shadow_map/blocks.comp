// Entry of the pass soft_shadow_map.blocks (src/techniques/soft_shadow_map/nodes.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "soft_shadow_map/blocks.glsl"

// Writes the occluder map as w and how it slopes, in blocks of 8x8 texels that lie together, with each block's moments.
// A workgroup handles one block, an invocation a texel; z is the side: 0 the front layer, 1 the back layer. A GPU runs it;
// on a processor, where invocations that wait for each other cost more than they do, blocks_serial.comp writes the same.

layout(local_size_x = 64) in;

// What the workgroup's invocations tell each other, by texel of the block.
shared float w_of_texel[BLOCK_TEXELS];
shared vec4 moments[BLOCK_TEXELS];      // (1, d, d^2, d^3) where there is an occluder
shared vec3 slope_moments[BLOCK_TEXELS];
shared vec4 row_moments[BLOCK_TEXELS];  // prefix sums along a row of texels
shared vec3 row_slope_moments[BLOCK_TEXELS];
shared vec4 node;                       // count, mean, least and largest w of the block's texels
shared uvec2 occupied;                  // a bit for each texel with an occluder

void main()
{
    ivec2 block = ivec2(gl_WorkGroupID.xy);
    uint side = gl_WorkGroupID.z;
    int index = (int(side) * push.row + block.y) * push.row + block.x;
    int all_blocks = int(gl_NumWorkGroups.z) * push.row * push.row;
    uint texel = gl_LocalInvocationIndex;
    uint x = texel % uint(BLOCK);
    uint y = texel / uint(BLOCK);
    ivec2 p = block * BLOCK + ivec2(x, y);

    float w = w_kept(p, side);
    texels[index * BLOCK_TEXELS + int(texel)] = floatBitsToUint(w);
    w_of_texel[texel] = w;
    barrier();

    // One invocation adds all texels, in order.
    if (texel == 0u) {
        float count = 0.0;
        float sum = 0.0;
        float w_min = 3.0e38;
        float w_max = 0.0;
        uvec2 mask = uvec2(0u);
        for (uint i = 0u; i < uint(BLOCK_TEXELS); ++i) {
            float of_texel = w_of_texel[i];
            if (of_texel > 0.0) {
                count += 1.0;
                sum += of_texel;
                w_min = min(w_min, of_texel);
                w_max = max(w_max, of_texel);
                uint bit = 1u << (i & 31u);
                mask |= i < 32u ? uvec2(bit, 0u) : uvec2(0u, bit);
            }
        }
        float mean = count == 0.0 ? 0.0 : sum / count;
        // A sum of 64 is off by several roundings, and near a receiver each counts as often as w is larger than its
        // distance in w to it. Subtracting the sum of what rounding left leaves one rounding.
        float rest = 0.0;
        for (uint i = 0u; i < uint(BLOCK_TEXELS); ++i) {
            float of_texel = w_of_texel[i];
            rest += of_texel > 0.0 ? of_texel - mean : 0.0;
        }
        mean += count == 0.0 ? 0.0 : rest / count;
        node = vec4(count, mean, w_min, w_max);
        occupied = mask;
    }
    barrier();
    bool empty = node.x == 0.0;

    bool sloped = !empty && has_slopes(index);
    bool room = !empty && has_sums(index);
    uint stored = sloped && w > 0.0 ? packed_slope(slope_at(p, side)) : 0u;
    if (sloped) {
        texels[push.slopes + index * BLOCK_TEXELS + int(texel)] = stored;
    }
    float d = w - node.y;
    moments[texel] = w > 0.0 ? vec4(1.0, d, d * d, d * d * d) : vec4(0.0);
    vec2 slope = unpacked_slope(stored);
    slope_moments[texel] = vec3(dot(vec2(x, y) + 0.5, slope), slope);
    barrier();

    // Prefix sums over the texels above and to the left, which give the sums over any rectangle: along the rows first.
    vec4 row = vec4(0.0);
    vec3 slope_row = vec3(0.0);
    for (uint i = texel - x; i <= texel; ++i) {
        row += moments[i];
        slope_row += slope_moments[i];
    }
    row_moments[texel] = row;
    row_slope_moments[texel] = slope_row;
    barrier();
    vec4 total = vec4(0.0);
    vec3 slopes = vec3(0.0);
    for (uint i = x; i <= texel; i += uint(BLOCK)) {
        total += row_moments[i];
        slopes += row_slope_moments[i];
    }
    if (room) {
        int at = push.sums + 2 * (index * BLOCK_TEXELS + int(texel));
        nodes[at] = floatBitsToUint(total);
        nodes[at + 1] = floatBitsToUint(vec4(slopes, 0.0));
    }
    if (texel == uint(BLOCK_TEXELS - 1)) {
        blocks[2 * index] = empty ? uvec4(0u) : floatBitsToUint(node);
        blocks[2 * index + 1] = empty ? uvec4(0u) : uvec4(floatBitsToUint(total.zw), occupied);
        blocks[2 * all_blocks + index] = empty ? uvec4(0u) : floatBitsToUint(vec4(slopes, 0.0));
    }
}
