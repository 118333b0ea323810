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
    vec3 least;  // the box around the receivers in light space
    uint pixels; // a bit for each of the tile's pixels whose receiver is in the group
    vec3 most;
    uint count;  // 0 for no shaft, else one more than the number of leaves of the hierarchy in it
};

// The leaves of a shaft that are written down as they are counted (src/techniques/traced/passes.rs).
const uint FIRST_LEAVES = 16u;

struct Slot {
    Shaft shaft;
    uint leaves[FIRST_LEAVES];
};

// A listed shaft, with the places of its triangles: first those that do not cross a lamp's plane, then those that do.
struct Entry {
    uint slot;
    uint first; // where its leaves begin
    uint plain_first;
    uint plain;
    uint crossing_first;
    uint crossing;
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

// The places of a shaft's leaves and their triangles.
uint room_of(uint count)
{
    return (count - 1u) * (LEAF + 1u);
}

// The nth of a number of workgroups, the even ones first: drivers that cut a dispatch in halves get halves of equal work.
uint evens_first(uint nth, uint count)
{
    uint evens = (count + 1u) / 2u;
    return nth < evens ? 2u * nth : 2u * (nth - evens) + 1u;
}

#endif
