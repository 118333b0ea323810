#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "soft_shadow_map/node.glsl"

// Which tiles of pixels feel no occluder: no node within the light's window, as they see it, lies before any of
// their receivers. One invocation a tile.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform texture2D gbuffer_depth;
layout(set = 0, binding = 1) uniform texture2D gbuffer_mask;
layout(set = 0, binding = 2, std430) readonly buffer Nodes { uvec4 nodes[]; };
layout(set = 0, binding = 3, std430) buffer Arguments { uint groups[4]; };
layout(set = 0, binding = 4, std430) buffer Tiles { uint count; uint tiles[]; };
layout(set = 0, binding = 5, r32f) writeonly uniform image2D visibility;

#include "common/gbuffer.glsl"
#include "soft_shadow_map/pixels.glsl"
#include "soft_shadow_map/felt.glsl"

float nearest_w()
{
    return push.w_max;
}

bool is_felt_in(Tile tile)
{
    int sides = 1 + ((push.flags >> 1) & 1);
    return is_felt_by(tile, push.row, sides, push.w_max, push.scale);
}

#include "visibility/classify.glsl"

void main()
{
    classify_tile(ivec2(gl_GlobalInvocationID.xy));
}
