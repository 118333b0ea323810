// Entry of the pass hierarchy.nodes (src/stages/hierarchy/mod.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "hierarchy/topology.glsl"

// Writes the nodes as they are walked: in depth-first order, 16 bytes each, with a box of 16-bit steps of the root's.

layout(set = 0, binding = 0, std430) readonly buffer Boxes { float boxes[]; };
layout(set = 0, binding = 1, std430) readonly buffer Inner { uvec4 inner[]; };
layout(set = 0, binding = 2, std430) readonly buffer Order { uint order[]; };
layout(set = 0, binding = 3, rgba32ui) writeonly uniform uimage2D nodes;
layout(set = 0, binding = 4, std430) writeonly buffer Header { vec4 root_low; vec4 root_step; };

// Boxes are this share of a step wider than they are, which is more than their arithmetic rounds.
const float MARGIN = 1.0 / 16.0;
const float STEPS = 65535.0;

vec3 corner(uint node, uint side)
{
    uint at = 6u * node + 3u * side;
    return vec3(boxes[at], boxes[at + 1u], boxes[at + 2u]);
}

void main()
{
    uint node = nth_invocation();
    if (node > 2u * (push.leaves - 1u)) {
        return;
    }
    vec3 root = corner(0u, 0u);
    // The least step keeps a flat root from dividing by nothing; it is far below a float's precision of the rest.
    vec3 extent = corner(0u, 1u) - root;
    float largest = max(max(extent.x, extent.y), max(extent.z, 1.0e-30));
    vec3 steps = max(extent, vec3(1.0e-6 * largest)) / (STEPS - 2.0);
    if (node == 0u) {
        root_low = vec4(root - steps, 0.0);
        root_step = vec4(steps, 0.0);
    }
    vec3 low = corner(node, 0u);
    vec3 high = corner(node, 1u);
    uvec3 a = uvec3(STEPS);
    uvec3 b = uvec3(0u);
    if (low.x <= high.x) {
        a = uvec3(clamp(floor((low - root) / steps + 1.0 - MARGIN), 0.0, STEPS));
        b = uvec3(clamp(ceil((high - root) / steps + 1.0 + MARGIN), 0.0, STEPS));
    }
    bool is_leaf = node >= push.leaves - 1u;
    uint place = order[node];
    uint leaf = node - (push.leaves - 1u);
    uint link = is_leaf ? 1u << 31u | leaf : place;
    if (!is_leaf) {
        uvec4 of = inner[node];
        link = place + 2u * (of.y - of.x + 1u) - 1u;
    }
    imageStore(nodes, texel(place), uvec4(a | b << 16u, link));
}
