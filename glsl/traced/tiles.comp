// Entry of the pass traced.tiles (src/techniques/traced/mod.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "traced/frame.glsl"
#include "traced/shaft.glsl"

// Makes the shafts of each tile, and counts the leaves of the hierarchy in each: so the work of a tile is known before
// it is done. One invocation handles one tile.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 3, rgba32ui) readonly uniform uimage2D nodes;
layout(set = 0, binding = 4, std430) readonly buffer Header { vec4 root_low; vec4 root_step; };
layout(set = 0, binding = 5, std430) writeonly buffer Shafts { Shaft shafts[]; };
layout(set = 0, binding = 6, std430) writeonly buffer Counts { uint counts[]; };
layout(set = 0, binding = 7, r32f) writeonly uniform image2D visibility;

// How many leaves a shaft holds, up to one more than a list may have.
uint leaves_in(Shaft shaft)
{
    Planes planes = planes_of(shaft, root_low.xyz, root_step.xyz);
    uint found = 0u;
    uint at = 0u;
    while (at < frame.nodes && found <= frame.most) {
        Node node = unpacked_node(imageLoad(nodes, texel(at)));
        bool inside = meets(planes, node);
        found += inside && node.leaf ? 1u : 0u;
        at = inside || node.leaf ? at + 1u : node.link;
    }
    return found;
}

void main()
{
    ivec2 tile = ivec2(gl_GlobalInvocationID.xy);
    ivec2 count = tiles_in(frame.extent);
    if (any(greaterThanEqual(tile, count))) {
        return;
    }
    vec3 low = vec3(3.0e38);
    vec3 high = vec3(-3.0e38);
    for (int i = 0; i < TILE_PIXELS; ++i) {
        ivec2 pixel = tile * TILE_SIDE + ivec2(i % TILE_SIDE, i / TILE_SIDE);
        Receiver r = receiver_of(pixel);
        if (r.receives) {
            low = min(low, r.position);
            high = max(high, r.position);
        } else if (all(lessThan(pixel, frame.extent))) {
            imageStore(visibility, pixel, vec4(1.0));
        }
    }
    // Two groups on either side of the middle of the longest side.
    vec3 size = high - low;
    int axis = size.x >= max(size.y, size.z) ? 0 : size.y >= size.z ? 1 : 2;
    float middle = 0.5 * (low[axis] + high[axis]);
    vec3 low_of[2] = vec3[2](vec3(3.0e38), vec3(3.0e38));
    vec3 high_of[2] = vec3[2](vec3(-3.0e38), vec3(-3.0e38));
    Shaft one = empty_shaft();
    Shaft first = empty_shaft();
    Shaft second = empty_shaft();
    for (int i = 0; i < TILE_PIXELS; ++i) {
        Receiver r = receiver_of(tile * TILE_SIDE + ivec2(i % TILE_SIDE, i / TILE_SIDE));
        if (r.receives) {
            one = with_receiver(one, r.in_light, uint(i));
            if (r.position[axis] < middle) {
                first = with_receiver(first, r.in_light, uint(i));
                low_of[0] = min(low_of[0], r.position);
                high_of[0] = max(high_of[0], r.position);
            } else {
                second = with_receiver(second, r.in_light, uint(i));
                low_of[1] = min(low_of[1], r.position);
                high_of[1] = max(high_of[1], r.position);
            }
        }
    }
    // A torn tile: both groups together are much smaller than the whole.
    vec3 parts = max(high_of[0] - low_of[0], 0.0) + max(high_of[1] - low_of[1], 0.0);
    bool torn = first.pixels != 0u && parts[axis] < 0.5 * size[axis];
    uint slot = SHAFTS_A_TILE * uint(tile.y * count.x + tile.x);
    if (torn) {
        one = first;
    }
    shafts[slot] = one;
    shafts[slot + 1u] = second;
    // An empty list is one pixel's work still; a shaft without pixels has no list.
    counts[slot] = one.pixels != 0u ? 1u + leaves_in(one) : 0u;
    counts[slot + 1u] = torn ? 1u + leaves_in(second) : 0u;
}
