// Entry of the pass pcss.visibility (src/techniques/pcss/mod.rs); at first skip disc.glsl.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// Percentage-closer soft shadows (Fernando 2005): the blockers around a pixel's place in the map give the blockers'
// distance, and that gives the width of the penumbra over which comparisons are averaged. `#define LISTED` runs it for
// the pixels of listed tiles alone.

#include "common/nearest.glsl"
#include "common/one_map.glsl"
#include "pcss/disc.glsl"

// The largest w of each node of the map, and behind them that of all.
layout(set = 0, binding = 5, std430) readonly buffer Nearest { float nearest[]; };

#ifdef LISTED
#define TILES_A_GROUP 1u
#include "common/lists.glsl"
layout(set = 0, binding = 4, std430) readonly buffer Tiles { uint count; uint tiles[]; };
#endif

// Nodes along the sides of the part of a map whose nearest occluder is looked for: beyond so many that of all has to do.
const int MOST_NODES = 6;

// The largest w that a blocker of a pixel can have, which lies at `t` texels and at `w`. A blocker at w_o lies within the
// light seen through w_o, `texels` (w_o - w) around the pixel's place: so the nearest occluder of all bounds where blockers
// lie, the nearest one there bounds it more tightly, and so on.
float nearest_blocker(vec2 t, float w, vec2 texels)
{
    int row = nodes_a_row(push.map);
    float most = nearest[row * row];
    for (int i = 0; i < 3; ++i) {
        vec2 reach = texels * max(most - w, 0.0) + 1.0;
        ivec4 around = nodes_around(push.map, t - reach, t + reach);
        if (any(greaterThanEqual(around.zw - around.xy, ivec2(MOST_NODES)))) {
            break;
        }
        float found = 0.0;
        for (int y = around.y; y <= around.w; ++y) {
            for (int x = around.x; x <= around.z; ++x) {
                found = max(found, nearest[y * row + x]);
            }
        }
        most = min(most, found);
    }
    return most;
}

// The mean distance of the blockers within `reach` texels; 0 where there are none.
float blocker_distance(MapPlane m, vec2 reach, float turn)
{
    float sum = 0.0;
    float found = 0.0;
    for (int i = 0; i < push.count; ++i) {
        vec2 at = m.t + reach * disc_to_square(disc_point(i, push.count) + vec2(0.0, turn));
        ivec2 texel = ivec2(floor(at));
        float w_o = occluder_w(texel);
        if (in_front_of_filter(m, vec2(texel) + 0.5, w_o)) {
            sum += is_parallel() ? w_o : 1.0 / w_o;
            found += 1.0;
        }
    }
    return found > 0.0 ? sum / found : 0.0;
}

void main()
{
#ifdef LISTED
    uint at = tile_in_list(gl_WorkGroupID.xy, 0u, count);
    if (at >= count) {
        return;
    }
    bool shadowable = tile_may_be_shadowed(tiles[at]);
    ivec2 p = first_pixel(tiles[at]) + ivec2(gl_LocalInvocationID.xy);
#else
    bool shadowable = true;
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
#endif
    if (p.x >= gbuffer.extent.x || p.y >= gbuffer.extent.y) {
        return;
    }
    Receiver r = pixel_receiver(p);
    if (!is_served(r.position)) {
        return;
    }
    float v = 1.0;
    if (r.receives) {
        MapPlane m = pixel_plane(r);
        float turn = pixel_turn(uint(p.x), uint(p.y));
        // The part of the light below the pixel's own plane is a closed form, so that no tap needs to sample it.
        v = r.blocks ? fraction_above(r.normal.xy * push.half_light, m.c) : 1.0;
        // The light seen through the nearest blocker, and then through the blockers' mean distance: similar
        // triangles, half_light (1/d - w) in u and v.
        vec2 texels = push.half_light * push.texels_per_uv;
        float blockers = 0.0;
        float most = shadowable && v > 0.0 ? nearest_blocker(m.t, m.w, texels) : 0.0;
        if (most > m.w) {
            blockers = blocker_distance(m, texels * (most - m.w), turn);
        }
        if (blockers > 0.0) {
            vec2 reach = texels * max((is_parallel() ? blockers : 1.0 / blockers) - m.w, 0.0);
            float hidden = 0.0;
            float taps = 0.0;
            for (int i = 0; i < push.count; ++i) {
                vec2 place = disc_to_square(disc_point(i, push.count) + vec2(0.0, turn));
                // A tap stands for the part of the light behind it.
                if (!r.blocks || dot(r.normal.xy, place * push.half_light) > m.c) {
                    hidden += hidden_at(m, m.t + reach * place);
                    taps += 1.0;
                }
            }
            v *= 1.0 - hidden / max(taps, 1.0);
        }
    }
    imageStore(visibility, p, vec4(clamp(v, 0.0, 1.0)));
}
