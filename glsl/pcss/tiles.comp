// Entry of the pass visibility.tiles (src/techniques/pcss/mod.rs); at first skip common/nearest.glsl.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "common/nearest.glsl"

#define TILES_A_GROUP 1u
#include "common/lists.glsl"

// Lists the tiles whose pixels may find a blocker. The others are lit: no texel of the part of the map that they
// search, the light seen through the nearest occluder, lies before any of their receivers. One invocation handles one
// tile.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 2, std430) readonly buffer Nearest { float nearest[]; };
layout(set = 0, binding = 3, std430) buffer Arguments { uint groups[4]; };
layout(set = 0, binding = 4, std430) buffer Tiles { uint count; uint tiles[]; };
layout(set = 0, binding = 5, r32f) writeonly uniform image2D visibility;

#define NO_MAP
#include "common/one_map.glsl"

vec2 place_of(vec3 position, float w)
{
    return uv_of(position, w) * push.texels_per_uv + push.first;
}

float nearest_w()
{
    return push.inv_near;
}

bool may_be_shadowed(Tile tile)
{
    int row = nodes_a_row(push.map);
    float most = nearest[row * row];
    vec2 reach = push.half_light * push.texels_per_uv * max(most - tile.w.x, 0.0) + 1.0;
    ivec4 around = nodes_around(push.map, tile.t_min - reach, tile.t_max + reach);
    for (int y = around.y; y <= around.w; ++y) {
        for (int x = around.x; x <= around.z; ++x) {
            if (nearest[y * row + x] > tile.w.x) {
                return true;
            }
        }
    }
    return false;
}

#include "visibility/classify.glsl"

void main()
{
    classify_tile(tile_of_invocation());
}
