// Entered from hard/hard.comp, pcss/pcss.comp, pcss/tiles.comp and back_projection/back_projection.comp.
//
// The techniques with one occluder map share these push constants and, without `#define NO_MAP`, their inputs and the
// comparisons with the map.

#ifndef COMMON_ONE_MAP_GLSL
#define COMMON_ONE_MAP_GLSL

#define GBUFFER
#include "common/light_space.glsl"

layout(push_constant) uniform Push {
    vec2 texels_per_uv; // map texels a unit of u and v
    vec2 first;         // texel coordinates of u = v = 0
    vec2 half_light;    // half the light's width and height, m; tangents for a sun
    float inv_near;     // the w of the map's near plane; no occluder is nearer
    float snap;         // how far a raster moves a vertex, in texels
    float depth_error;  // how far off an occluder's w may be beyond its rounding, 1/m
    int map;            // the map's side in texels
    int count;          // taps or levels
} push;

#ifndef NO_MAP
#include "common/compare.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 2) uniform texture2D front_depth;
layout(set = 0, binding = 3, r32f) writeonly uniform image2D visibility;

Receiver pixel_receiver(ivec2 p)
{
    Receiver r = receiver_at(p);
    r.receives = r.receives && is_before_light(r.position);
    return r;
}

MapPlane pixel_plane(Receiver r)
{
    float w = w_of(r.position);
    return map_plane_at(uv_of(r.position, w), w, r.normal.xy, n_0_of(r.normal, r.position), c_of(r.normal, r.position),
                        r.blocks, push.texels_per_uv, push.first, push.snap, push.depth_error);
}

// The w of a texel's occluder, 0 where there is none.
float occluder_w(ivec2 texel)
{
    bool outside = any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, ivec2(push.map)));
    return outside ? 0.0 : texelFetch(front_depth, texel, 0).x * push.inv_near;
}

// 1 where the texel's surface hides the receiver for a filter around it, else 0.
float hides(MapPlane m, ivec2 texel)
{
    return in_front_of_filter(m, vec2(texel) + 0.5, occluder_w(texel)) ? 1.0 : 0.0;
}

// The four texels around a place, each compared for itself and weighted as a bilinear filter does.
float hidden_at(MapPlane m, vec2 t)
{
    vec2 corner = floor(t - 0.5);
    vec2 f = t - 0.5 - corner;
    ivec2 texel = ivec2(corner);
    float top = mix(hides(m, texel), hides(m, texel + ivec2(1, 0)), f.x);
    float bottom = mix(hides(m, texel + ivec2(0, 1)), hides(m, texel + ivec2(1, 1)), f.x);
    return mix(top, bottom, f.y);
}
#endif

#endif
