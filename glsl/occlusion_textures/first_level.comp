// Entry of the pass occlusion_textures.first_level (src/techniques/occlusion_textures/prefilter.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "occlusion_textures/tile.glsl"
#include "occlusion_textures/levels.glsl"

// Writes the means of windows of 2 x 2 texels, from the mask. Each z is one tile.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform utexture2D mask;
layout(set = 0, binding = 1, rgba16f) writeonly uniform image2DArray levels;

layout(push_constant) uniform Push {
    int map;  // the map's side in texels
    int kind; // the kind of the levels' windows
    int correlated;
} push;

uvec4 bits_at(ivec2 p, int tile)
{
    // The mask is empty behind the map's end.
    bool outside = any(greaterThanEqual(p, ivec2(push.map)));
    uint texel = outside ? 0u : texelFetch(mask, p, 0).x;
    return tile_means(texel, tile, push.correlated != 0);
}

void main()
{
    ivec2 node = ivec2(gl_GlobalInvocationID.xy);
    int tile = int(gl_GlobalInvocationID.z);
    Levels l = Levels(push.map, push.kind);
    int side = side_of(l, 1);
    if (node.x >= side || node.y >= side) {
        return;
    }
    ivec2 p = node * (push.kind == MIP ? 2 : 1);
    uvec4 sum = bits_at(p, tile) + bits_at(p + ivec2(1, 0), tile) + bits_at(p + ivec2(0, 1), tile) +
                bits_at(p + ivec2(1, 1), tile);
    imageStore(levels, place_of_tile(l, tile, 1, node), 0.25 * vec4(sum));
}
