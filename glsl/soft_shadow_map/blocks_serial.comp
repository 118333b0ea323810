// Entry of the pass soft_shadow_map.blocks (src/techniques/soft_shadow_map/nodes.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "soft_shadow_map/blocks.glsl"

// Writes the occluder map as w and how it slopes, in blocks of 8x8 texels that lie together, with each block's moments.
// One invocation handles one block; z is the side: 0 the front layer, 1 the back layer. Devices that are processors run it,
// and blocks.comp is for others.

layout(local_size_x = 8, local_size_y = 8) in;

void main()
{
    ivec2 block = ivec2(gl_GlobalInvocationID.xy);
    if (block.x >= push.row || block.y >= push.row) {
        return;
    }
    uint side = gl_GlobalInvocationID.z;
    int index = (int(side) * push.row + block.y) * push.row + block.x;

    float count = 0.0;
    float sum = 0.0;
    float w_min = 3.0e38;
    float w_max = 0.0;
    uvec2 mask = uvec2(0u);
    float w[BLOCK_TEXELS];
    for (int i = 0; i < BLOCK_TEXELS; ++i) {
        ivec2 p = block * BLOCK + ivec2(i % BLOCK, i / BLOCK);
        w[i] = w_kept(p, side);
        texels[index * BLOCK_TEXELS + i] = floatBitsToUint(w[i]);
        if (w[i] > 0.0) {
            count += 1.0;
            sum += w[i];
            w_min = min(w_min, w[i]);
            w_max = max(w_max, w[i]);
            mask[i / 32] |= 1u << (i % 32);
        }
    }
    int all_blocks = int(gl_NumWorkGroups.z) * push.row * push.row;
    if (count == 0.0) {
        blocks[2 * index] = uvec4(0u);
        blocks[2 * index + 1] = uvec4(0u);
        blocks[2 * all_blocks + index] = uvec4(0u);
        return;
    }
    float mean = sum / count;
    // A sum of 64 is off by several roundings, and near a receiver each counts as often as w is larger than its
    // distance in w to it. Subtracting the sum of what rounding left leaves one rounding.
    float rest = 0.0;
    for (int i = 0; i < BLOCK_TEXELS; ++i) {
        rest += w[i] > 0.0 ? w[i] - mean : 0.0;
    }
    mean += rest / count;
    // Prefix sums over the texels above and to the left, which give the sums over any rectangle.
    vec4 columns[BLOCK];
    vec3 slopes[BLOCK];
    for (int x = 0; x < BLOCK; ++x) {
        columns[x] = vec4(0.0);
        slopes[x] = vec3(0.0);
    }
    bool sloped = has_slopes(index);
    bool room = has_sums(index);
    for (int y = 0; y < BLOCK; ++y) {
        vec4 row = vec4(0.0);
        vec3 slope_row = vec3(0.0);
        for (int x = 0; x < BLOCK; ++x) {
            int i = y * BLOCK + x;
            float d = w[i] - mean;
            row += w[i] > 0.0 ? vec4(1.0, d, d * d, d * d * d) : vec4(0.0);
            columns[x] += row;
            uint stored = sloped && w[i] > 0.0 ? packed_slope(slope_at(block * BLOCK + ivec2(x, y), side)) : 0u;
            if (sloped) {
                texels[push.slopes + index * BLOCK_TEXELS + i] = stored;
            }
            vec2 slope = unpacked_slope(stored);
            slope_row += vec3(dot(vec2(x, y) + 0.5, slope), slope);
            slopes[x] += slope_row;
            if (room) {
                int at = push.sums + 2 * (index * BLOCK_TEXELS + i);
                nodes[at] = floatBitsToUint(columns[x]);
                nodes[at + 1] = floatBitsToUint(vec4(slopes[x], 0.0));
            }
        }
    }
    vec4 total = columns[BLOCK - 1];
    blocks[2 * index] = floatBitsToUint(vec4(count, mean, w_min, w_max));
    blocks[2 * index + 1] = uvec4(floatBitsToUint(total.zw), mask);
    blocks[2 * all_blocks + index] = floatBitsToUint(vec4(slopes[BLOCK - 1], 0.0));
}
