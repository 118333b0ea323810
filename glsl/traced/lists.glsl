// Entered from traced/tiles.comp, traced/sums.comp, traced/gather.comp, traced/cover.comp and others.
//
// Shafts, and the lists of those that are worked off triangle by triangle and of those that send rays. Each tile has slots
// for its shafts. The lists are made by sums over blocks of slots, so that their order, and with it the image, is the same
// on every device.

#ifndef TRACED_LISTS_GLSL
#define TRACED_LISTS_GLSL

#include "common/lists.glsl"
#include "hierarchy/texels.glsl"

// A shaft: the region that holds every segment from a group of receivers to the light; traced/shaft.glsl makes it.
struct Shaft {
    vec4 low;    // the sides where x and y are least: x >= low.x + low.y z, y >= low.z + low.w z
    vec4 high;   // and largest
    vec3 middle; // the box around the receivers in light space: its middle
    uint pixels; // a bit for each of the tile's pixels whose receiver is in the group
    vec3 across; // and half its sides, which turn with the surface
    uint count;  // 0 for no shaft, else one more than the number of leaves of the hierarchy in it
    vec3 along;
    float far;   // the largest z of the receivers
    vec3 over;
    float near;  // the least z of the receivers
};

// The leaves of a shaft that are written down as they are counted (src/techniques/traced/passes.rs).
const uint FIRST_LEAVES = 6u;

struct Slot {
    Shaft shaft;
    uvec2 others; // the nodes from and to which there are more
    uint leaves[FIRST_LEAVES];
};

// A listed shaft, with its triangles.
struct Entry {
    uint slot;
    uint first;    // where its triangles begin
    uint few;      // the first of them, each of which hides samples in a few rows of samples alone
    uint others;   // where those begin that may hide any samples
    uint many;     // how many these are
    uint crossing; // 1 where some triangles cross a lamp's plane
};

// What comes before the entries: the shafts of the list from its beginning on, and from its end backwards; those behind
// it, which have triangles, and the workgroups that cover them.
struct Head {
    uint shafts;
    uint dense;
    uint shadowed;
    uint groups[3];
};

// Slots a block (src/techniques/traced/passes.rs).
const uint BLOCK = 256u;

bool is_listed(uint count, uint most)
{
    return count > 0u && count <= most + 1u;
}

bool is_dense(uint count, uint most)
{
    return count > most + 1u;
}

// The places of the triangles of a shaft's leaves.
uint room_of(uint count)
{
    return (count - 1u) * LEAF;
}

// The nth of a number of workgroups, the even ones first: drivers that cut a dispatch in halves get halves of equal work.
uint evens_first(uint nth, uint count)
{
    uint evens = (count + 1u) / 2u;
    return nth < evens ? 2u * nth : 2u * (nth - evens) + 1u;
}

#endif
