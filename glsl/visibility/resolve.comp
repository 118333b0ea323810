// Entry of the pass visibility.resolve (src/stages/visibility/mod.rs); at first skip common/light_space.glsl.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// Projects the soft shadow map onto the G-buffer's pixels (Atty 2006, section 3.1): bilinear over the texels whose
// receiver lies on the pixel's own plane. Of both sides' maps it takes the larger occlusion (section 3.5) or the mean.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 2) uniform texture2D receiver_depth;
layout(set = 0, binding = 3) uniform texture2D front_map;
layout(set = 0, binding = 4) uniform texture2D back_map;
layout(set = 0, binding = 5, r32f) writeonly uniform image2D visibility;

#define GBUFFER
#include "common/light_space.glsl"

layout(push_constant) uniform Push {
    vec2 texels_per_uv;      // receiver texels a unit of u and v
    vec2 first;              // receiver-texel coordinates of u = v = 0
    float receiver_inv_near; // 1/m
    int receiver_map;        // the map's side in texels
    int mean;                // 1: the mean of both maps, not their maximum
} push;

float occlusion_at(ivec2 texel)
{
    float front = texelFetch(front_map, texel, 0).x;
    float back = texelFetch(back_map, texel, 0).x;
    return push.mean != 0 ? merged_sides(vec4(front), vec4(back)).x : max(front, back);
}

// The share of the plane's own slope over a texel by which a texel on it may be off: half a texel in
// each axis, where its centre is, and as much again for the raster that sampled it.
const float SLOPE = 1.0;
// The map's depth holds 24 bits, the G-buffer's position about 22.
const float MAP_ROUNDING = 1.0 / 1048576.0;

float filtered(vec3 position, vec3 normal)
{
    float w = w_of(position);
    vec2 at = uv_of(position, w) * push.texels_per_uv + push.first;
    // Outside the map no penumbra reaches.
    if (any(lessThan(at, vec2(0.0))) || any(greaterThan(at, vec2(push.receiver_map)))) {
        return 0.0;
    }
    vec2 corner = floor(at - 0.5);
    vec2 f = at - 0.5 - corner;
    // On the plane w is linear over the map.
    float c = c_of(normal, position);
    vec2 slope = abs(c) > 0.0 ? normal.xy / (c * push.texels_per_uv) : vec2(0.0);

    float sum = 0.0;
    float weight = 0.0;
    float plain = 0.0;
    for (int i = 0; i < 4; ++i) {
        vec2 o = vec2(i & 1, i >> 1);
        ivec2 texel = clamp(ivec2(corner + o), ivec2(0), ivec2(push.receiver_map - 1));
        float bilinear = (o.x > 0.0 ? f.x : 1.0 - f.x) * (o.y > 0.0 ? f.y : 1.0 - f.y);
        float v = occlusion_at(texel);
        plain += bilinear * v;
        float w_texel = texelFetch(receiver_depth, texel, 0).x * push.receiver_inv_near;
        float w_plane = w + dot(slope, vec2(texel) + 0.5 - at);
        float allowed = SLOPE * (abs(slope.x) + abs(slope.y)) + MAP_ROUNDING * w;
        if (abs(w_texel - w_plane) <= allowed) {
            sum += bilinear * v;
            weight += bilinear;
        }
    }
    // Where no texel holds this surface, another receiver hides it from the light's centre. The map has no better value
    // than its own texels.
    return weight > 1.0e-3 ? sum / weight : plain;
}

void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    if (p.x >= gbuffer.extent.x || p.y >= gbuffer.extent.y) {
        return;
    }
    Receiver r = receiver_without_normal(p);
    float v = 1.0;
    if (r.receives && is_before_light(r.position)) {
        vec3 normal = receiver_normal(p, r.position);
        v = 1.0 - min(filtered(r.position, normal), 1.0);
    }
    imageStore(visibility, p, vec4(v));
}
