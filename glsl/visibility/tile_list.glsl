// Tiles of pixels, and the list of those that are not done yet.

#ifndef VISIBILITY_TILE_LIST_GLSL
#define VISIBILITY_TILE_LIST_GLSL

#include "common/groups.glsl"

// Pixels a side.
const int TILE = 8;
// Listed tiles a workgroup of 64 invocations: of four pixels each, unless the including shader says one.
#ifndef TILES_A_GROUP
#define TILES_A_GROUP uint(256 / (TILE * TILE))
#endif

// A listed tile is one word: x, y, and whether any occluder may be felt there. Where none is, what its pixels'
// own surfaces hide is all there is to tell.
uint tile_word(ivec2 tile, bool felt)
{
    return uint(tile.x) | uint(tile.y) << 15u | (felt ? 1u << 30u : 0u);
}

bool is_felt_tile(uint word)
{
    return (word & 1u << 30u) != 0u;
}

ivec2 first_pixel(uint word)
{
    return ivec2(word & 0x7fffu, word >> 15u & 0x7fffu) * TILE;
}

// Tiles side by side, of an image.
int tiles_a_row(ivec2 extent)
{
    return (extent.x + TILE - 1) / TILE;
}

// Where something that is kept of every tile, row by row, is of a listed one.
int nth_tile(uint word, ivec2 extent)
{
    ivec2 tile = first_pixel(word) / TILE;
    return tile.y * tiles_a_row(extent) + tile.x;
}

// The place in the list of the tiles that a workgroup works at.
uint tile_in_list(uvec2 group, uint nth)
{
    return nth_group(group) * TILES_A_GROUP + nth;
}

// Workgroups in x and y that reach as far as the tile at a place in the list.
uvec2 groups_with(uint at)
{
    return groups_as_far_as(at / TILES_A_GROUP);
}

#endif
