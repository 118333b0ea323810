// Entry of the pass occlusion_textures.next_level (src/techniques/occlusion_textures/prefilter.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "occlusion_textures/levels.glsl"

// Means of a level's windows, from four of the level before it (Decoret 2005). One tile each z.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0, rgba16f) uniform image2DArray levels;

layout(push_constant) uniform Push {
    int map;   // the map's side in texels
    int kind;  // the kind of the levels' windows
    int level; // the one to make
} push;

vec4 node_value(Levels l, int tile, ivec2 node)
{
    int side = side_of(l, push.level - 1);
    if (node.x >= side || node.y >= side) {
        return vec4(0.0);
    }
    return imageLoad(levels, place_of_tile(l, tile, push.level - 1, node));
}

void main()
{
    ivec2 node = ivec2(gl_GlobalInvocationID.xy);
    int tile = int(gl_GlobalInvocationID.z);
    Levels l = Levels(push.map, push.kind);
    int side = side_of(l, push.level);
    if (node.x >= side || node.y >= side) {
        return;
    }
    int apart = push.kind == MIP ? 1 : 1 << (push.level - 1);
    ivec2 p = push.kind == MIP ? 2 * node : node;
    vec4 sum = node_value(l, tile, p) + node_value(l, tile, p + ivec2(apart, 0)) +
               node_value(l, tile, p + ivec2(0, apart)) + node_value(l, tile, p + ivec2(apart, apart));
    imageStore(levels, place_of_tile(l, tile, push.level, node), 0.25 * sum);
}
