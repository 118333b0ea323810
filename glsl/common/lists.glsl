// Entered from visibility/classify.glsl, pcss/pcss.comp, ray_march/trace.comp and others.
//
// Lists of tiles of pixels and of pixels, and the workgroups of the passes over them.

#ifndef COMMON_LISTS_GLSL
#define COMMON_LISTS_GLSL

// ---------------------------------------------------------------------------------------------
// Workgroups of an indirect dispatch whose number a shader counts. They stand in rows, because not every device
// takes more than 65,535 in x.

const uint GROUPS_A_ROW = 16384u;

// Which of the workgroups one is.
uint nth_group(uvec2 id)
{
    return id.y * GROUPS_A_ROW + id.x;
}

// Workgroups in x and y that reach as far as the nth.
uvec2 groups_as_far_as(uint nth)
{
    return uvec2(min(nth + 1u, GROUPS_A_ROW), nth / GROUPS_A_ROW + 1u);
}

// ---------------------------------------------------------------------------------------------
// Pixels a side.
const int TILE = 8;
// Listed tiles a workgroup of 64 invocations: of four pixels each, unless the including shader says one.
#ifndef TILES_A_GROUP
#define TILES_A_GROUP uint(256 / (TILE * TILE))
#endif

// A listed tile is one word: x, y, and whether any occluder may hide light there. Where none is, what its pixels'
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

// ---------------------------------------------------------------------------------------------
// Where the receivers of a tile lie in light space: least and largest t and w.
struct Tile {
    vec2 t_min;
    vec2 t_max;
    vec2 w;
};

// The bounds of no receiver.
Tile empty_tile()
{
    return Tile(vec2(3.0e38), vec2(-3.0e38), vec2(3.0e38, -3.0e38));
}

bool is_empty_tile(Tile tile)
{
    return tile.w.x > tile.w.y;
}

Tile with_receiver(Tile tile, vec2 t, float w)
{
    return Tile(min(tile.t_min, t), max(tile.t_max, t), vec2(min(tile.w.x, w), max(tile.w.y, w)));
}

// What a compiler may make of the same arithmetic in another shader: shares of t and w, and of a texel.
const float TILE_ROUNDING = 1.0 / 1048576.0;
const float TILE_TEXEL = 1.0 / 1024.0;

// Bounds that hold whatever rounding the pass over the pixels has.
Tile rounded_tile(Tile tile)
{
    vec2 slack = max(abs(tile.t_min), abs(tile.t_max)) * TILE_ROUNDING + TILE_TEXEL;
    return Tile(tile.t_min - slack, tile.t_max + slack,
                vec2(tile.w.x * (1.0 - TILE_ROUNDING), tile.w.y * (1.0 + TILE_ROUNDING)));
}

// ---------------------------------------------------------------------------------------------
// Pixels a workgroup of the passes over the list, one an invocation.
const uint PIXELS_A_GROUP = 64u;

// The place in the list that an invocation works at.
uint place_in_list(uvec2 group, uint invocation)
{
    return nth_group(group) * PIXELS_A_GROUP + invocation;
}

// Workgroups in x and y that reach as far as a place in the list.
uvec2 groups_up_to(uint at)
{
    return groups_as_far_as(at / PIXELS_A_GROUP);
}

#endif
