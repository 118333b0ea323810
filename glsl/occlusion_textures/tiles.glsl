// Which tiles of pixels meet nothing: what their pixels' kernels touch is empty in every slice that counts for any
// of them. One invocation a tile.

#ifndef OCCLUSION_TEXTURES_TILES_GLSL
#define OCCLUSION_TEXTURES_TILES_GLSL

#define TILES_A_GROUP 1u
#include "occlusion_textures/tile_kernel.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform texture2D gbuffer_depth;
layout(set = 0, binding = 1) uniform texture2D gbuffer_mask;
layout(set = 0, binding = 3, std430) buffer Arguments { uint groups[4]; };
layout(set = 0, binding = 4, std430) buffer Tiles { uint count; uint tiles[]; };
layout(set = 0, binding = 5, r32f) writeonly uniform image2D visibility;
layout(set = 0, binding = 6) uniform texture2D placement;
layout(set = 0, binding = 7, std430) buffer Met { uint met[]; }; // slices, a bit each, tile by tile

#include "common/gbuffer.glsl"
#include "occlusion_textures/placement.glsl"
#include "occlusion_textures/push.glsl"

// No limit: which slices a point is behind is asked slice by slice.
float nearest_w()
{
    return 3.0e38;
}

vec2 place_of(vec3 position, float w)
{
    return centred(map_window(), position, w);
}

// The planes of a slice; it counts for none of a tile's points where they are all above it.
vec4 planes_of(int slice)
{
    return texelFetch(placement, ivec2(BINS + slice, 0), 0);
}

bool is_below(vec4 planes, Tile tile)
{
    return planes.x * tile.w.x >= 1.0;
}

// Slices that something in a tile may meet, with a bit each.
uint met_by(Tile tile);

uint met_here = 0u;

bool is_felt_in(Tile tile)
{
    met_here = met_by(tile);
    return met_here != 0u;
}

#include "visibility/classify.glsl"

void main()
{
    ivec2 tile = ivec2(gl_GlobalInvocationID.xy);
    classify_tile(tile);
    if (all(lessThan(tile * TILE, push.extent))) {
        met[tile.y * tiles_a_row(push.extent) + tile.x] = met_here;
    }
}

#endif
