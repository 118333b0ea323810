// Entered from traced/sums.comp, traced/totals.comp, traced/list.comp and others.
//
// The lists of shafts: which are worked off triangle by triangle, and which by rays. They are made by sums over blocks of
// slots, so that their order, and with it the image, is the same on every device.

#ifndef TRACED_LISTS_GLSL
#define TRACED_LISTS_GLSL

#include "common/lists.glsl"
#include "hierarchy/texels.glsl"

// Slots a block (src/techniques/traced/passes.rs).
const uint BLOCK = 256u;

// What a slot's count says: 0 for no shaft, else one more than the number of leaves in the shaft.
bool is_shaft(uint count, uint most)
{
    return count > 0u && count <= most + 1u;
}

bool is_dense(uint count, uint most)
{
    return count > most + 1u;
}

// The places of a shaft's leaves and their triangles in the lists.
uint room_of(uint count)
{
    return (count - 1u) * (LEAF + 1u);
}

#endif
