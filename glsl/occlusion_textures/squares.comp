// Entry of the pass occlusion_textures.squares (src/techniques/occlusion_textures/pixels.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "common/nearest.glsl"

// Writes for each square of the mask the slices that block in any of its texels. One invocation handles one square.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform utexture2D mask;
layout(set = 0, binding = 1, r32ui) writeonly uniform uimage2D squares;

layout(push_constant) uniform Push {
    int map; // the map's side in texels
} push;

void main()
{
    ivec2 square = ivec2(gl_GlobalInvocationID.xy);
    int row = nodes_a_row(push.map);
    if (square.x >= row || square.y >= row) {
        return;
    }
    int side = node_side(push.map);
    ivec2 first = square * side;
    ivec2 end = min(first + side, ivec2(push.map));
    uint blocking = 0u;
    for (int y = first.y; y < end.y; ++y) {
        for (int x = first.x; x < end.x; ++x) {
            blocking |= texelFetch(mask, ivec2(x, y), 0).x;
        }
    }
    imageStore(squares, square, uvec4(blocking));
}
