// Entry of the pass visibility.tiles_start (src/stages/tiles/mod.rs).
#version 450

// An empty list of tiles.

layout(local_size_x = 1) in;

layout(set = 0, binding = 0, std430) buffer Arguments { uint groups[4]; };
layout(set = 0, binding = 1, std430) buffer Tiles { uint count; uint tiles[]; };

void main()
{
    groups[0] = 0u;
    groups[1] = 0u;
    groups[2] = 1u;
    count = 0u;
}
