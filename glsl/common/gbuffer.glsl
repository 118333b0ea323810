// Reads the G-buffer. The including shader declares `gbuffer_depth` and `gbuffer_mask`.

#ifndef COMMON_GBUFFER_GLSL
#define COMMON_GBUFFER_GLSL

#include "common/receiver.glsl"

struct GBuffer {
    mat4 light_from_ndc;
    ivec2 extent;
    float background; // the depth of a pixel that shows no surface
    bool masked;      // gbuffer_mask holds the receivers' roles
};

float depth_at(ivec2 p)
{
    return texelFetch(gbuffer_depth, p, 0).x;
}

// A depth for the arithmetic below: background and pixels outside the image are far off any plane.
float depth_or_far(GBuffer g, ivec2 p)
{
    bool outside = any(lessThan(p, ivec2(0))) || any(greaterThanEqual(p, g.extent));
    float depth = outside ? g.background : depth_at(p);
    return depth == g.background ? 1.0e30 : depth;
}

// The plane of the facet that a pixel shows. A plane's depth is linear over the image, so of the four
// quadrants around the pixel the one is taken whose depths bend least: along both axes and across.
vec3 facet_normal(GBuffer g, ivec2 p, float depth, vec3 position)
{
    // Neighbours along x and y, after and before; how much depth bends behind them.
    vec4 near;
    vec4 bend;
    for (int i = 0; i < 4; ++i) {
        ivec2 axis = (i < 2 ? ivec2(1, 0) : ivec2(0, 1)) * (1 - 2 * (i & 1));
        near[i] = depth_or_far(g, p + axis);
        bend[i] = abs(2.0 * near[i] - depth_or_far(g, p + 2 * axis) - depth);
    }
    ivec2 best = ivec2(0);
    float least = 3.0e38;
    for (int i = 0; i < 4; ++i) {
        ivec2 q = ivec2(i & 1, i >> 1);
        float corner = depth_or_far(g, p + 1 - 2 * q);
        float twist = abs(near[q.x] + near[2 + q.y] - corner - depth);
        float score = bend[q.x] + bend[2 + q.y] + twist;
        if (score < least) {
            least = score;
            best = q;
        }
    }
    ivec2 side = 1 - 2 * best;
    // Alone, a pixel's plane faces the viewer.
    float depth_x = near[best.x] > 1.0e29 ? depth : near[best.x];
    float depth_y = near[2 + best.y] > 1.0e29 ? depth : near[2 + best.y];
    vec2 extent = vec2(g.extent);
    vec2 pixel = vec2(p);
    vec3 x = dehomogenize(
        unproject(g.light_from_ndc, pixel + vec2(side.x, 0.0), extent, depth_x));
    vec3 y = dehomogenize(
        unproject(g.light_from_ndc, pixel + vec2(0.0, side.y), extent, depth_y));
    return plane_normal(x - position, y - position,
                        towards_viewer(g.light_from_ndc, position, g.background));
}

// What a pixel shows, but for the normal.
Receiver receiver_without_normal(GBuffer g, ivec2 p)
{
    Receiver r = Receiver(false, false, vec3(0.0), vec3(0.0));
    if (p.x >= g.extent.x || p.y >= g.extent.y) {
        return r;
    }
    float depth = depth_at(p);
    if (depth == g.background) {
        return r;
    }
    float role = g.masked ? texelFetch(gbuffer_mask, p, 0).x : 1.0;
    r.receives = role > 0.25;
    r.blocks = role > 0.75;
    r.position = dehomogenize(unproject(g.light_from_ndc, vec2(p), vec2(g.extent), depth));
    return r;
}

Receiver receiver_at(GBuffer g, ivec2 p)
{
    Receiver r = receiver_without_normal(g, p);
    r.normal = r.blocks ? facet_normal(g, p, depth_at(p), r.position) : TOWARDS_LIGHT;
    return r;
}

#endif
