// Entered from traced/tiles.comp, traced/gather.comp and traced/rays.comp.
//
// The hierarchy as it is walked. Nodes lie in depth-first order: a walk goes to the next node where it enters a box, and
// to the node's link where it does not. The including shader declares `nodes`.

#ifndef HIERARCHY_TREE_GLSL
#define HIERARCHY_TREE_GLSL

#include "hierarchy/texels.glsl"

struct Node {
    vec3 low;  // the box, in steps of the root's box
    vec3 high;
    bool leaf;
    uint link; // the node behind the subtree, or the leaf's number
};

// The least corner of the root's box, and the step of all boxes.
vec3 root_low()
{
    return uintBitsToFloat(imageLoad(nodes, texel(0u)).xyz);
}

vec3 root_step()
{
    return uintBitsToFloat(imageLoad(nodes, texel(1u)).xyz);
}

Node node_at(uint nth)
{
    uvec4 words = imageLoad(nodes, texel(HEAD + nth));
    Node node;
    node.low = vec3(words.xyz & 0xffffu);
    node.high = vec3(words.xyz >> 16u);
    node.leaf = (words.w & 1u << 31u) != 0u;
    node.link = words.w & ~(1u << 31u);
    return node;
}

// A plane, as its parts above and below 0, so that the furthest corner of a box needs no choice.
struct Plane {
    vec3 above;
    vec3 below;
    float offset;
};

Plane plane_of(vec4 plane)
{
    return Plane(max(plane.xyz, 0.0), min(plane.xyz, 0.0), plane.w);
}

// How far the furthest corner of a box lies on the inner side of a plane; below 0 where the box lies outside.
float furthest(Plane plane, Node node)
{
    return dot(plane.above, node.high) + (dot(plane.below, node.low) + plane.offset);
}

#endif
