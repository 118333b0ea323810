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

struct Receiver {
    bool receives;
    bool blocks;   // its own surface blocks light
    vec3 position; // light space, metres
    vec3 normal;   // of the geometric plane, on the viewer's side
};

float depth_at(ivec2 p)
{
    return texelFetch(gbuffer_depth, p, 0).x;
}

// The step along one axis to the neighbour that more likely lies on the same surface: the one whose
// depth differs less.
vec3 step_along(GBuffer g, ivec2 p, ivec2 axis, float depth, vec3 position)
{
    ivec2 after = min(p + axis, g.extent - 1);
    ivec2 before = max(p - axis, ivec2(0));
    float depth_after = depth_at(after);
    float depth_before = depth_at(before);
    bool use_after = after != p && depth_after != g.background;
    bool use_before = before != p && depth_before != g.background;
    if (use_after && use_before) {
        use_before = abs(depth_before - depth) < abs(depth_after - depth);
        use_after = !use_before;
    }
    if (use_after) {
        vec4 q = unproject(g.light_from_ndc, vec2(after), vec2(g.extent), depth_after);
        return dehomogenize(q) - position;
    }
    if (use_before) {
        vec4 q = unproject(g.light_from_ndc, vec2(before), vec2(g.extent), depth_before);
        return position - dehomogenize(q);
    }
    // Alone: a plane that faces the viewer.
    vec4 q = unproject(g.light_from_ndc, vec2(p + axis), vec2(g.extent), depth);
    return dehomogenize(q) - position;
}

Receiver receiver_at(GBuffer g, ivec2 p)
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
    if (r.receives) {
        vec3 x = step_along(g, p, ivec2(1, 0), depth, r.position);
        vec3 y = step_along(g, p, ivec2(0, 1), depth, r.position);
        r.normal = plane_normal(x, y, towards_viewer(g.light_from_ndc, r.position, g.background));
    }
    return r;
}

#endif
