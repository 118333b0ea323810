// Entry of the pass occlusion_textures.sum_rows (src/techniques/occlusion_textures/prefilter.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "occlusion_textures/tile.glsl"

// Summed-area tables, first half: adds to every texel those before it in its row of texels. One invocation handles one
// row of a tile's texels.

layout(local_size_x = 64) in;

layout(set = 0, binding = 0) uniform utexture2D mask;
layout(set = 0, binding = 1, rgba32ui) writeonly uniform uimage2D sums;

layout(push_constant) uniform Push {
    int map; // the map's side in texels
    int correlated;
} push;

void main()
{
    int y = int(gl_GlobalInvocationID.x);
    int tile = int(gl_GlobalInvocationID.y);
    if (y >= push.map) {
        return;
    }
    int first = (tile * push.map + y) * push.map;
    Sums sum = Sums(uvec4(0u), 0u);
    for (int x = 0; x < push.map; ++x) {
        Sums more = tile_sums(texelFetch(mask, ivec2(x, y), 0).x, tile, push.correlated != 0);
        sum = Sums(sum.four + more.four, sum.fifth + more.fifth);
        imageStore(sums, place_in_image(first + x), packed(sum));
    }
}
