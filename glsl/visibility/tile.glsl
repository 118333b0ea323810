// Where the receivers of a tile of pixels lie in light space.

#ifndef VISIBILITY_TILE_GLSL
#define VISIBILITY_TILE_GLSL

#include "visibility/tile_list.glsl"
// Least and largest t and w of some receivers.
struct Tile {
    vec2 t_min;
    vec2 t_max;
    vec2 w;
};

// Of no receiver.
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

#endif
