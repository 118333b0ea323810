// Entry of the pass hierarchy.nodes (src/stages/hierarchy/mod.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "hierarchy/pyramid.glsl"

// Writes the nodes as they are walked: in depth-first order, 16 bytes each, with a box of 16-bit steps of the root's.

layout(set = 0, binding = 0, std430) readonly buffer Boxes { float boxes[]; };
layout(set = 0, binding = 1, std430) readonly buffer Inner { uvec4 inner[]; };
layout(set = 0, binding = 2, std430) readonly buffer Order { uint order[]; };
layout(set = 0, binding = 3, rgba32ui) writeonly uniform uimage2D nodes;

// Boxes are this share of a step wider than they are, which is more than their arithmetic rounds.
const float MARGIN = 1.0 / 16.0;
const float STEPS = 65535.0;

struct Box {
    vec3 low;
    vec3 high;
};

Box with_box(Box box, uint nth)
{
    uint at = 6u * nth;
    return Box(min(box.low, vec3(boxes[at], boxes[at + 1u], boxes[at + 2u])),
               max(box.high, vec3(boxes[at + 3u], boxes[at + 4u], boxes[at + 5u])));
}

// The box of the leaves from `first` to before `end`.
Box box_of(uint first, uint end)
{
    Box box = Box(NO_LOW, NO_HIGH);
    uint start = 0u;
    uint count = push.leaves;
    for (uint level = 0u; level < LEVELS && first < end; ++level) {
        if (count == 1u) {
            box = with_box(box, start);
            first = end;
        }
        while (first < end && first % WIDE != 0u) {
            box = with_box(box, start + first);
            first += 1u;
        }
        while (first < end && (end % WIDE != 0u && end != count)) {
            end -= 1u;
            box = with_box(box, start + end);
        }
        // A level's last box may hold fewer than eight. Where nothing is left, rounding up would go on with a box of others.
        bool left = first < end;
        first = left ? first / WIDE : 0u;
        end = left ? (end + WIDE - 1u) / WIDE : 0u;
        start += count;
        count = (count + WIDE - 1u) / WIDE;
    }
    return box;
}

// The box of all leaves, which is the pyramid's last.
Box root_box()
{
    uint start = 0u;
    uint count = push.leaves;
    for (uint level = 0u; level < LEVELS && count > 1u; ++level) {
        start += count;
        count = (count + WIDE - 1u) / WIDE;
    }
    return with_box(Box(NO_LOW, NO_HIGH), start);
}

void main()
{
    uint node = nth_invocation();
    if (node > 2u * (push.leaves - 1u)) {
        return;
    }
    Box root = root_box();
    bool is_leaf = node >= push.leaves - 1u;
    uint leaf = node - (push.leaves - 1u);
    uvec4 of = is_leaf ? uvec4(leaf, leaf, 0u, 0u) : inner[node];
    Box box = box_of(of.x, of.y + 1u);
    // The least step keeps a flat root from dividing by nothing; it is far below a float's precision of the rest.
    vec3 extent = max(root.high - root.low, 0.0);
    float largest = max(max(extent.x, extent.y), max(extent.z, 1.0e-30));
    vec3 steps = max(extent, vec3(1.0e-6 * largest)) / (STEPS - 2.0);
    if (node == 0u) {
        imageStore(nodes, texel(0u), uvec4(floatBitsToUint(root.low - steps), 0u));
        imageStore(nodes, texel(1u), uvec4(floatBitsToUint(steps), 0u));
    }
    uvec3 a = uvec3(STEPS);
    uvec3 b = uvec3(0u);
    if (box.low.x <= box.high.x) {
        a = uvec3(clamp(floor((box.low - root.low) / steps + 1.0 - MARGIN), 0.0, STEPS));
        b = uvec3(clamp(ceil((box.high - root.low) / steps + 1.0 + MARGIN), 0.0, STEPS));
    }
    uint place = order[node];
    uint link = is_leaf ? 1u << 31u | leaf : place + 2u * (of.y - of.x + 1u) - 1u;
    imageStore(nodes, texel(HEAD + place), uvec4(a | b << 16u, link));
}
