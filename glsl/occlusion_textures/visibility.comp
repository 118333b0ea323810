// Entry of the pass occlusion_textures.visibility (src/techniques/occlusion_textures/pixels.rs); at first skip tile.glsl.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// Writes the visible fraction: the means of slices over a pixel's kernels, combined (Eisemann and Decoret 2008,
// sections 3.3 and 3.5). Means come from summed-area tables, or with `#define LEVELS` from levels. `#define LISTED`
// runs it for the pixels of listed tiles alone.

#ifdef CORRELATED
const bool IS_CORRELATED = true;
#else
const bool IS_CORRELATED = false;
#endif

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 2) uniform texture2D placement;
layout(set = 0, binding = 4, r32f) writeonly uniform image2D visibility;

#define GBUFFER
#include "common/light_space.glsl"
#define PIXELS
#define TILES_A_GROUP 1u
#include "occlusion_textures/slices.glsl"

#ifdef LISTED
layout(set = 0, binding = 6, std430) readonly buffer Tiles { uint count; uint tiles[]; };
layout(set = 0, binding = 7, std430) readonly buffer Met { uint met[]; }; // slices, a bit each, tile by tile
#endif

#ifdef LEVELS
layout(set = 0, binding = 3) uniform texture2DArray filtered;
layout(set = 0, binding = 5) uniform utexture2D mask;

#include "occlusion_textures/tile.glsl"
#define RECTANGLES
#include "occlusion_textures/levels.glsl"
#else
layout(set = 0, binding = 3) uniform utexture2D filtered;

#define SUMMED
#include "occlusion_textures/tile.glsl"

#ifdef CORRELATED
#define NEAR
layout(set = 0, binding = 8) uniform texture2D front_depth;

#include "common/compare.glsl"
#endif
#endif

// The hidden part only grows; from here on the remaining slices change nothing that an eye sees.
const float OPAQUE = 1.0 - 1.0 / 1024.0;

// The shares of a kernel that a slice blocks, that the slices above it block, and that both block; 0 outside the map.
vec3 window_of(int slice, vec4 kernel)
{
    vec2 lo = max(kernel.xy, vec2(0.0));
    vec2 hi = min(kernel.zw, vec2(push.map));
    if (any(lessThanEqual(hi, lo))) {
        return vec3(0.0);
    }
    vec2 inside = (hi - lo) / (kernel.zw - kernel.xy);
    return inside.x * inside.y * mean_of(slice, lo, hi);
}

// Whether no kernel of a point meets an occluder. The kernels' rims move one way from slice to slice, so all of them
// lie between the first one and the last.
bool is_lit(MapWindow m, vec3 position)
{
    float first = texelFetch(placement, ivec2(BINS, 0), 0).z;
    float last = texelFetch(placement, ivec2(BINS + slices() - 1, 0), 0).z;
    vec4 a = kernel_of(m, position, first, push.half_light);
    vec4 b = kernel_of(m, position, min(last, position.z), push.half_light);
    vec2 lo = max(min(a.xy, b.xy), vec2(0.0));
    vec2 hi = min(max(a.zw, b.zw), vec2(push.map));
    return any(lessThanEqual(hi, lo)) || is_empty(lo, hi);
}

#ifdef NEAR
// What hides the light near a surface that blocks: its own slice does not count for it and the slice above only in part
// (`slice_weight`), or it would shadow itself. So the nearest faces are compared with the surface's plane, and those that
// lie before it count for the share that their slice does not.

// Texels a side of the kernel that are looked at. So close to the point that it is cast from it is a texel or two wide, and
// all of its texels count by their share of it, so that nothing jumps; of a wider one so many of its texels count alike.
const int MOST_TEXELS = 5;

// The slice of a face or point, from the depth that the map's projection stores for it.
int slice_of(float stored)
{
    vec4 known = texelFetch(placement, ivec2(0, 0), 0);
    return int(texelFetch(placement, ivec2(bin_of(stored, known.y, known.z), 0), 0).x);
}

vec4 planes_of(int slice)
{
    return texelFetch(placement, ivec2(BINS + slice, 0), 0);
}

