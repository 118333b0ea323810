// Entry of the passes soft_shadow_map.blend_back and soft_shadow_map.blend_front (src/techniques/soft_shadow_map/receiver_map.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "common/light_space.glsl"

// The fraction of the light that a micro-patch hides from one receiver texel (Atty 2006, section 3.4);
// blending adds the patches up.
//
// Thousands of equal patches added to one float round the same way each time, and their errors add up
// too: 2e-5 of the light at N = 256, growing with N^2. So each contribution is rounded here, up or
// down by a threshold that differs from patch to patch, to a multiple of 1/steps = 2^-24: sums of such
// numbers up to 1 are exact in 32 bits, whatever their order, and the thresholds even out over
// neighbouring patches.

layout(set = 0, binding = 1) uniform texture2D receiver_depth;

layout(push_constant) uniform Push {
    vec2 scale;
    vec2 t_step;
    vec2 t_first;
    float w_far;
    float receiver_inv_near;
    int receiver_map;
    float steps;
} push;

layout(location = 0) flat in vec2 texel;
layout(location = 1) flat in float w_o;
layout(location = 2) flat in float threshold;
layout(location = 0) out float occlusion;

void main()
{
    ivec2 p = ivec2(gl_FragCoord.xy);
    float stored = texelFetch(receiver_depth, p, 0).x;
    vec2 t = push.t_first + vec2(p) * push.t_step;
    float w_r = stored * push.receiver_inv_near;
    occlusion =
        stored > 0.0 ? patch_occlusion(texel, texel + 1.0, w_o, t, w_r, push.scale) : 0.0;
    if (push.steps > 0.0) {
        occlusion = floor(occlusion * push.steps + threshold) / push.steps;
    }
}
