// Entry of the pass occlusion_textures.sum_rows (src/techniques/occlusion_textures/prefilter.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "occlusion_textures/scan.glsl"

// Summed-area tables, first half: adds to every texel those before it in its row of texels.

#ifdef PARTED
layout(local_size_x = 128) in;
#else
layout(local_size_x = 64) in;
#endif

layout(set = 0, binding = 0) uniform utexture2D mask;
layout(set = 0, binding = 1, rgba32ui) writeonly uniform uimage2D sums;

layout(push_constant) uniform Push {
    int map; // the map's side in texels
    int correlated;
} push;

void main()
{
    int at = int(gl_LocalInvocationIndex);
    int y = LINES * int(gl_WorkGroupID.x) + at % LINES;
    int tile = int(gl_WorkGroupID.y);
    int first = (tile * push.map + y) * push.map;
    Sums sum = Sums(uvec4(0u), 0u);
#ifdef PARTED
    ivec2 range = y < push.map ? texels_of(at / LINES, push.map) : ivec2(0);
    for (int x = range.x; x < range.y; ++x) {
        sum = plus(sum, tile_sums(texelFetch(mask, ivec2(x, y), 0).x, tile, push.correlated != 0));
    }
    sum = sums_before(at, sum);
#else
    if (y >= push.map) {
        return;
    }
    ivec2 range = ivec2(0, push.map);
#endif
    for (int x = range.x; x < range.y; ++x) {
        sum = plus(sum, tile_sums(texelFetch(mask, ivec2(x, y), 0).x, tile, push.correlated != 0));
        imageStore(sums, place_in_image(first + x), packed(sum));
    }
}
