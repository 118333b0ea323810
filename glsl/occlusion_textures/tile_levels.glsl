// Where the levels of a tile are kept: from the first one on, as those of any map, in the layers of an image
// array, tile behind tile. The map itself is in the mask.

#ifndef OCCLUSION_TEXTURES_TILE_LEVELS_GLSL
#define OCCLUSION_TEXTURES_TILE_LEVELS_GLSL

#include "nbuffer/levels.glsl"

ivec3 place_of_tile(Levels l, int tile, int level, ivec2 node)
{
    int layers = l.kind == MIP ? 1 : top_of(l);
    return place_of(l, level, node) + ivec3(0, 0, tile * layers - 1);
}

#endif
