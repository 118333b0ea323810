// Entry of the pass occlusion_textures.sum_columns (src/techniques/occlusion_textures/prefilter.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "occlusion_textures/scan.glsl"

// Summed-area tables, second half: adds to every sum along a row of texels those above it. In whole numbers a table of
// any map is exact: 4096 x 4096 ones are 2^24.

#ifdef PARTED
layout(local_size_x = 128) in;
#else
layout(local_size_x = 64) in;
#endif

layout(set = 0, binding = 0, rgba32ui) uniform uimage2D sums;

layout(push_constant) uniform Push {
    int map; // the map's side in texels
} push;

void main()
{
    int at = int(gl_LocalInvocationIndex);
    int x = LINES * int(gl_WorkGroupID.x) + at % LINES;
    int tile = int(gl_WorkGroupID.y);
    int first = tile * push.map * push.map + x;
    Sums sum = Sums(uvec4(0u), 0u);
#ifdef PARTED
    ivec2 range = x < push.map ? texels_of(at / LINES, push.map) : ivec2(0);
    for (int y = range.x; y < range.y; ++y) {
        sum = plus(sum, unpacked(imageLoad(sums, place_in_image(first + y * push.map))));
    }
    sum = sums_before(at, sum);
#else
    if (x >= push.map) {
        return;
    }
    ivec2 range = ivec2(0, push.map);
#endif
    for (int y = range.x; y < range.y; ++y) {
        ivec2 p = place_in_image(first + y * push.map);
        sum = plus(sum, unpacked(imageLoad(sums, p)));
        imageStore(sums, p, packed(sum));
    }
}
