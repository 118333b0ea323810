#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "linear_light/segment.glsl"

// A sample's map as pixels ask for it: w of the nearest occluder, and what part of the line the sample adds where it
// sees past, of both of its segments together (section 3.3); of a texel and of the next one in its row.

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

// Lit by both samples is half by each (section 3.2).
float channel(float drawn)
{
    return drawn == 1.0 ? 0.5 : 2.0 * drawn;
}

vec2 told_at(ivec2 p)
{
    float part = 0.0;
    if (here.before > 0.0) {
        part += here.before * channel(texelFetch(right_channel, p, 0).x);
    }
    if (here.behind > 0.0) {
        part += here.behind * channel(texelFetch(left_channel, p, 0).x);
    }
    return vec2(texelFetch(seen, ivec3(p, here.first), 0).x, part);
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
