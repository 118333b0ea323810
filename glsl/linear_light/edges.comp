// Entry of the passes linear_light.left_edges and linear_light.right_edges (src/techniques/linear_light/segments.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "linear_light/skin.glsl"
#include "linear_light/line.glsl"

// Writes a skin for each place where an occluder ends in a sample's map, on the side of the neighbouring sample. Their
// order differs from frame to frame; the depth test makes what is drawn of them the same.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform texture2DArray seen;
layout(set = 0, binding = 1, std430) readonly buffer SegmentState { Segment segment; };
layout(set = 0, binding = 2, std430) buffer Skins { vec4 skins[]; };
layout(set = 0, binding = 3, std430) buffer Draws { uint draws[8]; }; // left, right

layout(push_constant) uniform Push {
    vec4 u_window; // least and largest u at the line's first end, at its last
    int map;       // the maps' side in texels
    int side;      // -1: occluders that end towards -x; 1: towards +x
} push;

// The w of a texel's nearest occluder, and of its nearest surface of any kind.
vec2 at(int layer, int x, int y)
{
    if (x < 0 || x >= push.map) {
        return vec2(0.0);
    }
    vec2 w = texelFetch(seen, ivec3(x, y, layer), 0).xy;
    return vec2(w.x, max(w.x, w.y));
}

void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    int layer = push.side > 0 ? segment.first : segment.last;
    if (p.x >= push.map || p.y >= push.map) {
        return;
    }
    vec2 near = at(layer, p.x, p.y);
    float w_seen = at(layer, p.x + push.side, p.y).y;
    // An occluder behind a receiver has no edge that the sample sees.
    if (near.x <= w_seen || near.x < near.y) {
        return;
    }
    float w_before = at(layer, p.x - push.side, p.y).y;
    float w_behind = at(layer, p.x + 2 * push.side, p.y).y;
    if (is_edge(w_before, near.x, w_seen, w_behind)) {
        vec2 window = window_at(push.u_window, push.side > 0 ? segment.along.x : segment.along.y);
        float border = float(p.x) + (push.side > 0 ? 1.0 : 0.0);
        float u = mix(window.x, window.y, border / float(push.map));
        uint vertex = atomicAdd(draws[push.side > 0 ? 4 : 0], 6u);
        skins[vertex / 6u] = vec4(u, near.x, w_seen, float(p.y));
    }
}
