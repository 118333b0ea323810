// Entered from back_projection.comp, finest_level.comp and next_level.comp.
//
// The levels of a map: level k, from 1 on, holds a pair of w for each 2^k x 2^k texels; levels lie one after the other.

#ifndef BACK_PROJECTION_LEVELS_GLSL
#define BACK_PROJECTION_LEVELS_GLSL

// Nodes along a side of a level.
int level_side(int map, int level)
{
    return (map + (1 << level) - 1) >> level;
}

// The index of a level's first node.
int level_start(int map, int level)
{
    int start = 0;
    for (int k = 1; k < level; ++k) {
        int side = level_side(map, k);
        start += side * side;
    }
    return start;
}

// The level at which a rectangle of this many texels a side touches at most 3x3 nodes.
int level_of(int texels)
{
    return texels <= 4 ? 1 : findMSB(texels - 1);
}

#endif
