// Entry of the pass visibility.tiles (src/techniques/soft_shadow_map/pixels.rs); at first skip node.glsl.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "soft_shadow_map/node.glsl"

// Lists the tiles that an occluder may shadow. In the others no node within the light's window lies before any of the
// tile's receivers. One invocation handles one tile.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 2, std430) readonly buffer Nodes { uvec4 nodes[]; };
layout(set = 0, binding = 3, std430) buffer Arguments { uint groups[4]; };
layout(set = 0, binding = 4, std430) buffer Tiles { uint count; uint tiles[]; };
layout(set = 0, binding = 5, r32f) writeonly uniform image2D visibility;

#define GBUFFER
#include "common/light_space.glsl"
#include "common/lists.glsl"
#include "soft_shadow_map/pixels.glsl"

// Nodes that a tile may visit before it counts as one that may be shadowed: a longer walk saves no time, and Mesa's CPU
// driver would cut it off.
const int MOST_NODES = 4096;

// Walks the nodes as the gather does, but once for all of a tile's receivers. It returns false only where the gather of
// each of them adds nothing.
bool may_be_shadowed_by(Tile tile, int row, int sides, float w_max, vec2 scale)
{
    ivec4 around = superblocks_around(tile.t_min, tile.t_max, tile.w.x, row, w_max, scale);
    int left = MOST_NODES - sides * (around.z - around.x + 1) * (around.w - around.y + 1);
    if (left < 0) {
        return true;
    }
    for (int side = 0; side < sides; ++side) {
        for (int y = around.y; y <= around.w; ++y) {
            for (int x = around.x; x <= around.z; ++x) {
                int index = ((side * row + y) * row + x) * FAMILY;
                ivec2 first = ivec2(x, y) * FAN;
                Node whole = unpack_node(nodes[2 * index], nodes[2 * index + 1]);
                bool shadowable = may_shadow(whole, vec2(first * BLOCK), float(SUPERBLOCK), tile.t_min, tile.t_max,
                                    tile.w.x, scale);
                uint children = shadowable ? whole.mask.x : 0u;
                while (children != 0u) {
                    int child = findLSB(int(children));
                    children &= children - 1u;
                    left -= 1;
                    int at = index + 1 + child;
                    Node block = unpack_node(nodes[2 * at], uvec4(0u));
                    vec2 lo = vec2((first + ivec2(child % FAN, child / FAN)) * BLOCK);
                    if (left < 0 || may_shadow(block, lo, float(BLOCK), tile.t_min, tile.t_max, tile.w.x,
                                            scale)) {
                        return true;
                    }
                }
            }
        }
    }
    return false;
}

float nearest_w()
{
    return push.w_max;
}

bool may_be_shadowed(Tile tile)
{
    int sides = 1 + (push.flags & 1);
    return may_be_shadowed_by(tile, push.row, sides, push.w_max, push.scale);
}

#include "visibility/classify.glsl"

void main()
{
    classify_tile(tile_of_invocation());
}
