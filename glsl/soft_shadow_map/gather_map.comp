#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "common/light.glsl"
#include "soft_shadow_map/node.glsl"

// The soft shadow map by gathering: what all occluder-map texels hide of the light from 4x4 texels of
// the receiver map. One invocation a 4x4 tile. Same sum as blending every micro-patch (Atty 2006,
// section 3.4), in an order that is fixed and with the far texels summed by superblock and block.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform texture2D receiver_depth;
layout(set = 0, binding = 1, std430) readonly buffer Texels { float texels[]; };
layout(set = 0, binding = 2, std430) readonly buffer Blocks { vec4 blocks[]; };
layout(set = 0, binding = 3, std430) readonly buffer Superblocks { vec4 superblocks[]; };
layout(set = 0, binding = 4, r32f) writeonly uniform image2D soft_shadow_map;

layout(push_constant) uniform Push {
    vec2 scale;              // (du/Lx, dv/Ly), 1/m
    vec2 t_step;             // occluder texels a receiver texel
    vec2 t_first;            // t of the centre of receiver texel (0, 0)
    float w_max;             // no occluder is nearer than 1/w_max
    float spread;            // the series' limit, see classify
    float receiver_inv_near; // 1 over the receiver map's near plane, 1/m
    int receiver_map;        // its side in texels
    int row;                 // superblocks a row
    int side;                // 0 front, 1 back
} push;

const int TILE = 4;

// The occlusion of one occluder texel at four receivers in a row.
vec4 texel_occlusion(vec2 lo, float w_o, vec4 t_x, float t_y, vec4 w_r)
{
    // Receivers in front of the texel, and those that are not there, get a magnification of 0.
    vec4 k = mix(vec4(0.0), 1.0 / (w_o - w_r), greaterThan(vec4(w_o), w_r));
    vec4 m_x = push.scale.x * k;
    vec4 m_y = push.scale.y * k;
    vec4 x = clamp((lo.x + 1.0 - t_x) * m_x, -0.5, 0.5) - clamp((lo.x - t_x) * m_x, -0.5, 0.5);
    vec4 y = clamp((lo.y + 1.0 - t_y) * m_y, -0.5, 0.5) - clamp((lo.y - t_y) * m_y, -0.5, 0.5);
    return x * y;
}

vec4 row_sum(Node node, vec4 w_r)
{
    vec4 r = 1.0 / (node.mean - w_r);
    return r * r * (node.count + r * r * (3.0 * node.s2 - 4.0 * node.s3 * r));
}

// A receiver texel that holds nothing: further than any occluder can be in front of.
const float NOTHING = 3.0e38;

vec4 receivers_at(ivec2 p)
{
    vec4 w;
    for (int i = 0; i < TILE; ++i) {
        ivec2 q = p + ivec2(i, 0);
        bool there = q.x < push.receiver_map && q.y < push.receiver_map;
        float stored = there ? texelFetch(receiver_depth, q, 0).x : 0.0;
        w[i] = stored > 0.0 ? stored * push.receiver_inv_near : NOTHING;
    }
    return w;
}

float least(vec4 a)
{
    return min(min(a.x, a.y), min(a.z, a.w));
}

float most(vec4 a)
{
    vec4 b = mix(a, vec4(0.0), equal(a, vec4(NOTHING)));
    return max(max(b.x, b.y), max(b.z, b.w));
}

void store_row(ivec2 p, vec4 v)
{
    for (int i = 0; i < TILE; ++i) {
        ivec2 q = p + ivec2(i, 0);
        if (q.x < push.receiver_map && q.y < push.receiver_map) {
            imageStore(soft_shadow_map, q, vec4(v[i]));
        }
    }
}

