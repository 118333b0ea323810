// Entry of the passes soft_shadow_map.blend_back and soft_shadow_map.blend_front (src/techniques/soft_shadow_map/receiver_map.rs).
#version 450

// A micro-patch to its penumbra rectangle on the receiver map (Atty 2006, section 3.3), by pulling the
// patch from a buffer: six vertices a patch, no instancing.

layout(set = 0, binding = 0, std430) readonly buffer Patches { uvec2 patches[]; };

layout(push_constant) uniform Push {
    vec2 scale;              // (du/Lx, dv/Ly), 1/m
    vec2 t_step;             // occluder texels a receiver texel
    vec2 t_first;            // t of the centre of receiver texel (0, 0)
    float w_far;             // no receiver is further than 1/w_far
    float receiver_inv_near; // 1 over the receiver map's near plane, 1/m
    int receiver_map;        // its side in texels
    float steps;             // steps a unit that contributions are rounded to; 0 rounds none
} push;

layout(location = 0) flat out vec2 texel;
layout(location = 1) flat out float w_o;
layout(location = 2) flat out float threshold;

// Rasters drop fragments whose centre lies on a rectangle's edge within their own rounding; this much
// more, in receiver texels, keeps them (error 9e-6 against 1.6e-4 without).
const float MARGIN = 1.0 / 16.0;

void main()
{
    uvec2 p = patches[gl_VertexIndex / 6];
    texel = vec2(p.x & 0xffffu, p.x >> 16);
    w_o = uintBitsToFloat(p.y);
    // A plane-filling sequence (R2: powers of the plastic number's inverse, times 2^32): neighbours
    // round up and down in turn. The top 16 bits are enough.
    uint spread = (p.x & 0xffffu) * 3242174889u + (p.x >> 16) * 2447445414u;
    threshold = float(spread >> 16) / 65536.0;

    // The patch hides light up to half the light's size, as seen through the patch from the furthest
    // receiver there is.
    vec2 reach = 0.5 * max(w_o - push.w_far, 0.0) / push.scale;
    vec2 lo = (texel - reach - push.t_first) / push.t_step + 0.5 - MARGIN;
    vec2 hi = (texel + 1.0 + reach - push.t_first) / push.t_step + 0.5 + MARGIN;

    int corner = gl_VertexIndex % 6;
    bool right = corner == 1 || corner == 2 || corner == 4;
    bool lower = corner == 2 || corner == 4 || corner == 5;
    vec2 at = vec2(right ? hi.x : lo.x, lower ? hi.y : lo.y);
    gl_Position = vec4(2.0 * at / float(push.receiver_map) - 1.0, 0.0, 1.0);
}
