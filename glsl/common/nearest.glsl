// Entered from nearest.comp, pcss/tiles.comp, occlusion_textures/squares.comp and occlusion_textures/tiles.comp.
//
// The nearest occluder of each node of an occluder map; a node is a square of its texels.

#ifndef COMMON_NEAREST_GLSL
#define COMMON_NEAREST_GLSL

// A node's side in texels. There are at most 32 nodes along a side, so that reading all of them takes less time than
// shading a tile's pixels.
int node_side(int map)
{
    return max(8, (map + 31) / 32);
}

int nodes_a_row(int map)
{
    int side = node_side(map);
    return (map + side - 1) / side;
}

// The first node (xy) and the last one (zw) that hold texels from `lo` to `hi`. The last lies before the first where
// those texels lie beside the map.
ivec4 nodes_around(int map, vec2 lo, vec2 hi)
{
    float side = float(node_side(map));
    float end = float(nodes_a_row(map) - 1);
    return ivec4(clamp(floor(lo / side), 0.0, end + 1.0), clamp(floor(hi / side), -1.0, end));
}

#endif
