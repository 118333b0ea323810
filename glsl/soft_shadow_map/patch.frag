#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "common/light.glsl"

// The fraction of the light that a micro-patch hides from one receiver texel (Atty 2006, section 3.4);
// blending adds the patches up.

layout(set = 0, binding = 1) uniform texture2D receiver_depth;

layout(push_constant) uniform Push {
    vec2 scale;
    vec2 t_step;
    vec2 t_first;
    float w_far;
    float receiver_inv_near;
    int receiver_map;
} push;

layout(location = 0) flat in vec2 texel;
layout(location = 1) flat in float w_o;
layout(location = 0) out float occlusion;

void main()
{
    ivec2 p = ivec2(gl_FragCoord.xy);
    float stored = texelFetch(receiver_depth, p, 0).x;
    vec2 t = push.t_first + vec2(p) * push.t_step;
    float w_r = stored * push.receiver_inv_near;
    occlusion =
        stored > 0.0 ? patch_occlusion(texel, texel + 1.0, w_o, t, w_r, push.scale) : 0.0;
}
