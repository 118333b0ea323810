// Entry of the pass soft_shadow_map.gather_pixels (src/techniques/soft_shadow_map/pixels.rs); at first skip node.glsl.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// The gather at the G-buffer's own pixels: no receiver map, no resampling, and no split into occluders and receivers,
// because a texel counts only where it lies above the pixel's own plane. One invocation handles 2x2 pixels, one lane of
// each vec4 a pixel. `#define LISTED` runs it for the pixels of listed tiles alone.

layout(local_size_x = 64) in;

#define GBUFFER
#include "common/light_space.glsl"
#include "soft_shadow_map/node.glsl"

layout(set = 0, binding = 2, std430) readonly buffer Texels { uint texels[]; };
layout(set = 0, binding = 3, std430) readonly buffer Nodes { uvec4 nodes[]; };
layout(set = 0, binding = 4, r32f) writeonly uniform image2D visibility;

#ifdef LISTED
layout(set = 0, binding = 5, std430) readonly buffer Tiles { uint count; uint tiles[]; };
#include "common/lists.glsl"
#endif

#include "soft_shadow_map/pixels.glsl"

struct Receivers {
    vec4 t_x;
    vec4 t_y;
    vec4 w;
    // A texel's centre (x, y) at w lies n.x x + n.y y + n_0 - c w above the plane, in units of 1/w.
    vec4 n_x;
    vec4 n_y;
    vec4 n_0;
    vec4 c;
    vec4 bias; // the largest error of that height
};

bvec4 is_above(vec2 lo, vec4 w_o, Receivers r)
{
    vec4 above = (lo.x + 0.5) * r.n_x + (lo.y + 0.5) * r.n_y + r.n_0 - r.c * w_o;
    return greaterThan(above, r.bias);
}

// 1 where every texel of a node is above the plane for sure, -1 where none is, 0 otherwise.
int plane_side(Node node, vec2 lo, float side, Receivers r)
{
    vec2 mid = lo + 0.5 * side;
    float half_side = 0.5 * side - 0.5;
    vec4 centre = mid.x * r.n_x + mid.y * r.n_y + r.n_0;
    vec4 reach = half_side * (abs(r.n_x) + abs(r.n_y));
    vec4 c_near = r.c * node.w_max;
    vec4 c_far = r.c * node.w_min;
    vec4 least = centre - reach - max(c_near, c_far);
    vec4 most = centre + reach - min(c_near, c_far);
    bvec4 nothing = equal(r.w, vec4(NOTHING));
    if (all(lessThanEqual(mix(most, vec4(-NOTHING), nothing), r.bias))) {
        return -1;
    }
    return all(greaterThan(mix(least, vec4(NOTHING), nothing), r.bias)) ? 1 : 0;
}

#define SLOPED
#include "soft_shadow_map/gather.glsl"

void main()
{
    uint l = gl_LocalInvocationIndex;
    uvec2 within = uvec2((l & 1u) | ((l >> 1) & 2u) | ((l >> 2) & 4u),
                         ((l >> 1) & 1u) | ((l >> 2) & 2u) | ((l >> 3) & 4u));
#ifdef LISTED
    uint at = tile_in_list(gl_WorkGroupID.xy, l * TILES_A_GROUP / 64u, count);
    if (at >= count) {
        return;
    }
    uint tile = tiles[at];
    bool shadowable = tile_may_be_shadowed(tile);
    ivec2 quad = first_pixel(tile) + ivec2(within & uint(TILE / 2 - 1)) * 2;
#else
    bool shadowable = true;
    ivec2 quad = ivec2(gl_WorkGroupID.xy * 8u + within) * 2;
#endif
    if (quad.x >= gbuffer.extent.x || quad.y >= gbuffer.extent.y) {
        return;
    }
    vec2 half_light = 0.5 / (push.scale * push.texels_per_uv);
    Receivers r;
    bvec4 served;
    vec4 below; // the part of the light under the pixel's own surface, where that blocks
    for (int i = 0; i < 4; ++i) {
        Receiver p = receiver_at(quad + ivec2(i & 1, i >> 1));
        served[i] = is_served(p.position);
        bool there = p.receives && served[i] && is_before_light(p.position);
        float w = there ? w_of(p.position) : 0.0;
        vec2 t = place_of(p.position, w);
        vec2 n = p.normal.xy / push.texels_per_uv;
        float c = c_of(p.normal, p.position);
        r.t_x[i] = t.x;
        r.t_y[i] = t.y;
        r.n_x[i] = n.x;
        r.n_y[i] = n.y;
        r.n_0[i] = n_0_of(p.normal, p.position) - dot(n, push.first);
        r.c[i] = c;
        // A patch stands for the surface within half a texel's diagonal of its centre.
        r.bias[i] = own_slope(p.blocks) * 0.5 * length(1.0 / push.texels_per_uv) +
                    plane_rounding(n, r.n_0[i], c, t, w, push.snap, push.depth_error);
        below[i] = there && p.blocks ? 1.0 - fraction_above(p.normal.xy * half_light, c) : 0.0;
        // In a tile that no occluder can shadow, only a pixel's own surface hides light.
        r.w[i] = there && shadowable ? w : NOTHING;
    }
    int slopes = (1 + (push.flags & 1)) * push.row * push.row * FAN * FAN * BLOCK_TEXELS;
    Map map = Map(push.scale, push.w_max, push.spread, push.row, push.sums, slopes);
    vec4 hidden = below;
    bool mean = (push.flags & 2) != 0;
    for (int side = 0; side <= (push.flags & 1); ++side) {
        // A receiver from which all of the light is hidden needs no second side.
        r.w = mix(r.w, vec4(NOTHING), greaterThanEqual(hidden, vec4(1.0)));
        vec4 sum = below + gather(map, side == 1 && mean ? BACK_OR_FRONT : side, r);
        hidden = side == 1 && mean ? merged_sides(hidden, sum) : max(hidden, sum);
    }
    // Where patches are seen from behind, some may be less than nothing together.
    vec4 v = 1.0 - clamp(hidden, below, vec4(1.0));
    for (int i = 0; i < 4; ++i) {
        ivec2 p = quad + ivec2(i & 1, i >> 1);
        if (served[i] && p.x < gbuffer.extent.x && p.y < gbuffer.extent.y) {
            imageStore(visibility, p, vec4(v[i]));
        }
    }
}
