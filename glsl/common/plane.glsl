// Above or below a receiver's own plane, and what that may be off by.
//
// The plane {p : dot(n, p) = c} of light space is linear in (u, v, w): a point of a light-space map with
// its centre at (x, y) texels and at w lies n.x x + n.y y + n_0 - c w above it, in units of 1/w, with
// n.xy over the texels a unit of u and v.

#ifndef COMMON_PLANE_GLSL
#define COMMON_PLANE_GLSL

// The pixel's own surface, bent by up to 17 degrees from facet to facet, rises above the pixel's plane by
// at most this share (sin 17 degrees) of the distance within the map. (Mean error of the soft shadow map
// on the bunny for 0, 0.2, 0.3, 0.5, 1: 4.0, 2.9, 2.9, 3.0, 3.2 %; on the bunny's lit pixels 6.4, 0.6,
// 0.4, 0.3, 0.2 %.)
const float OWN_SLOPE = 0.3;

// What does not block is not in the maps, and has nothing of its own to rise.
float own_slope(bool blocks)
{
    return blocks ? OWN_SLOPE : 0.0;
}

// Rounding of (u, v, w), of the sum that tells above from below, and of the G-buffer's position.
const float ROUNDING = 1.0 / 2097152.0;

// How far off the height may be by arithmetic: `snap` is how far the raster moves a vertex, in texels,
// `depth_error` how far off an occluder's w may be beyond its rounding, 1/m; the receiver is at t and w.
float plane_rounding(vec2 n, float n_0, float c, vec2 t, float w, float snap, float depth_error)
{
    return snap * (abs(n.x) + abs(n.y)) + depth_error * abs(c) +
           ROUNDING * (dot(abs(n), abs(t)) + abs(n_0) + abs(c) * w);
}

#endif