void main()
{
    ivec2 tile = ivec2(gl_GlobalInvocationID.xy) * TILE;
    if (tile.x >= push.receiver_map || tile.y >= push.receiver_map) {
        return;
    }
    vec4 w0 = receivers_at(tile);
    vec4 w1 = receivers_at(tile + ivec2(0, 1));
    vec4 w2 = receivers_at(tile + ivec2(0, 2));
    vec4 w3 = receivers_at(tile + ivec2(0, 3));
    vec2 w_r = vec2(min(min(least(w0), least(w1)), min(least(w2), least(w3))),
                    max(max(most(w0), most(w1)), max(most(w2), most(w3))));
    vec4 a0 = vec4(0.0);
    vec4 a1 = vec4(0.0);
    vec4 a2 = vec4(0.0);
    vec4 a3 = vec4(0.0);

    if (w_r.x < push.w_max) {
        vec2 t_min = push.t_first + vec2(tile) * push.t_step;
        vec2 t_max = t_min + float(TILE - 1) * push.t_step;
        vec4 t_x = t_min.x + vec4(0.0, 1.0, 2.0, 3.0) * push.t_step.x;
        float cell = push.scale.x * push.scale.y;
        // The widest window of occluder texels that any occluder could be felt from.
        vec2 window = 0.5 * (push.w_max - w_r.x) / push.scale;
        float last = float(push.row - 1);
        ivec2 from = ivec2(clamp(floor((t_min - window) / float(SUPERBLOCK)), 0.0, last));
        ivec2 to = ivec2(clamp(floor((t_max + window) / float(SUPERBLOCK)), 0.0, last));
        for (int sy = from.y; sy <= to.y; ++sy) {
            for (int sx = from.x; sx <= to.x; ++sx) {
                int s = (push.side * push.row + sy) * push.row + sx;
                Node node = unpack_node(superblocks[2 * s], superblocks[2 * s + 1]);
                int kind = classify(node, vec2(sx, sy) * float(SUPERBLOCK), float(SUPERBLOCK),
                                    t_min, t_max, w_r, push.scale, push.spread);
                if (kind == INSIDE) {
                    a0 += cell * row_sum(node, w0);
                    a1 += cell * row_sum(node, w1);
                    a2 += cell * row_sum(node, w2);
                    a3 += cell * row_sum(node, w3);
                }
                if (kind != MIXED) {
                    continue;
                }
                for (int i = 0; i < FAN * FAN; ++i) {
                    ivec2 block = ivec2(sx, sy) * FAN + ivec2(i % FAN, i / FAN);
                    int b = (push.side * push.row * FAN + block.y) * push.row * FAN + block.x;
                    vec2 lo = vec2(block) * float(BLOCK);
                    node = unpack_node(blocks[2 * b], blocks[2 * b + 1]);
                    kind = classify(node, lo, float(BLOCK), t_min, t_max, w_r, push.scale,
                                    push.spread);
                    if (kind == INSIDE) {
                        a0 += cell * row_sum(node, w0);
                        a1 += cell * row_sum(node, w1);
                        a2 += cell * row_sum(node, w2);
                        a3 += cell * row_sum(node, w3);
                    }
                    if (kind != MIXED) {
                        continue;
                    }
                    // A block's own sum first: adding few large numbers keeps the low digits.
                    vec4 b0 = vec4(0.0);
                    vec4 b1 = vec4(0.0);
                    vec4 b2 = vec4(0.0);
                    vec4 b3 = vec4(0.0);
                    for (int n = 0; n < BLOCK_TEXELS; ++n) {
                        float w_o = texels[b * BLOCK_TEXELS + n];
                        if (w_o <= w_r.x) {
                            continue;
                        }
                        vec2 at = lo + vec2(n % BLOCK, n / BLOCK);
                        b0 += texel_occlusion(at, w_o, t_x, t_min.y, w0);
                        b1 += texel_occlusion(at, w_o, t_x, t_min.y + push.t_step.y, w1);
                        b2 += texel_occlusion(at, w_o, t_x, t_min.y + 2.0 * push.t_step.y, w2);
                        b3 += texel_occlusion(at, w_o, t_x, t_max.y, w3);
                    }
                    a0 += b0;
                    a1 += b1;
                    a2 += b2;
                    a3 += b3;
                }
            }
        }
    }
    store_row(tile, a0);
    store_row(tile + ivec2(0, 1), a1);
    store_row(tile + ivec2(0, 2), a2);
    store_row(tile + ivec2(0, 3), a3);
}
