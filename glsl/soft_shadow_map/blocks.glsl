// Entered from blocks.comp and blocks_serial.comp.
//
// The occluder map as both passes over its blocks read and write it.

#ifndef SOFT_SHADOW_MAP_BLOCKS_GLSL
#define SOFT_SHADOW_MAP_BLOCKS_GLSL

#include "soft_shadow_map/node.glsl"

layout(set = 0, binding = 0) uniform texture2D front_depth;
layout(set = 0, binding = 1) uniform texture2D back_depth;
layout(set = 0, binding = 2, std430) buffer Texels { uint texels[]; };
layout(set = 0, binding = 3, std430) buffer Blocks { uvec4 blocks[]; };
layout(set = 0, binding = 4, std430) buffer Nodes { uvec4 nodes[]; };

layout(push_constant) uniform Push {
    int map;        // the map's side in texels
    int row;        // blocks a row, a multiple of a superblock's
    float inv_near; // 1 over the near plane's distance, 1/m
    int sums;       // where the prefix sums begin in nodes
    int slopes;     // where the slopes begin in texels
    int faces;      // 0: both layers as they are; 1, 2: see below
} push;

// A front texel gets the back layer's distance where that has one.
const int BOTTOM = 1;
// A back texel is left out where its front is so flat that the back would only add noise.
const int MEAN = 2;

// The back layer is cleared to 1 and keeps the least value, so 1 is a texel without a back face.
const float NO_BACK = 1.0;

float w_at(ivec2 p, uint side)
{
    if (p.x >= push.map || p.y >= push.map) {
        return 0.0;
    }
    float front = texelFetch(front_depth, p, 0).x;
    float back = texelFetch(back_depth, p, 0).x;
    if (side == 0u && (push.faces != BOTTOM || front == 0.0 || back == NO_BACK)) {
        return front * push.inv_near;
    }
    return back == NO_BACK ? 0.0 : back * push.inv_near;
}

// Patches of a surface parallel to the light join without gap or overlap (Atty 2006, eq. 3), so there is
// nothing for a back face to cancel where the front is flatter than it by this factor; the gaps of a steep
// one, such as the side of a box under its top, would only add (mean error of the tall box, L = 0.4: 0.5 %,
// 4.3 % without). From 15 to 50 no scene's error differs; at 6 the bunny's grows by a seventh.
const float FLATTER = 30.0;
// The largest step that a raster's rounding gives the depth of a flat face.
const float ROUNDING = 1.0e-4;

// How w changes at a texel: along each axis by the lesser step to its two neighbours, so that an edge beyond which
// something else lies does not count.
vec2 slope_at(ivec2 p, uint side)
{
    float w = w_at(p, side);
    vec2 slope = vec2(0.0);
    for (int axis = 0; axis < 2; ++axis) {
        ivec2 step = ivec2(1 - axis, axis);
        float least = 3.0e38;
        for (int i = -1; i <= 1; i += 2) {
            ivec2 q = p + i * step;
            float other = q.x < 0 || q.y < 0 ? 0.0 : w_at(q, side);
            float change = float(i) * (other - w);
            least = other > 0.0 && abs(change) < abs(least) ? change : least;
        }
        slope[axis] = least < 3.0e38 ? least : 0.0;
    }
    return slope;
}

// The larger step of both axes.
float steepness(ivec2 p, uint side)
{
    vec2 slope = abs(slope_at(p, side));
    return max(slope.x, slope.y);
}

// The w of a texel's face as the gather takes it; 0 where there is none or it is left out.
float w_kept(ivec2 p, uint side)
{
    float w = w_at(p, side);
    bool flat_front = push.faces == MEAN && side == 1u && w > 0.0 &&
                      steepness(p, 1u) > FLATTER * steepness(p, 0u) + ROUNDING * w;
    return flat_front ? 0.0 : w;
}

// A storage buffer of more than 128 MB is not guaranteed. With both sides, patches of maps of more than 2880 texels are in
// part parallel to the light, and maps of more than 1408 texels have more blocks than there is room for their sums.
bool has_slopes(int block)
{
    return push.slopes + (block + 1) * BLOCK_TEXELS <= texels.length();
}

bool has_sums(int block)
{
    return push.sums + 2 * (block + 1) * BLOCK_TEXELS <= nodes.length();
}

#endif
