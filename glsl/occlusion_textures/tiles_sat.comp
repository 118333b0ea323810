#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// Which tiles of pixels meet nothing, by summed-area tables.

#include "occlusion_textures/tile.glsl"
#include "occlusion_textures/tiles.glsl"

layout(set = 0, binding = 2) uniform utexture2D filtered;

#include "occlusion_textures/sat.glsl"

uint met_by(Tile tile)
{
    uint found = 0u;
    MapWindow m = map_window();
    for (int slice = 0; slice < slices(); ++slice) {
        vec4 planes = planes_of(slice);
        if (is_below(planes, tile)) {
            break;
        }
        vec4 kernel = tile_kernel(m, tile, planes.z, push.half_light);
        ivec2 a = ivec2(clamp(floor(kernel.xy), 0.0, float(push.map)));
        ivec2 b = ivec2(clamp(ceil(kernel.zw), 0.0, float(push.map)));
        uvec3 sum = inside(sum_at(slice, a), sum_at(slice, ivec2(b.x, a.y)), sum_at(slice, ivec2(a.x, b.y)),
                           sum_at(slice, b));
        found |= uint(sum.x != 0u) << uint(slice);
    }
    return found;
}
