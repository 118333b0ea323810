// Entry of the pass traced.tiles (src/techniques/traced/passes.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "traced/frame.glsl"
#include "traced/lists.glsl"

// Makes the shafts of each tile, and counts the leaves of the hierarchy in each: so the work of a tile is known before
// it is done. One invocation handles one tile.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 3, rgba32ui) readonly uniform uimage2D nodes;
layout(set = 0, binding = 4, std430) buffer Slots { Slot slots[]; };
layout(set = 0, binding = 5, r32f) writeonly uniform image2D visibility;

#include "traced/shaft.glsl"

// The turns of a walk: with all other loops of the passes that do it, fewer than the 65,535 after which some drivers end
// loops without a word.
const int MOST_TURNS = 40000;

// Counts the leaves that a shaft holds, up to one more than a list may have, and writes down the first of them.
uint leaves_in(Shaft shaft, uint slot)
{
    Planes planes = planes_of(shaft);
    uint found = 0u;
    uint at = 0u;
    int turns = MOST_TURNS;
    while (at < frame.nodes && found <= frame.most && turns > 0) {
        Node node = node_at(at);
        bool inside = meets(planes, node);
        if (inside && node.leaf && found < FIRST_LEAVES) {
            slots[slot].leaves[found] = node.link;
        }
        found += inside && node.leaf ? 1u : 0u;
        at = inside || node.leaf ? at + 1u : node.link;
        --turns;
    }
    // A walk that is longer than some drivers let loops be is left to rays.
    return at < frame.nodes ? frame.most + 1u : found;
}

// A shaft whose light faces its own receivers.
Shaft faced(Shaft shaft, ivec2 corner)
{
    face_light(shaft.pixels, corner);
    if (frame.kind == ROUND) {
        uint pixels = shaft.pixels;
        shaft = empty_shaft();
        for (int i = 0; i < TILE_PIXELS; ++i) {
            if ((pixels >> i & 1u) != 0u) {
                Receiver r = receiver_of(corner + ivec2(i % TILE_SIDE, i / TILE_SIDE));
                shaft = with_receiver(shaft, r.in_light, uint(i));
            }
        }
    }
    return shaft;
}

// A tile whose receivers lie further apart than this share of their distance from the viewer may be torn.
const float TEAR = 1.0 / 32.0;

void main()
{
    ivec2 tile = ivec2(gl_GlobalInvocationID.xy);
    ivec2 corner = tile * TILE_SIDE;
    ivec2 count = tiles_in(frame.extent);
    if (any(greaterThanEqual(tile, count))) {
        return;
    }
    face_light(vec3(0.0));
    vec3 low = vec3(3.0e38);
    vec3 high = vec3(-3.0e38);
    Shaft one = empty_shaft();
    for (int i = 0; i < TILE_PIXELS; ++i) {
        ivec2 pixel = corner + ivec2(i % TILE_SIDE, i / TILE_SIDE);
        Receiver r = receiver_of(pixel);
        if (r.receives) {
            low = min(low, r.position);
            high = max(high, r.position);
            one = with_receiver(one, r.in_light, uint(i));
        } else if (all(lessThan(pixel, frame.extent))) {
            imageStore(visibility, pixel, vec4(1.0));
        }
    }
    // Two groups on either side of the middle of the longest side.
    vec3 size = high - low;
    int axis = size.x >= max(size.y, size.z) ? 0 : size.y >= size.z ? 1 : 2;
    float middle = 0.5 * (low[axis] + high[axis]);
    float away = length(0.5 * (low + high) - frame.eye.xyz);
    bool may_be_torn = one.pixels != 0u && (size[axis] > TEAR * away || frame.towards.w == 0.0);
    vec2 near = vec2(3.0e38, -3.0e38);
    vec2 far = near;
    Shaft first = empty_shaft();
    Shaft second = empty_shaft();
    for (int i = 0; i < (may_be_torn ? TILE_PIXELS : 0); ++i) {
        Receiver r = receiver_of(corner + ivec2(i % TILE_SIDE, i / TILE_SIDE));
        float x = r.position[axis];
        if (r.receives && x < middle) {
            first = with_receiver(first, r.in_light, uint(i));
            near = vec2(min(near.x, x), max(near.y, x));
        } else if (r.receives) {
            second = with_receiver(second, r.in_light, uint(i));
            far = vec2(min(far.x, x), max(far.y, x));
        }
    }
    // A torn tile: both groups together are much shorter than the whole.
    bool torn = first.pixels != 0u && max(near.y - near.x, 0.0) + max(far.y - far.x, 0.0) < 0.5 * size[axis];
    uint slot = SHAFTS_A_TILE * uint(tile.y * count.x + tile.x);
    if (torn) {
        one = first;
    }
    one = faced(one, corner);
    one.count = one.pixels != 0u ? 1u + leaves_in(one, slot) : 0u;
    slots[slot].shaft = one;
    second = faced(second, corner);
    second.count = torn ? 1u + leaves_in(second, slot + 1u) : 0u;
    slots[slot + 1u].shaft = second;
}
