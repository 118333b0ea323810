// What the techniques with one occluder map have in common: their inputs, and comparisons with the map.

#ifndef COMMON_PIXELS_GLSL
#define COMMON_PIXELS_GLSL

#include "common/compare.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform texture2D gbuffer_depth;
layout(set = 0, binding = 1) uniform texture2D gbuffer_mask;
layout(set = 0, binding = 2) uniform texture2D front_depth;
layout(set = 0, binding = 3, r32f) writeonly uniform image2D visibility;

#include "common/gbuffer.glsl"
#include "common/push.glsl"

Receiver pixel_receiver(ivec2 p)
{
    Receiver r = receiver_at(gbuffer(), p);
    // Behind the light's plane there is nothing to hide.
    r.receives = r.receives && r.position.z > 0.0;
    return r;
}

MapPlane pixel_plane(Receiver r)
{
    return map_plane(r.position, r.normal, r.blocks, push.texels_per_uv, push.first, push.snap,
                     push.depth_error);
}

// w of a texel, 0 where there is nothing.
float w_of(ivec2 texel)
{
    bool outside = any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, ivec2(push.map)));
    return outside ? 0.0 : texelFetch(front_depth, texel, 0).x * push.inv_near;
}

// Whether the texel's surface hides the receiver of a filter, as 1 or 0.
float hides(MapPlane m, ivec2 texel)
{
    return in_front_of_filter(m, vec2(texel) + 0.5, w_of(texel)) ? 1.0 : 0.0;
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
