// Entry of the pass visibility.tiles (src/techniques/occlusion_textures/pixels.rs); at first skip tile.glsl.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// Lists the tiles whose pixels may meet an occluder. In the others all that the pixels' kernels touch is empty in every
// slice that counts for them. One invocation handles one tile.

#define TILES_A_GROUP 1u

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 3, std430) buffer Arguments { uint groups[4]; };
layout(set = 0, binding = 4, std430) buffer Tiles { uint count; uint tiles[]; };
layout(set = 0, binding = 5, r32f) writeonly uniform image2D visibility;
layout(set = 0, binding = 6) uniform texture2D placement;
layout(set = 0, binding = 7, std430) buffer Met { uint met[]; }; // slices, a bit each, tile by tile

#define GBUFFER
#include "common/light_space.glsl"
#define PIXELS
#include "occlusion_textures/slices.glsl"

// There is no limit here: each slice is tested against the tile's points.
float nearest_w()
{
    return 3.0e38;
}

vec2 place_of(vec3 position, float w)
{
    return centred(map_window(), position, w);
}

// The planes of a slice. The slice counts for none of a tile's points where they are all above it.
vec4 planes_of(int slice)
{
    return texelFetch(placement, ivec2(BINS + slice, 0), 0);
}

bool is_below(vec4 planes, Tile tile)
{
    return is_parallel() ? planes.x >= -tile.w.x : planes.x * tile.w.x >= 1.0;
}

// A rectangle that holds all kernels of a tile's points in which a slice is looked at. What lies near a point is looked
// for between it and the slice above its own; only slices that do not count in full for all of the points hold any.
vec4 kernel_in(MapWindow m, Tile tile, int slice, vec4 planes)
{
    vec4 kernel = tile_kernel(m, tile, planes.z, push.half_light);
    float furthest = is_parallel() ? -tile.w.x : 1.0 / tile.w.x;
    if (!looks_near() || 2.0 * planes.y - planes.x < furthest) {
        return kernel;
    }
    vec4 upper = tile_kernel(m, tile, planes_of(max(slice - 1, 0)).x, push.half_light);
    vec4 lower = tile_kernel(m, tile, furthest, push.half_light);
    return vec4(min(kernel.xy, min(upper.xy, lower.xy)), max(kernel.zw, max(upper.zw, lower.zw)));
}

// The slices in which a tile may meet an occluder, with a bit each.
#ifdef LEVELS
// Means from levels read windows larger than the kernels, and those beside them, so the squares of the mask are tested.
#include "common/nearest.glsl"

layout(set = 0, binding = 2) uniform utexture2D squares;

uint met_by(Tile tile)
{
    MapWindow m = map_window();
    vec4 all = vec4(3.0e38, 3.0e38, -3.0e38, -3.0e38);
    uint counts = 0u; // one bit for each slice that counts
    for (int slice = 0; slice < slices(); ++slice) {
        vec4 planes = planes_of(slice);
        if (is_below(planes, tile)) {
            break;
        }
        vec4 kernel = kernel_in(m, tile, slice, planes);
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
#else
// Summed-area tables are tested slice by slice.
layout(set = 0, binding = 2) uniform utexture2D filtered;

#define SUMMED
#include "occlusion_textures/tile.glsl"

uint met_by(Tile tile)
{
    uint found = 0u;
    MapWindow m = map_window();
    for (int slice = 0; slice < slices(); ++slice) {
        vec4 planes = planes_of(slice);
        if (is_below(planes, tile)) {
            break;
        }
        vec4 kernel = kernel_in(m, tile, slice, planes);
        ivec2 a = ivec2(clamp(floor(kernel.xy), 0.0, float(push.map)));
        ivec2 b = ivec2(clamp(ceil(kernel.zw), 0.0, float(push.map)));
        uvec3 sum = inside(sum_at(slice, a), sum_at(slice, ivec2(b.x, a.y)), sum_at(slice, ivec2(a.x, b.y)),
                           sum_at(slice, b));
        found |= uint(sum.x != 0u) << uint(slice);
    }
    return found;
}
#endif

uint met_here = 0u;

bool may_be_shadowed(Tile tile)
{
    met_here = met_by(tile);
    return met_here != 0u;
}

#include "visibility/classify.glsl"

void main()
{
    ivec2 tile = tile_of_invocation();
    classify_tile(tile);
    if (all(lessThan(tile * TILE, gbuffer.extent))) {
        met[tile.y * tiles_a_row(gbuffer.extent) + tile.x] = met_here;
    }
}
