// Entry of the passes linear_light.keep and linear_light.keep_first (src/techniques/linear_light/segments.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "linear_light/line.glsl"

// A sample's map as pixels ask for it: w of the nearest occluder, and how much of its two segments is seen by what the
// sample sees past it; of a texel and of the next one in its row.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform texture2DArray seen;
layout(set = 0, binding = 1) uniform texture2D right_channel; // of the segment before
layout(set = 0, binding = 2) uniform texture2D left_channel;  // of the segment behind
layout(set = 0, binding = 3, std430) readonly buffer Here { Segment here; };
layout(set = 0, binding = 4, rgba32f) writeonly uniform image2DArray maps;

layout(push_constant) uniform Push {
    int map;   // side in texels
    int layer; // of maps
} push;

vec2 told_at(ivec2 p)
{
    vec2 channels = vec2(texelFetch(right_channel, p, 0).x, texelFetch(left_channel, p, 0).x);
    return vec2(texelFetch(seen, ivec3(p, here.first), 0).x, packed(channels));
}

void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    if (p.x >= push.map || p.y >= push.map) {
        return;
    }
    vec2 next = told_at(ivec2(min(p.x + 1, push.map - 1), p.y));
    imageStore(maps, ivec3(p, push.layer), vec4(told_at(p), next));
}
