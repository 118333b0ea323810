// Entered from gather_map.comp and gather_pixels.comp.
//
// The hierarchical gather at four receivers at once, one lane of each vec4 a receiver.
//
// `#define SLOPED` lets micro-patches slope as the map does around them; without it they are parallel to the light.
//
// The including shader declares the buffers `texels` and `nodes`, and the test against the receivers' own
// planes:
//     struct Receivers { vec4 t_x; vec4 t_y; vec4 w; ... };
//     bvec4 is_above(vec2 lo, vec4 w_o, Receivers r)
//     int plane_side(Node node, vec2 lo, float side, Receivers r)

#ifndef SOFT_SHADOW_MAP_GATHER_GLSL
#define SOFT_SHADOW_MAP_GATHER_GLSL

#include "common/lists.glsl"
#include "soft_shadow_map/node.glsl"

// The occluder map as the gather reads it.
struct Map {
    vec2 scale;   // (du/Lx, dv/Ly), 1/m
    float w_max;  // no occluder is nearer than 1/w_max
    float spread; // the series' limit, see classify
    int row;      // superblocks a row
    int sums;     // where the prefix sums begin in `nodes`
    int slopes;   // where the slopes begin in `texels`
};

float least(vec4 a)
{
    return min(min(a.x, a.y), min(a.z, a.w));
}

float most(vec4 a)
{
    return max(max(a.x, a.y), max(a.z, a.w));
}

// The bounds of four receivers.
Tile tile_of(Receivers r)
{
    bvec4 nothing = equal(r.w, vec4(NOTHING));
    vec4 near = vec4(NOTHING);
    vec4 far = vec4(-NOTHING);
    return Tile(vec2(least(mix(r.t_x, near, nothing)), least(mix(r.t_y, near, nothing))),
                vec2(most(mix(r.t_x, far, nothing)), most(mix(r.t_y, far, nothing))),
                vec2(least(r.w), most(mix(r.w, vec4(0.0), nothing))));
}

// How w changes at an occluder texel.
vec2 slope_of(int texel, Map map)
{
#ifdef SLOPED
    int at = map.slopes + texel;
    return at < texels.length() ? unpacked_slope(texels[at]) : vec2(0.0);
#else
    return vec2(0.0);
#endif
}

// The occlusion of one occluder texel by the face at w_o, whose w changes by (slope_x, slope_y) a texel; a receiver may see
// another face of the texel than the others.
vec4 texel_occlusion(vec2 lo, vec4 w_o, vec4 slope_x, vec4 slope_y, Receivers r, vec2 scale)
{
    // Receivers in front of the texel, and missing ones, get a magnification of 0.
    vec4 k = mix(vec4(0.0), 1.0 / (w_o - r.w), greaterThan(w_o, r.w));
    vec4 m_x = scale.x * k;
    vec4 m_y = scale.y * k;
    vec4 a_x = (lo.x - r.t_x) * m_x + 0.5;
    vec4 a_y = (lo.y - r.t_y) * m_y + 0.5;
    // The other edges are computed as the next texel's first ones: as a_x + m_x, equal texels would all be wrong by the
    // same part of 2^-24, and their sum by that part of a row's texels.
    vec4 b_x = (lo.x + 1.0 - r.t_x) * m_x + 0.5;
    vec4 b_y = (lo.y + 1.0 - r.t_y) * m_y + 0.5;
    vec4 x = clamp(b_x, 0.0, 1.0) - clamp(a_x, 0.0, 1.0);
    vec4 y = clamp(b_y, 0.0, 1.0) - clamp(a_y, 0.0, 1.0);
    vec4 area = x * y;
#ifdef SLOPED
    // A step of (u, v) on the patch changes k, too: the determinant of its projection is k^2 (1 - k (c - t).g).
    area *= 1.0 - k * ((lo.x + 0.5 - r.t_x) * slope_x + (lo.y + 0.5 - r.t_y) * slope_y);
#endif
    return mix(vec4(0.0), area, is_above(lo, w_o, r));
}

