// Entry of the pass back_projection.visibility (src/techniques/back_projection/mod.rs); at first skip filled.glsl and levels.glsl.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "common/one_map.glsl"
#include "back_projection/filled.glsl"
#include "back_projection/levels.glsl"

// Back-projection in screen space (Guennebaud 2006): each pixel projects the map's texels around it onto
// the light, each reaching over the gap to its neighbours on two sides, and adds up what they hide.

layout(set = 0, binding = 4, std430) readonly buffer Levels { vec2 levels[]; };

// The least and the largest w of the texels from `lo` to `hi`, and of a few more around them.
vec2 range_over(ivec2 lo, ivec2 hi)
{
    int level = min(level_of(max(hi.x - lo.x, hi.y - lo.y) + 1), push.count);
    int side = level_side(push.map, level);
    int start = level_start(push.map, level);
    vec2 range = vec2(3.0e38, 0.0);
    for (int y = lo.y >> level; y <= hi.y >> level; ++y) {
        for (int x = lo.x >> level; x <= hi.x >> level; ++x) {
            vec2 r = levels[start + y * side + x];
            range = vec2(min(range.x, r.x), max(range.y, r.y));
        }
    }
    return range;
}

// A texel's magnification onto the light; 0 where its surface is not in front.
float magnification_at(MapPlane m, ivec2 texel)
{
    float w_o = occluder_w(texel);
    return in_front(m, vec2(texel) + 0.5, w_o) ? 1.0 / (w_o - m.w) : 0.0;
}

// The next texel's share of the occlusion; `k_left` is the magnification of the texel before it, and becomes its own.
float next_texel(MapPlane m, ivec2 texel, vec2 scale, int end, inout float k_left)
{
    float k = texel.x <= end ? magnification_at(m, texel) : 0.0;
    float hidden = 0.0;
    if (k > 0.0) {
        float k_above = magnification_at(m, texel - ivec2(0, 1));
        hidden = filled_occlusion(vec2(texel), m.t, k, k_left, k_above, scale);
    }
    k_left = k;
    return hidden;
}

// Whether every texel from `lo` to `hi` is in front of the pixel and none is further than 1/w_min: then a surface
// without a hole covers all that the pixel sees of the light.
bool covered(MapPlane m, vec2 lo, vec2 hi, float w_min)
{
    vec2 middle = 0.5 * (lo + hi) + 0.5;
    vec2 half_size = 0.5 * (hi - lo);
    float least = dot(middle, m.n) - dot(half_size, abs(m.n)) + m.n_0 - m.c * w_min;
    return w_min > m.w && m.c < 0.0 && least > m.rounding + m.slope * 0.5 * length(m.texel);
}

float hidden_of(MapPlane m)
{
    vec2 texels = push.half_light * push.texels_per_uv;
    vec2 scale = 0.5 / texels;
    // The window within which the nearest occluder could hide light; then that of the nearest occluder within it.
    float w_max = push.inv_near;
    vec2 range = vec2(0.0);
    ivec2 lo = ivec2(0);
    ivec2 hi = ivec2(0);
    bool inside = false;
    for (int i = 0; i < 4; ++i) {
        vec2 reach = texels * (w_max - m.w);
        // A bound far outside the map would overflow an int.
        vec2 from = clamp(floor(m.t - reach), -2.0, float(push.map));
        vec2 to = clamp(floor(m.t + reach), -2.0, float(push.map));
        lo = max(ivec2(from), ivec2(0));
        hi = min(ivec2(to), ivec2(push.map - 1));
        inside = ivec2(from) == lo && ivec2(to) == hi;
        if (w_max <= m.w || lo.x > hi.x || lo.y > hi.y) {
            return 0.0;
        }
        range = range_over(lo, hi);
        w_max = min(w_max, range.y);
    }
    if (w_max <= m.w) {
        return 0.0;
    }
    if (inside && covered(m, vec2(lo), vec2(hi), range.x)) {
        return 1.0;
    }
    float sum = 0.0;
    for (int y = lo.y; y <= hi.y && sum < 1.0; ++y) {
        float k_left = magnification_at(m, ivec2(lo.x - 1, y));
        float row = 0.0;
        for (int x = lo.x; x <= hi.x; x += 8) {
            // Eight at a time: Mesa's CPU driver cuts an invocation off, silently, after 65535 turns of
            // all its loops together.
            row += next_texel(m, ivec2(x, y), scale, hi.x, k_left);
            row += next_texel(m, ivec2(x + 1, y), scale, hi.x, k_left);
            row += next_texel(m, ivec2(x + 2, y), scale, hi.x, k_left);
            row += next_texel(m, ivec2(x + 3, y), scale, hi.x, k_left);
            row += next_texel(m, ivec2(x + 4, y), scale, hi.x, k_left);
            row += next_texel(m, ivec2(x + 5, y), scale, hi.x, k_left);
            row += next_texel(m, ivec2(x + 6, y), scale, hi.x, k_left);
            row += next_texel(m, ivec2(x + 7, y), scale, hi.x, k_left);
        }
        sum += row;
    }
    return sum;
}

void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
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
        // The light that the pixel's own surface hides, where that surface blocks.
        float hidden = r.blocks ? 1.0 - fraction_above(r.normal.xy * push.half_light, m.c) : 0.0;
        if (hidden < 1.0) {
            hidden += hidden_of(m);
        }
        v = 1.0 - min(hidden, 1.0);
    }
    imageStore(visibility, p, vec4(v));
}
