// Entry of the pass many_lights.average (src/techniques/many_lights/mod.rs).
#version 450
#extension GL_EXT_samplerless_texture_functions : require

// Writes the share of the light's points that each pixel sees.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform texture2D hidden_points;
layout(set = 0, binding = 1, r32f) writeonly uniform image2D visibility;

layout(set = 0, binding = 2) uniform texture2D positions;

layout(push_constant) uniform Push {
    ivec2 extent; // the G-buffer's width and height
    float points;
} push;

void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    bool inside = p.x < push.extent.x && p.y < push.extent.y;
    // Another view's pixels are its own.
    if (inside && texelFetch(positions, p, 0).w >= 0.0) {
        imageStore(visibility, p, vec4(1.0 - texelFetch(hidden_points, p, 0).x / push.points));
    }
}
