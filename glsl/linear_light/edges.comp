#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "linear_light/skin.glsl"

// Where occluders end in a sample's map, on the side of its neighbour, to skins. Their order differs from frame to
// frame; what is drawn of them does not.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform texture2D occluders_0;
layout(set = 0, binding = 1) uniform texture2D receivers_0;
layout(set = 0, binding = 2) uniform texture2D occluders_1;
layout(set = 0, binding = 3) uniform texture2D receivers_1;
layout(set = 0, binding = 4, std430) buffer Skins { vec4 skins[]; };
layout(set = 0, binding = 5, std430) buffer Draw { uint draw[4]; };

#include "linear_light/slots.glsl"

layout(push_constant) uniform Push {
    float u_first;  // tangent of the map's first texel border
    float u_step;   // of a texel
    float inv_near; // 1 over the map's near plane, 1/m
    int map;        // its side in texels
    int slot;       // where it is
    int side;       // -1: occluders that end towards -x; 1: towards +x
} push;

float w_at(int x, int y)
{
    bool outside = x < 0 || x >= push.map;
    return outside ? 0.0 : surface_at(push.slot, ivec2(x, y)) * push.inv_near;
}

void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    if (p.x >= push.map || p.y >= push.map) {
        return;
    }
    float w_near = occluder_at(push.slot, p) * push.inv_near;
    float w_seen = w_at(p.x + push.side, p.y);
    // A receiver that lies in front of the occluder ends nothing.
    if (w_near <= w_seen || w_near < w_at(p.x, p.y)) {
        return;
    }
    if (is_edge(w_at(p.x - push.side, p.y), w_near, w_seen, w_at(p.x + 2 * push.side, p.y))) {
        float border = float(p.x) + (push.side > 0 ? 1.0 : 0.0);
        uint vertex = atomicAdd(draw[0], 6u);
        skins[vertex / 6u] = vec4(push.u_first + border * push.u_step, w_near, w_seen, float(p.y));
    }
}
