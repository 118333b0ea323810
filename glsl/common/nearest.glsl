// Entered from nearest.comp, pcss/tiles.comp, occlusion_textures/squares.comp and occlusion_textures/tiles.comp.
//
// The nearest occluder of each node of the map: a square of its texels.

#ifndef COMMON_NEAREST_GLSL
#define COMMON_NEAREST_GLSL

// Texels a side of a node: few enough nodes that looking at all of them takes less time than a tile's pixels.
int node_side(int map)
{
    return max(8, (map + 31) / 32);
}

int nodes_a_row(int map)
{
    int side = node_side(map);
    return (map + side - 1) / side;
}

// The first and, behind it, the last node that hold texels from `lo` to `hi`; none where those lie beside the map.
ivec4 nodes_around(int map, vec2 lo, vec2 hi)
{
    float side = float(node_side(map));
    float end = float(nodes_a_row(map) - 1);
    return ivec4(clamp(floor(lo / side), 0.0, end + 1.0), clamp(floor(hi / side), -1.0, end));
}

#endif
