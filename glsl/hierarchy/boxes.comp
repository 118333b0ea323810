// Entry of the pass hierarchy.boxes (src/stages/hierarchy/mod.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "hierarchy/pyramid.glsl"

// The box of every leaf: the pyramid's lowest level.

layout(set = 0, binding = 0, rgba32f) readonly uniform image2D triangles;
layout(set = 0, binding = 1, std430) buffer Boxes { float boxes[]; };

void main()
{
    uint leaf = nth_invocation();
    if (leaf >= push.leaves) {
        return;
    }
    vec3 low = NO_LOW;
    vec3 high = NO_HIGH;
    for (uint i = 3u * LEAF * leaf; i < 3u * LEAF * (leaf + 1u); ++i) {
        vec4 corner = imageLoad(triangles, texel(i));
        low = corner.w > 0.0 ? min(low, corner.xyz) : low;
        high = corner.w > 0.0 ? max(high, corner.xyz) : high;
    }
    for (int axis = 0; axis < 3; ++axis) {
        boxes[6u * leaf + uint(axis)] = low[axis];
        boxes[6u * leaf + 3u + uint(axis)] = high[axis];
    }
}
