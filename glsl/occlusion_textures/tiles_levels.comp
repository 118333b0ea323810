#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// Which tiles of pixels meet nothing, by squares of the mask, where means come from levels: from windows that are
// larger than the kernels, and from those beside them.

#include "common/nearest.glsl"
#include "occlusion_textures/tiles.glsl"

layout(set = 0, binding = 2) uniform utexture2D squares;

uint met_by(Tile tile)
{
    MapWindow m = map_window();
    vec4 all = vec4(3.0e38, 3.0e38, -3.0e38, -3.0e38);
    uint counts = 0u; // a bit a slice
    for (int slice = 0; slice < slices(); ++slice) {
        vec4 planes = planes_of(slice);
        if (is_below(planes, tile)) {
            break;
        }
        vec4 kernel = tile_kernel(m, tile, planes.z, push.half_light);
        vec2 reach = tile_reach(m, tile, planes.z, push.half_light);
        float more = level_reach(2.0 * min(reach.x, reach.y));
        all = vec4(min(all.xy, kernel.xy - more), max(all.zw, kernel.zw + more));
        counts |= 1u << uint(slice);
    }
    uint found = 0u;
    ivec4 around = nodes_around(push.map, all.xy, all.zw);
    for (int y = around.y; y <= around.w; ++y) {
        for (int x = around.x; x <= around.z; ++x) {
            found |= texelFetch(squares, ivec2(x, y), 0).x;
        }
    }
    return found & counts;
}
