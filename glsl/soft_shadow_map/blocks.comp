// Entry of the pass soft_shadow_map.blocks (src/techniques/soft_shadow_map/nodes.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "soft_shadow_map/node.glsl"

// Writes the occluder map as w and how it slopes, in blocks of 8x8 texels that lie together, with each block's moments.
// A workgroup handles one block, an invocation a texel; z is the side: 0 the front layer, 1 the back layer.

layout(local_size_x = 64) in;

layout(set = 0, binding = 0) uniform texture2D front_depth;
layout(set = 0, binding = 1) uniform texture2D back_depth;
layout(set = 0, binding = 2, std430) buffer Texels { uint texels[]; };
layout(set = 0, binding = 3, std430) buffer Blocks { uvec4 blocks[]; };
layout(set = 0, binding = 4, std430) buffer Nodes { uvec4 nodes[]; };

layout(push_constant) uniform Push {
    int map;        // the map's side in texels
    int row;        // blocks a row, a multiple of a superblock's
    float inv_near; // 1 over the near plane's distance, 1/m
    int sums;       // where the prefix sums begin in nodes
    int slopes;     // where the slopes begin in texels
    int faces;      // 0: both layers as they are; 1, 2: see below
} push;

// A front texel gets the back layer's distance where that has one.
const int BOTTOM = 1;
// A back texel is left out where its front is so flat that the back would only add noise.
const int MEAN = 2;

// The back layer is cleared to 1 and keeps the least value, so 1 is a texel without a back face.
const float NO_BACK = 1.0;

float w_at(ivec2 p, uint side)
{
    if (p.x >= push.map || p.y >= push.map) {
        return 0.0;
    }
    float front = texelFetch(front_depth, p, 0).x;
    float back = texelFetch(back_depth, p, 0).x;
    if (side == 0u && (push.faces != BOTTOM || front == 0.0 || back == NO_BACK)) {
        return front * push.inv_near;
    }
    return back == NO_BACK ? 0.0 : back * push.inv_near;
}

// Patches of a surface parallel to the light join without gap or overlap (Atty 2006, eq. 3), so there is
// nothing for a back face to cancel where the front is flatter than it by this factor; the gaps of a steep
// one, such as the side of a box under its top, would only add (mean error of the tall box, L = 0.4: 0.5 %,
// 4.3 % without). From 15 to 50 no scene's error differs; at 6 the bunny's grows by a seventh.
const float FLATTER = 30.0;
// The largest step that a raster's rounding gives the depth of a flat face.
const float ROUNDING = 1.0e-4;

// How w changes at a texel: along each axis by the lesser step to its two neighbours, so that an edge beyond which
// something else lies does not count.
vec2 slope_at(ivec2 p, uint side)
{
    float w = w_at(p, side);
    vec2 slope = vec2(0.0);
    for (int axis = 0; axis < 2; ++axis) {
        ivec2 step = ivec2(1 - axis, axis);
        float least = 3.0e38;
        for (int i = -1; i <= 1; i += 2) {
            ivec2 q = p + i * step;
            float other = q.x < 0 || q.y < 0 ? 0.0 : w_at(q, side);
            float change = float(i) * (other - w);
            least = other > 0.0 && abs(change) < abs(least) ? change : least;
        }
        slope[axis] = least < 3.0e38 ? least : 0.0;
    }
    return slope;
}

// The larger step of both axes.
float steepness(ivec2 p, uint side)
{
    vec2 slope = abs(slope_at(p, side));
    return max(slope.x, slope.y);
}

// What the workgroup's invocations tell each other, by texel of the block.
shared float w_of_texel[BLOCK_TEXELS];
shared vec4 moments[BLOCK_TEXELS];      // (1, d, d^2, d^3) where there is an occluder
shared vec3 slope_moments[BLOCK_TEXELS];
shared vec4 row_moments[BLOCK_TEXELS];  // prefix sums along a row
shared vec3 row_slope_moments[BLOCK_TEXELS];

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

    float w = w_at(p, side);
    if (push.faces == MEAN && side == 1u && w > 0.0 &&
        steepness(p, 1u) > FLATTER * steepness(p, 0u) + ROUNDING * w) {
        w = 0.0;
    }
    texels[index * BLOCK_TEXELS + int(texel)] = floatBitsToUint(w);
    w_of_texel[texel] = w;
    barrier();

    // Every invocation adds all texels in the same order, and so all of them have the same mean.
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
    bool empty = count == 0.0;
    float mean = empty ? 0.0 : sum / count;
    // A sum of 64 is off by several roundings, and near a receiver each counts as often as w is larger than its
    // distance in w to it. Subtracting the sum of what rounding left leaves one rounding.
    float rest = 0.0;
    for (uint i = 0u; i < uint(BLOCK_TEXELS); ++i) {
        float of_texel = w_of_texel[i];
        rest += of_texel > 0.0 ? of_texel - mean : 0.0;
    }
    mean += empty ? 0.0 : rest / count;

    // A storage buffer of more than 128 MB is not guaranteed. With both sides, patches of maps of more than 2880 texels are in
    // part parallel to the light, and maps of more than 1408 texels have more blocks than there is room for their sums.
    bool sloped = !empty && push.slopes + (index + 1) * BLOCK_TEXELS <= texels.length();
    bool room = !empty && push.sums + 2 * (index + 1) * BLOCK_TEXELS <= nodes.length();
    uint stored = sloped && w > 0.0 ? packed_slope(slope_at(p, side)) : 0u;
    if (sloped) {
        texels[push.slopes + index * BLOCK_TEXELS + int(texel)] = stored;
    }
    float d = w - mean;
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
        blocks[2 * index] = empty ? uvec4(0u) : floatBitsToUint(vec4(count, mean, w_min, w_max));
        blocks[2 * index + 1] = empty ? uvec4(0u) : uvec4(floatBitsToUint(total.zw), mask);
        blocks[2 * all_blocks + index] = empty ? uvec4(0u) : floatBitsToUint(vec4(slopes, 0.0));
    }
}
