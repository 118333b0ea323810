// See visibility_sat.comp. The including shader declares `filtered` and `mean_of`.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform texture2D gbuffer_depth;
layout(set = 0, binding = 1) uniform texture2D gbuffer_mask;
layout(set = 0, binding = 2) uniform texture2D placement;
layout(set = 0, binding = 4, r32f) writeonly uniform image2D visibility;

#include "common/gbuffer.glsl"
#include "common/light.glsl"
#include "occlusion_textures/placement.glsl"
#include "occlusion_textures/kernel.glsl"
#include "occlusion_textures/combine.glsl"

layout(push_constant) uniform Push {
    mat4 light_from_ndc;
    vec2 texels_per_uv; // map texels a unit of u and v
    vec2 first;         // texel coordinates of u = v = 0
    vec2 half_light;    // half the light's width and height, m
    ivec2 extent;       // of the G-buffer
    float background;
    float eye;          // how far behind the light the projection point is, m
    float plane;        // where in a slice its texture lies: 0 above, 1 below
    int map;            // the map's side in texels
    int flags;          // slices; bit 8: masked; from bit 9 on how slices are combined; from bit 12 on levels
} push;

int slices() { return push.flags & 255; }
bool is_masked() { return (push.flags & 256) != 0; }
int combination() { return push.flags >> 9 & 7; }

// What a tile's slices hide of the light's rays through a kernel: outside the map nothing.
vec4 window_of(int tile, vec4 kernel)
{
    vec2 lo = max(kernel.xy, vec2(0.0));
    vec2 hi = min(kernel.zw, vec2(push.map));
    if (any(lessThanEqual(hi, lo))) {
        return vec4(0.0);
    }
    vec2 inside = (hi - lo) / (kernel.zw - kernel.xy);
    return inside.x * inside.y * mean_of(tile, push.map, lo, hi);
}

float hidden_at(Receiver r)
{
    MapWindow m = MapWindow(push.texels_per_uv, push.first, push.eye);
    float hidden = 0.0;
    for (int slice = 0; slice < slices(); ++slice) {
        vec4 planes = texelFetch(placement, ivec2(BINS + slice, 0), 0);
        float weight = slice_weight(r.position.z, planes.x, planes.y, r.blocks);
        if (weight == 0.0) {
            break;
        }
        vec4 kernel = kernel_of(m, r.position, mix(planes.x, planes.y, push.plane), push.half_light);
#ifdef CORRELATED
        vec4 window = window_of(slice, kernel);
        float with = hidden_with_correlated(hidden, window);
        hidden = mix(hidden, with, weight);
#else
        vec4 window = window_of(slice >> 2, kernel);
        hidden = hidden_with(combination(), hidden, weight * window[slice & 3]);
#endif
    }
    return hidden;
}

void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    if (p.x >= push.extent.x || p.y >= push.extent.y) {
        return;
    }
    GBuffer g = GBuffer(push.light_from_ndc, push.extent, push.background, is_masked());
    Receiver r = receiver_without_normal(g, p);
    float v = 1.0;
    // Behind the light's plane there is nothing to hide.
    if (r.receives && r.position.z > 0.0) {
        if (r.blocks) {
            // The part of the light above the pixel's own plane.
            r.normal = facet_normal(g, p, depth_at(p), r.position);
            v = fraction_above(r.normal.xy * push.half_light, dot(r.normal, r.position));
        }
        if (v > 0.0) {
            v = min(v, 1.0 - hidden_at(r));
        }
    }
    imageStore(visibility, p, vec4(v));
}
