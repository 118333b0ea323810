#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// The visible fraction: what the samples that a pixel sees say of it, summed (section 3 and 3.3).

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform texture2D gbuffer_depth;
layout(set = 0, binding = 1) uniform texture2D gbuffer_mask;
layout(set = 0, binding = 2) uniform texture2DArray maps;
layout(set = 0, binding = 3, r32f) writeonly uniform image2D visibility;

#include "common/gbuffer.glsl"
#include "common/light.glsl"
#include "baseline/compare.glsl"

layout(push_constant) uniform Push {
    mat4 light_from_ndc;
    vec4 u_window;   // least and largest u at the line's first end, at its last
    vec4 v_window;   // least and largest v at the light's least y, at its largest
    vec2 half_light; // half the light's width and height, m
    ivec2 extent;    // of the G-buffer
    float background;
    float snap;      // how far a raster moves a vertex, in texels
    int map;         // the maps' side in texels
    int flags;       // samples a line; from bit 8 on lines; bit 16: masked
} push;

int samples() { return push.flags & 255; }
int lines() { return push.flags >> 8 & 255; }
bool is_masked() { return (push.flags & 1 << 16) != 0; }

// Of a sample's two segments, what a texel of its map says: w, and the parts that it adds of each.
vec2 told_at(ivec2 texel, int sample_nth, int first_segment)
{
    float w = 0.0;
    float part = 0.0;
    if (sample_nth > 0) {
        vec4 before = texelFetch(maps, ivec3(texel, first_segment + sample_nth - 1), 0);
        w = before.z;
        part += before.w;
    }
    if (sample_nth + 1 < samples()) {
        vec4 after = texelFetch(maps, ivec3(texel, first_segment + sample_nth), 0);
        w = after.x;
        part += after.y;
    }
    return vec2(w, part);
}

// The parts of a sample's segments that a receiver sees: the mean of four texels of which it is behind none.
float part_of(Receiver r, int sample_nth, int line)
{
    float along = float(sample_nth) / float(samples() - 1);
    float across = (float(line) + 0.5) / float(lines());
    vec2 place = (2.0 * vec2(along, across) - 1.0) * push.half_light;
    vec3 p = r.position - vec3(place, 0.0);
    vec3 normal = r.normal;
    if (dot(normal, p) >= 0.0) {
        // The sample is below the pixel's plane, whose other side is seen where it does not block.
        if (r.blocks) {
            return 0.0;
        }
        normal = -normal;
    }
    vec2 u = mix(push.u_window.xy, push.u_window.zw, along);
    vec2 v = mix(push.v_window.xy, push.v_window.zw, across);
    vec2 per_uv = float(push.map) / vec2(u.y - u.x, v.y - v.x);
    MapPlane m = map_plane(p, normal, per_uv, -vec2(u.x, v.x) * per_uv, push.snap, 0.0);
    // Where nothing blocks, both ends of a segment see half of it.
    float free = sample_nth == 0 || sample_nth + 1 == samples() ? 0.5 : 1.0;
    vec2 corner = floor(m.t - 0.5);
    vec2 f = m.t - 0.5 - corner;
    float sum = 0.0;
    for (int i = 0; i < 4; ++i) {
        ivec2 q = ivec2(i & 1, i >> 1);
        ivec2 texel = ivec2(corner) + q;
        float weight = (q.x == 1 ? f.x : 1.0 - f.x) * (q.y == 1 ? f.y : 1.0 - f.y);
        bool outside = any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, ivec2(push.map)));
        vec2 told = outside ? vec2(0.0, free) : told_at(texel, sample_nth, line * (samples() - 1));
        sum += in_front_of_filter(m, vec2(texel) + 0.5, told.x) ? 0.0 : weight * told.y;
    }
    return sum;
}

void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    if (p.x >= push.extent.x || p.y >= push.extent.y) {
        return;
    }
    GBuffer g = GBuffer(push.light_from_ndc, push.extent, push.background, is_masked());
    Receiver r = receiver_at(g, p);
    float v = 1.0;
    // Behind the light's plane there is nothing to hide.
    if (r.receives && r.position.z > 0.0) {
        float sum = 0.0;
        for (int line = 0; line < lines(); ++line) {
            for (int i = 0; i < samples(); ++i) {
                sum += part_of(r, i, line);
            }
        }
        v = min(sum / float(lines() * (samples() - 1)), 1.0);
        if (r.blocks) {
            // The part of the light above the pixel's own plane.
            v = min(v, fraction_above(r.normal.xy * push.half_light, dot(r.normal, r.position)));
        }
    }
    imageStore(visibility, p, vec4(v));
}
