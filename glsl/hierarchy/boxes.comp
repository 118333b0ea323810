// Entry of the pass hierarchy.boxes (src/stages/hierarchy/mod.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "hierarchy/topology.glsl"

// The box of every node, from the leaves up: the second of two children to come to their parent goes on with it, so that
// both boxes are there. Least and largest coordinates are the same in any order.

layout(set = 0, binding = 0, rgba32f) readonly uniform image2D triangles;
layout(set = 0, binding = 1, std430) readonly buffer Inner { uvec4 inner[]; };
layout(set = 0, binding = 2, std430) readonly buffer Parents { uint parents[]; };
layout(set = 0, binding = 3, std430) coherent buffer Boxes { float boxes[]; };
layout(set = 0, binding = 4, std430) coherent buffer Arrived { uint arrived[]; };

// The box of nothing.
const vec3 LOW = vec3(3.0e38);
const vec3 HIGH = vec3(-3.0e38);

void write_box(uint node, vec3 low, vec3 high)
{
    for (int axis = 0; axis < 3; ++axis) {
        boxes[6u * node + uint(axis)] = low[axis];
        boxes[6u * node + 3u + uint(axis)] = high[axis];
    }
}

vec3 low_of(uint node)
{
    return vec3(boxes[6u * node], boxes[6u * node + 1u], boxes[6u * node + 2u]);
}

vec3 high_of(uint node)
{
    return vec3(boxes[6u * node + 3u], boxes[6u * node + 4u], boxes[6u * node + 5u]);
}

void main()
{
    uint leaf = nth_invocation();
    if (leaf >= push.leaves) {
        return;
    }
    vec3 low = LOW;
    vec3 high = HIGH;
    for (uint i = 3u * LEAF * leaf; i < 3u * LEAF * (leaf + 1u); ++i) {
        vec4 corner = imageLoad(triangles, texel(i));
        low = corner.w > 0.0 ? min(low, corner.xyz) : low;
        high = corner.w > 0.0 ? max(high, corner.xyz) : high;
    }
    uint node = leaf_node(leaf);
    write_box(node, low, high);
    uint parent = parents[node];
    for (uint i = 0u; i < DEEPEST && parent != NO_NODE; ++i) {
        memoryBarrierBuffer();
        if (atomicAdd(arrived[parent], 1u) == 0u) {
            break;
        }
        memoryBarrierBuffer();
        uvec4 of = inner[parent];
        uint a = first_child(of.x, of.z);
        uint b = second_child(of.z, of.y);
        write_box(parent, min(low_of(a), low_of(b)), max(high_of(a), high_of(b)));
        parent = parents[parent];
    }
}
