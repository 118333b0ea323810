// Entered from blocks.comp, superblocks.comp, patch_emit.comp, tiles.comp and gather.glsl.
//
// Nodes: square groups of occluder-map texels with the moments of w over the occupied ones.
//
// The buffer of nodes holds two uvec4 a node; then one a node of the moments of slopes, (sum c.g, sum g.x, sum g.y, 0),
// with c from the node's first corner to a texel's centre, texels, and g the change of w a texel; and from `sums` on two
// uvec4 a texel: the prefix sums over its block of (1, d, d^2, d^3), with d = w - mean, and of the moments of slopes.

#ifndef SOFT_SHADOW_MAP_NODE_GLSL
#define SOFT_SHADOW_MAP_NODE_GLSL

const int BLOCK = 8;                   // a block's side in texels
const int BLOCK_TEXELS = BLOCK * BLOCK;
const int FAN = 4;                     // a superblock's side in blocks
const int SUPERBLOCK = FAN * BLOCK;    // a superblock's side in texels
const int FAMILY = 1 + FAN * FAN;      // a superblock and its blocks, which lie together

// The w of a missing receiver: so near that no occluder can be in front of it.
const float NOTHING = 3.0e38;

struct Node {
    float count;  // occupied texels
    float mean;   // mean w of them, 1/m
    float w_min;  // furthest
    float w_max;  // nearest
    float s2;     // sum of (w - mean)^2
    float s3;     // sum of (w - mean)^3
    uvec2 mask;   // a bit for each occupied texel of a block, or for each such block of a superblock
};

// Reads a node from two uvec4.
Node unpack_node(uvec4 a, uvec4 b)
{
    vec4 f = uintBitsToFloat(a);
    return Node(f.x, f.y, f.z, f.w, uintBitsToFloat(b.x), uintBitsToFloat(b.y), b.zw);
}

// A slope as the upper halves of two floats, rounded to 1/256 of it: naga has no 16-bit floats everywhere.
uint packed_slope(vec2 slope)
{
    uvec2 bits = floatBitsToUint(slope) + 0x8000u;
    return (bits.x >> 16u) | (bits.y & 0xffff0000u);
}

vec2 unpacked_slope(uint stored)
{
    return uintBitsToFloat(uvec2(stored << 16u, stored & 0xffff0000u));
}

// The sum of k^2 over texels whose w is mean + d, with s = (count, sum d, sum d^2, sum d^3), all of them
// back-projected wholly inside the light: the Taylor series of 1/(w - w_r)^2 about the mean to the third
// order, for four receivers. Times scale.x * scale.y it is the occlusion.
vec4 series(vec4 s, float mean, vec4 w_r)
{
    vec4 k = 1.0 / (mean - w_r);
    return k * k * (s.x + k * (-2.0 * s.y + k * (3.0 * s.z - 4.0 * s.w * k)));
}

// The patches' slopes change that sum by this much: the sum of -k^3 (c - t).g over the texels, to the first order of d,
// for texels of one plane (d = g.(c - mean c)). `m` is (sum c.g, sum g.x, sum g.y) with c from the corner `lo`.
vec4 slope_series(vec4 s, vec3 m, float mean, vec2 lo, vec4 t_x, vec4 t_y, vec4 w_r)
{
    vec4 k = 1.0 / (mean - w_r);
    vec4 turned = m.x + (lo.x - t_x) * m.y + (lo.y - t_y) * m.z;
    float n = max(s.x, 1.0);
    return k * k * k * (3.0 * k * (s.z - s.y * s.y / n + turned * (s.y / n)) - turned);
}

// A bit for each texel of a block in [lo, hi).
uvec2 rectangle_mask(ivec2 lo, ivec2 hi)
{
    uint columns = ((1u << hi.x) - (1u << lo.x)) * 0x01010101u;
    // Rows of texels 0 to 3 are in x, 4 to 7 in y; a shift by 32 is undefined.
    ivec2 from = clamp(lo.y - ivec2(0, 4), 0, 4);
    ivec2 to = clamp(hi.y - ivec2(0, 4), 0, 4);
    uvec2 below_from = uvec2(from.x == 4 ? 0xffffffffu : (1u << (8 * from.x)) - 1u,
                             from.y == 4 ? 0xffffffffu : (1u << (8 * from.y)) - 1u);
    uvec2 below_to = uvec2(to.x == 4 ? 0xffffffffu : (1u << (8 * to.x)) - 1u,
                           to.y == 4 ? 0xffffffffu : (1u << (8 * to.y)) - 1u);
    return columns & below_to & ~below_from;
}

// Whether a node may hide any of the light from receivers with t in [t_min, t_max] and w of w_r or more; `lo` is its
// first texel, `side` its side in texels.
bool may_shadow(Node node, vec2 lo, float side, vec2 t_min, vec2 t_max, float w_r, vec2 scale)
{
    if (node.count == 0.0 || node.w_max <= w_r) {
        return false;
    }
    // The least magnification gives the widest window of occluder texels that the light covers.
    vec2 window = 0.5 * (node.w_max - w_r) / scale;
    vec2 gap = max(lo - t_max, t_min - (lo + side));
    return gap.x < window.x && gap.y < window.y;
}

// The first superblock (xy) and the last one (zw) in which an occluder may shadow receivers with t in [t_min, t_max]
// and w of w_r or more. No occluder is nearer than 1/w_max, and a row has `row` superblocks.
ivec4 superblocks_around(vec2 t_min, vec2 t_max, float w_r, int row, float w_max, vec2 scale)
{
    vec2 widest = 0.5 * (w_max - w_r) / scale;
    float end = float(row - 1);
    return ivec4(clamp(floor((t_min - widest) / float(SUPERBLOCK)), 0.0, end),
                 clamp(floor((t_max + widest) / float(SUPERBLOCK)), 0.0, end));
}

const int OUTSIDE = 0; // hides nothing of the light from any of the receivers
const int INSIDE = 1;  // the series serves all of the receivers
const int MIXED = 2;   // undecided: its children or its texels must be read

// Where a node lies for receivers with t in [t_min, t_max] and w_r in [w_r.x, w_r.y]; `lo` is its first texel, `side`
// its side in texels, `spread` the largest |w - mean| k that the series may have.
int classify(Node node, vec2 lo, float side, vec2 t_min, vec2 t_max, vec2 w_r, vec2 scale,
             float spread)
{
    if (!may_shadow(node, lo, side, t_min, t_max, w_r.x, scale)) {
        return OUTSIDE;
    }
    vec2 hi = lo + side;
    vec2 core = 0.5 * (node.w_min - w_r.y) / scale;
    vec2 reach = max(hi - t_min, t_max - lo);
    float deviation = max(node.w_max - node.mean, node.mean - node.w_min);
    bool inside = reach.x <= core.x && reach.y <= core.y;
    return inside && deviation <= spread * (node.mean - w_r.y) ? INSIDE : MIXED;
}

#endif
