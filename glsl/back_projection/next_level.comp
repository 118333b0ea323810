// Entry of the pass back_projection.next_level (src/techniques/back_projection/mod.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "back_projection/levels.glsl"

// Writes a level from the level before it.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0, std430) buffer Levels { vec2 levels[]; };

layout(push_constant) uniform Push {
    int map;   // the map's side in texels
    int level; // the level to make
} push;

void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    int side = level_side(push.map, push.level);
    if (p.x >= side || p.y >= side) {
        return;
    }
    int finer = level_side(push.map, push.level - 1);
    int from = level_start(push.map, push.level - 1);
    vec2 range = vec2(3.0e38, 0.0);
    for (int i = 0; i < 4; ++i) {
        ivec2 q = min(2 * p + ivec2(i & 1, i >> 1), ivec2(finer - 1));
        vec2 r = levels[from + q.y * finer + q.x];
        range = vec2(min(range.x, r.x), max(range.y, r.y));
    }
    levels[from + finer * finer + p.y * side + p.x] = range;
}
