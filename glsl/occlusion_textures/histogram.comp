// Entry of the pass occlusion_textures.histogram (src/techniques/occlusion_textures/slices.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "occlusion_textures/slices.glsl"

// Counts the texels that have their nearest or their furthest face in each bin of distances.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform texture2D front;
layout(set = 0, binding = 1) uniform texture2D back;
layout(set = 0, binding = 2, std430) buffer Histogram { uint histogram[]; };

layout(push_constant) uniform Push {
    int map;    // the layers' side in texels
    int step;   // the distance in texels of those that are counted
    float near; // distance of the near plane from the projection point, m
    float span; // distance of the furthest occluder from the nearest, m
} push;

void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy) * push.step;
    if (p.x >= push.map || p.y >= push.map) {
        return;
    }
    float nearest = texelFetch(front, p, 0).x;
    if (nearest == 0.0) {
        return;
    }
    atomicAdd(histogram[bin_of(nearest, push.near, push.span)], 1u);
    // A texel of an open mesh may have no back face.
    float furthest = texelFetch(back, p, 0).x;
    if (furthest < 1.0) {
        atomicAdd(histogram[bin_of(furthest, push.near, push.span)], 1u);
    }
}
