// Entry of the passes linear_light.keep and linear_light.keep_first (src/techniques/linear_light/segments.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "linear_light/line.glsl"

// Writes a sample's map in the form that pixels fetch: the w of the nearest occluder, and the visible parts of the
// sample's two segments for what lies behind it. A texel holds both for itself and for the next texel in its row.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform texture2DArray seen;
layout(set = 0, binding = 1) uniform texture2D right_channel; // the segment before the sample
layout(set = 0, binding = 2) uniform texture2D left_channel;  // the segment after the sample
layout(set = 0, binding = 3, std430) readonly buffer SegmentState { Segment segment; };
layout(set = 0, binding = 4, rgba32f) writeonly uniform image2DArray maps;

layout(push_constant) uniform Push {
    int map;   // the maps' side in texels
    int layer; // the layer of `maps` to write
} push;

vec2 sample_at(ivec2 p)
{
    vec2 channels = vec2(texelFetch(right_channel, p, 0).x, texelFetch(left_channel, p, 0).x);
    return vec2(texelFetch(seen, ivec3(p, segment.first), 0).x, packed(channels));
}

void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    if (p.x >= push.map || p.y >= push.map) {
        return;
    }
    vec2 next = sample_at(ivec2(min(p.x + 1, push.map - 1), p.y));
    imageStore(maps, ivec3(p, push.layer), vec4(sample_at(p), next));
}
