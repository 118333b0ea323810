// Entry of the pass many_lights.receivers (src/techniques/many_lights/mod.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// Writes the G-buffer in light space, once for all points of the light, and clears the counts of hidden points.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 2, rgba32f) writeonly uniform image2D positions;
layout(set = 0, binding = 3, rgba32f) writeonly uniform image2D normals;
layout(set = 0, binding = 4, r32f) writeonly uniform image2D hidden_points;

#define GBUFFER
#include "common/light_space.glsl"

void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    if (p.x >= gbuffer.extent.x || p.y >= gbuffer.extent.y) {
        return;
    }
    Receiver r = receiver_at(p);
    // -1: another view serves it; 0: nothing to hide; 1: receives only; 2: its own surface blocks.
    float kind = r.receives && is_before_light(r.position) ? (r.blocks ? 2.0 : 1.0) : 0.0;
    kind = is_served(r.position) ? kind : -1.0;
    imageStore(positions, p, vec4(r.position, kind));
    imageStore(normals, p, vec4(r.normal, 0.0));
    imageStore(hidden_points, p, vec4(0.0));
}
