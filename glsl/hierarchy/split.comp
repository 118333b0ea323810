// Entry of the pass hierarchy.split (src/stages/hierarchy/mod.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "hierarchy/topology.glsl"

// Makes the tree over the sorted leaves (Karras 2012, section 4): an inner node covers the leaves whose keys share their
// first bits, and splits them by the next bit. One invocation makes one inner node, and writes where the triangles of
// one leaf are.

layout(set = 0, binding = 0, std430) readonly buffer Keys { uvec2 keys[]; };
layout(set = 0, binding = 1, std430) buffer Places { uint places[]; };
layout(set = 0, binding = 2, std430) buffer Inner { uvec4 inner[]; };
layout(set = 0, binding = 3, std430) buffer Parents { uint parents[]; };

int leading_zeros(uint x)
{
    return (x & 1u << 31u) != 0u ? 0 : 31 - findMSB(int(x));
}

// How many leading bits the keys of two leaves share; equal keys go on with the leaves' numbers, so that no two are
// equal, and no path is longer than 64 bits.
int shared_bits(int a, int b)
{
    if (b < 0 || b >= int(push.leaves)) {
        return -1;
    }
    uint x = keys[uint(a) * LEAF].x;
    uint y = keys[uint(b) * LEAF].x;
    return x != y ? leading_zeros(x ^ y) : 32 + leading_zeros(uint(a) ^ uint(b));
}

void main()
{
    uint n = nth_invocation();
    if (n >= push.leaves) {
        return;
    }
    for (uint i = n * LEAF; i < (n + 1u) * LEAF; ++i) {
        places[keys[i].y] = i;
    }
    int leaf = int(n);
    if (n == 0u) {
        parents[0] = NO_NODE;
    }
    if (n + 1u >= push.leaves) {
        return;
    }
    // The node reaches from its leaf to the side whose neighbour shares more bits.
    int side = shared_bits(leaf, leaf + 1) > shared_bits(leaf, leaf - 1) ? 1 : -1;
    int outside = shared_bits(leaf, leaf - side);
    int most = 2;
    while (shared_bits(leaf, leaf + most * side) > outside) {
        most *= 2;
    }
    int reach = 0;
    for (int step = most / 2; step >= 1; step /= 2) {
        if (shared_bits(leaf, leaf + (reach + step) * side) > outside) {
            reach += step;
        }
    }
    int end = leaf + reach * side;
    int shared_here = shared_bits(leaf, end);
    int before = 0;
    for (int step = most / 2; step >= 1; step /= 2) {
        if (before + step <= reach && shared_bits(leaf, leaf + (before + step) * side) > shared_here) {
            before += step;
        }
    }
    uint first = uint(min(leaf, end));
    uint last = uint(max(leaf, end));
    uint split = uint(leaf + before * side + min(side, 0));
    inner[n] = uvec4(first, last, split, 0u);
    parents[first_child(first, split)] = n;
    parents[second_child(split, last)] = n;
}
