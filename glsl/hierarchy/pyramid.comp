// Entry of the pass hierarchy.pyramid (src/stages/hierarchy/mod.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "hierarchy/pyramid.glsl"

// Makes one level of the pyramid from the one below.

layout(set = 0, binding = 0, std430) buffer Boxes { float boxes[]; };

void main()
{
    uint nth = nth_invocation();
    if (nth * WIDE >= push.count) {
        return;
    }
    vec3 low = NO_LOW;
    vec3 high = NO_HIGH;
    uint end = min((nth + 1u) * WIDE, push.count);
    for (uint i = nth * WIDE; i < end; ++i) {
        uint at = 6u * (push.start + i);
        low = min(low, vec3(boxes[at], boxes[at + 1u], boxes[at + 2u]));
        high = max(high, vec3(boxes[at + 3u], boxes[at + 4u], boxes[at + 5u]));
    }
    uint to = 6u * (push.start + push.count + nth);
    for (int axis = 0; axis < 3; ++axis) {
        boxes[to + uint(axis)] = low[axis];
        boxes[to + 3u + uint(axis)] = high[axis];
    }
}