// The part of the light that faces near a receiver hide. The kernel lies halfway to where what the slices leave out begins:
// that moves evenly from the begin of the slice above the receiver's own to that of its own, so that nothing jumps.
float hidden_near(Receiver r, MapWindow m)
{
    vec3 from_eye = r.position + vec3(0.0, 0.0, is_parallel() ? 0.0 : push.eye);
    float w = w_of(from_eye);
    MapPlane plane = map_plane_at(uv_of(from_eye, w), w, r.normal.xy, n_0_of(r.normal, from_eye),
                                  c_of(r.normal, from_eye), true, push.texels_per_uv, push.first, push.snap, 0.0);
    int own = slice_of(w / push.top);
    vec4 planes = planes_of(own);
    float into = clamp((r.position.z - planes.x) / (planes.y - planes.x), 0.0, 1.0);
    float above = mix(planes_of(max(own - 1, 0)).x, planes.x, into);
    vec4 kernel = kernel_of(m, r.position, mix(r.position.z, above, 0.5), push.half_light);
    ivec2 first = ivec2(floor(kernel.xy));
    ivec2 texels = ivec2(ceil(kernel.zw)) - first;
    ivec2 count = min(texels, ivec2(MOST_TEXELS));
    vec2 size = kernel.zw - kernel.xy;
    float hidden = 0.0;
    for (int i = 0; i < count.x * count.y; ++i) {
        ivec2 nth = ivec2(i % count.x, i / count.x);
        ivec2 texel = first + (2 * nth + 1) * texels / (2 * count);
        if (any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, ivec2(push.map)))) {
            continue;
        }
        float stored = texelFetch(front_depth, texel, 0).x;
        if (in_front_of_filter(plane, vec2(texel) + 0.5, stored * push.top)) {
            planes = planes_of(slice_of(stored));
            vec2 within = min(kernel.zw, vec2(texel + 1)) - max(kernel.xy, vec2(texel));
            vec2 share = mix(1.0 / vec2(count), within / size, equal(count, texels));
            hidden += share.x * share.y * (1.0 - slice_weight(r.position.z, planes.x, planes.y, true));
        }
    }
    return hidden;
}
#endif

// The part of the light that slices hide; `left` has a bit for each slice that may block anything.
float hidden_at(Receiver r, uint left)
{
    MapWindow m = map_window();
    if (is_lit(m, r.position)) {
        return 0.0;
    }
    float hidden = 0.0;
    float before = 0.0;
    int last = -1;
    while (left != 0u && hidden < OPAQUE) {
        int slice = findLSB(int(left));
        left &= left - 1u;
        vec4 planes = texelFetch(placement, ivec2(BINS + slice, 0), 0);
        float weight = slice_weight(r.position.z, planes.x, planes.y, r.blocks || !IS_CORRELATED);
        if (weight == 0.0) {
            break;
        }
        vec3 window = window_of(slice, kernel_of(m, r.position, planes.z, push.half_light));
        // A slice that blocks nothing of its window hides nothing more.
        if (window.x == 0.0) {
            continue;
        }
#ifdef CORRELATED
        float right_above = last == slice - 1 ? before : 0.0;
        hidden = mix(hidden, hidden_with_correlated(hidden, right_above, window), weight);
        before = window.x;
        last = slice;
#else
        hidden = hidden_with(combination(), hidden, weight * window.x);
#endif
    }
#ifdef NEAR
    // A texel's nearest face has no slice above it, so that what is near hides another part of the light.
    if (looks_near() && r.blocks && hidden < OPAQUE) {
        hidden = min(hidden + hidden_near(r, m), 1.0);
    }
#endif
    return hidden;
}

void main()
{
#ifdef LISTED
    uint at = tile_in_list(gl_WorkGroupID.xy, 0u, count);
    if (at >= count) {
        return;
    }
    uint meets = tile_may_be_shadowed(tiles[at]) ? met[nth_tile(tiles[at], gbuffer.extent)] : 0u;
    ivec2 p = first_pixel(tiles[at]) + ivec2(gl_LocalInvocationID.xy);
#else
    uint meets = all_slices();
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
#endif
    if (p.x >= gbuffer.extent.x || p.y >= gbuffer.extent.y) {
        return;
    }
    Receiver r = receiver_without_normal(p);
    if (!is_served(r.position)) {
        return;
    }
    float v = 1.0;
    if (r.receives && is_before_light(r.position)) {
        if (r.blocks) {
            // The part of the light above the pixel's own plane.
            r.normal = receiver_normal(p, r.position);
            v = fraction_above(r.normal.xy * push.half_light, c_of(r.normal, r.position));
        }
        if (meets != 0u && v > 0.0) {
            v = min(v, 1.0 - hidden_at(r, meets));
        }
    }
    imageStore(visibility, p, vec4(v));
}