// The moments of the texels [lo, hi) of a block whose prefix sums begin at `first`; from the next place on those of
// slopes.
vec4 sums_within(int first, ivec2 lo, ivec2 hi)
{
    int last = first - 2 * (1 + BLOCK);
    vec4 s = uintBitsToFloat(nodes[last + 2 * (hi.y * BLOCK + hi.x)]);
    if (lo.x > 0) {
        s -= uintBitsToFloat(nodes[last + 2 * (hi.y * BLOCK + lo.x)]);
    }
    if (lo.y > 0) {
        s -= uintBitsToFloat(nodes[last + 2 * (lo.y * BLOCK + hi.x)]);
        if (lo.x > 0) {
            s += uintBitsToFloat(nodes[last + 2 * (lo.y * BLOCK + lo.x)]);
        }
    }
    return s;
}

// The occlusion by the texels with moments `s` and moments of slopes `m` that lie wholly inside the light.
vec4 core_occlusion(vec4 s, vec4 m, float mean, vec2 lo, Receivers r)
{
    vec4 sum = series(s, mean, r.w);
#ifdef SLOPED
    sum += slope_series(s, m.xyz, mean, lo, r.t_x, r.t_y, r.w);
#endif
    return sum;
}

// The place of a texel in its block, in texels.
vec2 place_in_block(int texel)
{
    return vec2(uvec2(texel) >> uvec2(0u, 3u) & 7u);
}

// Removes the first texel from a mask that has one, and returns its index. The caller tests whether there is one:
// tested here, with `?:`, in code that stands there eight times, SwiftShader's compiler needs over 24 GB.
int take_texel(inout uvec2 todo)
{
    bool first = todo.x != 0u;
    uint bits = first ? todo.x : todo.y;
    int n = findLSB(int(bits)) + (first ? 0 : 32);
    bits &= bits - 1u;
    todo = first ? uvec2(bits, todo.y) : uvec2(0u, bits);
    return n;
}

// The occlusion by the first texel of a mask, which is removed from it; 0 where the mask is empty.
vec4 next_texel(inout uvec2 todo, int block, vec2 lo, Receivers r, Map map)
{
    if ((todo.x | todo.y) == 0u) {
        return vec4(0.0);
    }
    int n = take_texel(todo);
    int index = block * BLOCK_TEXELS + n;
    float w_o = uintBitsToFloat(texels[index]);
    vec2 slope = slope_of(index, map);
    return texel_occlusion(lo + place_in_block(n), vec4(w_o), vec4(slope.x), vec4(slope.y), r, map.scale);
}

// The occlusion by the first texel of a mask, which is removed from it: by its back face, or by its front face where
// the back face does not lie before the receiver.
vec4 next_pair(inout uvec2 todo, int block, int backs, vec2 lo, Receivers r, Map map)
{
    if ((todo.x | todo.y) == 0u) {
        return vec4(0.0);
    }
    int n = take_texel(todo);
    vec2 at = lo + place_in_block(n);
    int index = block * BLOCK_TEXELS + n;
    float w_f = uintBitsToFloat(texels[index]);
    vec2 slope_f = slope_of(index, map);
    float w_b = uintBitsToFloat(texels[index + backs]);
    vec2 slope_b = slope_of(index + backs, map);
    // A texel without a back face has one of 0, which lies before no receiver.
    bvec4 above = is_above(at, vec4(w_b), r);
    bvec4 before = greaterThan(mix(vec4(0.0), vec4(w_b), above), r.w);
    return texel_occlusion(at, mix(vec4(w_f), vec4(w_b), before), mix(vec4(slope_f.x), vec4(slope_b.x), before),
                           mix(vec4(slope_f.y), vec4(slope_b.y), before), r, map.scale);
}

// Which faces are gathered: 0 the front layer, 1 the back layer, or each texel's back face where it lies
// before the receiver and its front face where not.
const int BACK_OR_FRONT = 2;

