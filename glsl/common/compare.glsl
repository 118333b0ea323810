// Entered from one_map.glsl, many_lights/add_point.comp and linear_light/visibility.comp.
//
// A receiver's plane over an occluder map, and the test which of the map's texels lie in front of it.

#ifndef COMMON_COMPARE_GLSL
#define COMMON_COMPARE_GLSL

#include "common/light_space.glsl"

struct MapPlane {
    vec2 t;        // the receiver's place, in texels
    float w;
    vec2 n;        // the plane's normal over the texels a unit of u and v, see light_space.glsl
    float n_0;
    float c;       // above 0 where the map's eye is below the plane
    float rounding;
    vec2 texel;    // a texel's size in u and v
    float slope;   // how steeply the receiver's own surface may rise above its plane
};

// The plane dot(normal, uv) + n_0 - c w = 0 through a receiver at `uv` and `w`.
MapPlane map_plane_at(vec2 uv, float w, vec2 normal, float n_0, float c, bool blocks, vec2 texels_per_uv, vec2 first,
                      float snap, float depth_error)
{
    vec2 t = uv * texels_per_uv + first;
    vec2 n = normal / texels_per_uv;
    n_0 -= dot(n, first);
    float rounding = plane_rounding(n, n_0, c, t, w, snap, depth_error);
    return MapPlane(t, w, n, n_0, c, rounding, 1.0 / texels_per_uv, own_slope(blocks));
}

// `position` and `normal` are in light space with the map's eye as the origin.
MapPlane map_plane(vec3 position, vec3 normal, bool blocks, vec2 texels_per_uv, vec2 first,
                   float snap, float depth_error)
{
    float w = 1.0 / position.z;
    return map_plane_at(position.xy * w, w, normal.xy, normal.z, dot(normal, position), blocks, texels_per_uv, first,
                        snap, depth_error);
}

// How far a texel's surface, w_o at its centre `at`, lies above the receiver's plane beyond the height that the
// receiver's own surface may rise over a distance of `reach` in u and v. That distance is at least half the texel's
// diagonal, because the surface's place within the texel is not known.
float clearance(MapPlane m, vec2 at, float w_o, float reach)
{
    float above = dot(at, m.n) + m.n_0 - m.c * w_o;
    return above - m.slope * max(0.5 * length(m.texel), reach);
}

// Whether a texel's surface hides what lies behind the texel itself: the receiver-plane depth bias.
bool in_front(MapPlane m, vec2 at, float w_o)
{
    return w_o > m.w && clearance(m, at, w_o, 0.0) > m.rounding;
}

// Whether a texel's surface hides a receiver for a filter around it. The texel stands for the receiver's whole
// neighbourhood, so the receiver's own surface may rise over the distance between the two and still not count.
bool in_front_of_filter(MapPlane m, vec2 at, float w_o)
{
    return w_o > m.w && clearance(m, at, w_o, length((at - m.t) * m.texel)) > m.rounding;
}

#endif
