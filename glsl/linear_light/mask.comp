// Entry of the pass linear_light.mask (src/techniques/linear_light/samples.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "linear_light/mask.glsl"

// Estimates which parts of a line are visible from a grid of receivers in the map of the line's middle: each occluder
// in a receiver's row of texels is projected back onto the line and hides that part. Occluders behind others are
// missed, which is good enough to place samples by.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform texture2DArray seen; // layer 0: the middle's map
layout(set = 0, binding = 1, std430) buffer Masks { uint masks[]; };

layout(push_constant) uniform Push {
    vec4 u_window; // least and largest u at the line's first end, at its last
    float line;    // its length, m
    int map;       // the maps' side in texels
} push;

void main()
{
    ivec2 cell = ivec2(gl_GlobalInvocationID.xy);
    // A receiver in the middle of each cell; small maps have fewer texels than cells.
    ivec2 p = min((2 * cell + 1) * push.map / (2 * RECEIVERS), ivec2(push.map - 1));
    vec2 window = 0.5 * (push.u_window.xy + push.u_window.zw);
    float step = (window.y - window.x) / float(push.map);
    float w = texelFetch(seen, ivec3(p, 0), 0).y;
    uint mask = ALL;
    if (w > 0.0) {
        float u = window.x + (float(p.x) + 0.5) * step;
        for (int x = 0; x < push.map; ++x) {
            float occluder = texelFetch(seen, ivec3(x, p.y, 0), 0).x;
            // The receiver's own texel is left out: it is projected to where its plane meets the light's.
            if (occluder > w && x != p.x) {
                float scale = 1.0 / max((occluder - w) * push.line, 1.0e-30);
                float a = (window.x + float(x) * step - u) * scale;
                mask &= ~between(0.5 + a, 0.5 + a + step * scale);
            }
        }
    }
    masks[cell.y * RECEIVERS.x + cell.x] = mask;
}
