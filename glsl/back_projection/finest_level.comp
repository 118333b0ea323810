// Entry of the pass back_projection.finest_level (src/techniques/back_projection/mod.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "back_projection/levels.glsl"

// Writes the first level: the least and the largest w of 2x2 texels, 0 where there is no occluder.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform texture2D front_depth;
layout(set = 0, binding = 1, std430) buffer Levels { vec2 levels[]; };

layout(push_constant) uniform Push {
    int map;        // the map's side in texels
    float inv_near; // 1 over the near plane's distance, 1/m
} push;

void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    int side = level_side(push.map, 1);
    if (p.x >= side || p.y >= side) {
        return;
    }
    vec2 range = vec2(3.0e38, 0.0);
    for (int i = 0; i < 4; ++i) {
        ivec2 texel = min(2 * p + ivec2(i & 1, i >> 1), ivec2(push.map - 1));
        float w = texelFetch(front_depth, texel, 0).x * push.inv_near;
        range = vec2(min(range.x, w), max(range.y, w));
    }
    levels[p.y * side + p.x] = range;
}
