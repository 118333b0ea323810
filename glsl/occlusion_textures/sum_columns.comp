// Entry of the pass occlusion_textures.sum_columns (src/techniques/occlusion_textures/prefilter.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "occlusion_textures/tile.glsl"

// Summed-area tables, second half: adds to every sum along a row of texels those above it. One invocation handles
// one column of a tile. In whole numbers a table of any map is exact: 4096 x 4096 ones are 2^24.

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, rgba32ui) uniform uimage2D sums;

layout(push_constant) uniform Push {
    int map; // the map's side in texels
} push;

void main()
{
    int x = int(gl_GlobalInvocationID.x);
    int tile = int(gl_GlobalInvocationID.y);
    if (x >= push.map) {
        return;
    }
    Sums sum = Sums(uvec4(0u), 0u);
    for (int y = 0; y < push.map; ++y) {
        ivec2 p = place_in_image((tile * push.map + y) * push.map + x);
        Sums more = unpacked(imageLoad(sums, p));
        sum = Sums(sum.four + more.four, sum.fifth + more.fifth);
        imageStore(sums, p, packed(sum));
    }
}
