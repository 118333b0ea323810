// Entered from visibility/classify.glsl, pcss/pcss.comp, ray_march/trace.comp and others.
//
// Lists of 8x8-pixel tiles and of pixels, and the sizes of the indirect dispatches over them.

#ifndef COMMON_LISTS_GLSL
#define COMMON_LISTS_GLSL

// ---------------------------------------------------------------------------------------------
// The workgroups of an indirect dispatch whose number a shader counts. They are numbered row by row of a grid, because
// some devices take no more than 65,535 in x.

const uint GROUPS_A_ROW = 16384u;

// The number of a workgroup in that order.
uint nth_group(uvec2 id)
{
    return id.y * GROUPS_A_ROW + id.x;
}

// Even numbers first, then odd ones, of `count`. A processor's driver hands each thread one half of the workgroups: where
// shadows lie in one half of the picture, a thread would be done early and wait.
uint alternating(uint nth, uint count)
{
    uint evens = (count + 1u) / 2u;
    return nth < evens ? 2u * nth : 2u * (nth - evens) + 1u;
}

// The size in x and y of the smallest grid of workgroups that holds the nth.
uvec2 groups_as_far_as(uint nth)
{
    return uvec2(min(nth + 1u, GROUPS_A_ROW), nth / GROUPS_A_ROW + 1u);
}

// ---------------------------------------------------------------------------------------------
// Pixels along a tile's side.
const int TILE = 8;
// Listed tiles that a workgroup of 64 invocations handles, with four pixels an invocation; an including shader with one
// pixel an invocation defines it as 1.
#ifndef TILES_A_GROUP
#define TILES_A_GROUP uint(256 / (TILE * TILE))
#endif

// A listed tile is one word: x in bits 0 to 14, y in bits 15 to 29, and in bit 30 whether an occluder may shadow it.
// Where none may, a pixel's own surface is all that can hide the light from it.
uint tile_word(ivec2 tile, bool shadowable)
{
    return uint(tile.x) | uint(tile.y) << 15u | (shadowable ? 1u << 30u : 0u);
}

bool tile_may_be_shadowed(uint word)
{
    return (word & 1u << 30u) != 0u;
}

ivec2 first_pixel(uint word)
{
    return ivec2(word & 0x7fffu, word >> 15u & 0x7fffu) * TILE;
}

// The number of tiles along x that cover an image.
int tiles_a_row(ivec2 extent)
{
    return (extent.x + TILE - 1) / TILE;
}

// The index of a listed tile in an array that holds every tile of the image, row by row.
int nth_tile(uint word, ivec2 extent)
{
    ivec2 tile = first_pixel(word) / TILE;
    return tile.y * tiles_a_row(extent) + tile.x;
}

// The list index of the nth tile of a workgroup, in a list of `count` tiles.
uint tile_in_list(uvec2 group, uint nth, uint count)
{
    uint groups = (count + TILES_A_GROUP - 1u) / TILES_A_GROUP;
    uint at = nth_group(group);
    return (at < groups ? alternating(at, groups) : at) * TILES_A_GROUP + nth;
}

// The size in x and y of the smallest grid of workgroups that reaches the list index `at`.
uvec2 groups_with(uint at)
{
    return groups_as_far_as(at / TILES_A_GROUP);
}

// ---------------------------------------------------------------------------------------------
// The bounds of a tile's receivers in light space: least and largest t and w.
struct Tile {
    vec2 t_min;
    vec2 t_max;
    vec2 w;
};

// The bounds of an empty set of receivers.
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

// How much a compiler may round the same arithmetic differently in another shader: a share of t and w, and of a texel.
const float TILE_ROUNDING = 1.0 / 1048576.0;
const float TILE_TEXEL = 1.0 / 1024.0;

// Bounds that are wide enough for any rounding of the pass over the pixels.
Tile rounded_tile(Tile tile)
{
    vec2 slack = max(abs(tile.t_min), abs(tile.t_max)) * TILE_ROUNDING + TILE_TEXEL;
    return Tile(tile.t_min - slack, tile.t_max + slack,
                vec2(tile.w.x * (1.0 - TILE_ROUNDING), tile.w.y * (1.0 + TILE_ROUNDING)));
}

// ---------------------------------------------------------------------------------------------
// Pixels that a workgroup of the passes over the list handles, one an invocation.
const uint PIXELS_A_GROUP = 64u;

// The list index of an invocation's pixel.
uint place_in_list(uvec2 group, uint invocation)
{
    return nth_group(group) * PIXELS_A_GROUP + invocation;
}

// The size in x and y of the smallest grid of workgroups that reaches the list index `at`.
uvec2 groups_up_to(uint at)
{
    return groups_as_far_as(at / PIXELS_A_GROUP);
}

#endif