// 1 where every texel of a node lies before all receivers and above their planes, -1 where none does.
int before(Node node, vec2 lo, float extent, Tile tile, Receivers r)
{
    if (node.count == 0.0 || node.w_max <= tile.w.x) {
        return -1;
    }
    int plane = plane_side(node, lo, extent, r);
    return plane > 0 && node.w_min <= tile.w.y ? 0 : plane;
}

// Sums that change once a row of superblocks lie in shared memory: registers are what limits the number of waves.
shared vec4 sums_of_map[64];
shared vec4 sums_of_row[64];

// The occlusion by one side of the map, or by both sides in pairs.
vec4 gather(Map map, int side, Receivers r)
{
    Tile tile = tile_of(r);
    uint own = gl_LocalInvocationIndex;
    sums_of_map[own] = vec4(0.0);
    sums_of_row[own] = vec4(0.0);
    // Sums are kept for a superblock, for a row of superblocks and for the whole map: thousands of equal numbers that
    // are added to one float round the same way each time (docs/rounding.md).
    vec4 sum_of_superblock = vec4(0.0);
    if (tile.w.x >= map.w_max) {
        return vec4(0.0);
    }
    float cell = map.scale.x * map.scale.y;
    // The widest window of occluder texels in which one could hide light.
    vec2 widest = 0.5 * (map.w_max - tile.w.x) / map.scale;
    float end = float(map.row - 1);
    ivec2 from = ivec2(clamp(floor((tile.t_min - widest) / float(SUPERBLOCK)), 0.0, end));
    ivec2 to = ivec2(clamp(floor((tile.t_max + widest) / float(SUPERBLOCK)), 0.0, end));
    ivec2 at = from;    // the superblock
    uint children = 0u; // the bits of its blocks that are still to be visited
    while (at.y <= to.y) {
        // Walks to the next block that must be opened. This loop stands apart from opening it, so that invocations
        // that run in step all have one to open.
        Node node;
        vec2 lo;
        int block = 0;
        int plane = 0;
        bool open = false;
        bool pairs = false; // whether some of its back faces count and some do not
        while (!open && at.y <= to.y) {
            bool whole = children == 0u;
            int child = whole ? 0 : findLSB(int(children));
            int index = (at.y * map.row + at.x) * FAMILY + (whole ? 0 : 1 + child);
            ivec2 blocks_at = at * FAN + ivec2(child % FAN, child / FAN);
            lo = vec2(blocks_at * BLOCK);
            float extent = float(whole ? SUPERBLOCK : BLOCK);
            int from_side = side == 1 ? 1 : 0;
            int there = index + from_side * map.row * map.row * FAMILY;
            node = unpack_node(nodes[2 * there], nodes[2 * there + 1]);
            pairs = false;
            if (side == BACK_OR_FRONT) {
                there = index + map.row * map.row * FAMILY;
                Node back = unpack_node(nodes[2 * there], nodes[2 * there + 1]);
                int backs_before = before(back, lo, extent, tile, r);
                pairs = backs_before >= 0;
                if (backs_before > 0 && back.count == node.count) {
                    // A back face has a front face before it, so the two cover the same texels.
                    node = back;
                    from_side = 1;
                    pairs = false;
                } else if (pairs) {
                    node.w_min = min(node.w_min, back.w_min);
                }
            }
            int kind = classify(node, lo, extent, tile.t_min, tile.t_max, tile.w, map.scale, map.spread);
            plane = kind == OUTSIDE ? -1 : plane_side(node, lo, extent, r);
            kind = plane < 0 ? OUTSIDE : (kind == INSIDE && (plane == 0 || pairs)) ? MIXED : kind;
            if (kind == INSIDE) {
                int its = index + from_side * map.row * map.row * FAMILY;
                vec4 m = uintBitsToFloat(nodes[2 * (map.sums / 3) + its]);
                vec4 s = vec4(node.count, 0.0, node.s2, node.s3);
                sum_of_superblock += cell * core_occlusion(s, m, node.mean, lo, r);
            }
            children = !whole ? children & (children - 1u) : kind == MIXED ? node.mask.x : 0u;
            open = kind == MIXED && !whole;
            block = (from_side * map.row * FAN + blocks_at.y) * map.row * FAN + blocks_at.x;
            if (children == 0u) {
                // The sum of its last block, where that must still be opened, is added with the next superblock's.
                sums_of_row[own] += sum_of_superblock;
                sum_of_superblock = vec4(0.0);
                at.x += 1;
                if (at.x > to.x) {
                    at = ivec2(from.x, at.y + 1);
                    sums_of_map[own] += sums_of_row[own];
                    sums_of_row[own] = vec4(0.0);
                }
            }
        }
        if (!open) {
            break;
        }

        // Texels from `outer` on may hide light; those from `core` on lie wholly inside the light for all receivers.
        vec2 reach = 0.5 * (node.w_max - tile.w.x) / map.scale;
        vec2 inner = 0.5 * (node.w_min - tile.w.y) / map.scale;
        ivec2 outer_lo = ivec2(clamp(floor(tile.t_min - reach - lo), 0.0, float(BLOCK)));
        ivec2 outer_hi = ivec2(clamp(ceil(tile.t_max + reach - lo), 0.0, float(BLOCK)));
        uvec2 todo = node.mask & rectangle_mask(outer_lo, outer_hi);
        float deviation = max(node.w_max - node.mean, node.mean - node.w_min);
        int sums = map.sums + 2 * block * BLOCK_TEXELS;
        bool summed = sums + 2 * BLOCK_TEXELS <= nodes.length();
        if (summed && plane > 0 && !pairs && deviation <= map.spread * (node.mean - tile.w.y)) {
            ivec2 core_lo = ivec2(clamp(ceil(tile.t_max - inner - lo), 0.0, float(BLOCK)));
            ivec2 core_hi = ivec2(clamp(floor(tile.t_min + inner - lo), 0.0, float(BLOCK)));
            if (core_lo.x < core_hi.x && core_lo.y < core_hi.y) {
                vec4 s = sums_within(sums, core_lo, core_hi);
                vec4 m = sums_within(sums + 1, core_lo, core_hi);
                sum_of_superblock += cell * core_occlusion(s, m, node.mean, lo, r);
                todo &= ~rectangle_mask(core_lo, core_hi);
            }
        }
        // A block has a sum of its own: adding few large numbers keeps the low digits.
        vec4 part = vec4(0.0);
        int backs = map.row * map.row * FAN * FAN * BLOCK_TEXELS; // the offset from a front face to its back face
        // Each turn handles eight texels: Mesa's CPU driver cuts an invocation off, silently, after 65535 turns of all
        // its loops together.
        while (pairs && (todo.x | todo.y) != 0u) {
            part += next_pair(todo, block, backs, lo, r, map);
            part += next_pair(todo, block, backs, lo, r, map);
            part += next_pair(todo, block, backs, lo, r, map);
            part += next_pair(todo, block, backs, lo, r, map);
            part += next_pair(todo, block, backs, lo, r, map);
            part += next_pair(todo, block, backs, lo, r, map);
            part += next_pair(todo, block, backs, lo, r, map);
            part += next_pair(todo, block, backs, lo, r, map);
        }
        while ((todo.x | todo.y) != 0u) {
            part += next_texel(todo, block, lo, r, map);
            part += next_texel(todo, block, lo, r, map);
            part += next_texel(todo, block, lo, r, map);
            part += next_texel(todo, block, lo, r, map);
            part += next_texel(todo, block, lo, r, map);
            part += next_texel(todo, block, lo, r, map);
            part += next_texel(todo, block, lo, r, map);
            part += next_texel(todo, block, lo, r, map);
        }
        sum_of_superblock += part;
    }
    return sums_of_map[own] + (sums_of_row[own] + sum_of_superblock);
}

#endif
