// Entry of the passes soft_shadow_map.gather_back and soft_shadow_map.gather_front (src/techniques/soft_shadow_map/receiver_map.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// The soft shadow map by gathering: the occlusion of the receiver map's texels by all texels of the occluder map. One
// invocation handles 2x2 texels. The sum is that of blending every micro-patch (Atty 2006, section 3.4), in a fixed
// order and with far texels summed by node.

layout(local_size_x = 64) in;

layout(set = 0, binding = 0) uniform texture2D receiver_depth;
layout(set = 0, binding = 1, std430) readonly buffer Texels { uint texels[]; };
layout(set = 0, binding = 2, std430) readonly buffer Nodes { uvec4 nodes[]; };
layout(set = 0, binding = 3, r32f) writeonly uniform image2D soft_shadow_map;

layout(push_constant) uniform Push {
    vec2 scale;              // (du/Lx, dv/Ly), 1/m
    vec2 t_step;             // occluder texels a receiver texel
    vec2 t_first;            // t at the centre of receiver texel (0, 0)
    float w_max;             // no occluder is nearer than 1/w_max
    float spread;            // the series' limit, see classify
    float receiver_inv_near; // 1 over the receiver map's near plane, 1/m
    int receiver_map;        // the receiver map's side in texels
    int row;                 // superblocks a row
    int sums;                // where the prefix sums begin in nodes
    int side;                // 0 front, 1 back, 2 back or front, as in gather.glsl
} push;

struct Receivers {
    vec4 t_x;
    vec4 t_y;
    vec4 w;
};

#include "soft_shadow_map/node.glsl"

// Receivers are no occluders here, so every texel in front counts.
bvec4 is_above(vec2 lo, vec4 w_o, Receivers r)
{
    return bvec4(true);
}

int plane_side(Node node, vec2 lo, float side, Receivers r)
{
    return 1;
}

#include "soft_shadow_map/gather.glsl"

void main()
{
    // Invocations that run in step have a square of texels rather than a row of them, so that they open the same nodes.
    uint l = gl_LocalInvocationIndex;
    uvec2 within = uvec2((l & 1u) | ((l >> 1) & 2u) | ((l >> 2) & 4u),
                         ((l >> 1) & 1u) | ((l >> 2) & 2u) | ((l >> 3) & 4u));
    ivec2 quad = ivec2(gl_WorkGroupID.xy * 8u + within) * 2;
    if (quad.x >= push.receiver_map || quad.y >= push.receiver_map) {
        return;
    }
    Receivers r;
    for (int i = 0; i < 4; ++i) {
        ivec2 p = quad + ivec2(i & 1, i >> 1);
        bool there = p.x < push.receiver_map && p.y < push.receiver_map;
        float stored = there ? texelFetch(receiver_depth, p, 0).x : 0.0;
        vec2 t = push.t_first + vec2(p) * push.t_step;
        r.t_x[i] = t.x;
        r.t_y[i] = t.y;
        r.w[i] = stored > 0.0 ? stored * push.receiver_inv_near : NOTHING;
    }
    Map map = Map(push.scale, push.w_max, push.spread, push.row, push.sums, 0);
    vec4 occlusion = gather(map, push.side, r);
    for (int i = 0; i < 4; ++i) {
        ivec2 p = quad + ivec2(i & 1, i >> 1);
        if (p.x < push.receiver_map && p.y < push.receiver_map) {
            imageStore(soft_shadow_map, p, vec4(occlusion[i]));
        }
    }
}
