// Light space and back-projection.
//
// A point of light space at distance d is kept as (u, v, w) = (x/d, y/d, 1/d). A texel of a light-space
// map covers one step of u and v. t is (u, v) in occluder-map texels: texel (i, j) covers
// [i, i+1] x [j, j+1]. `scale` is the texel's size over the light's: (du/Lx, dv/Ly), in 1/m.

#ifndef COMMON_LIGHT_GLSL
#define COMMON_LIGHT_GLSL

// The magnification k = 1/(w_o - w_r), in metres: what a step of u at the occluder covers on the
// light's plane, seen from a receiver at w_r. The caller sees to w_o > w_r.
float magnification(float w_o, float w_r)
{
    return 1.0 / (w_o - w_r);
}

// The length of the part of [a, b] that lies within the light, which is [-1/2, 1/2] (Atty 2006,
// section 4.2, with the light centred).
float overlap(float a, float b)
{
    return clamp(b, -0.5, 0.5) - clamp(a, -0.5, 0.5);
}

// The fraction of the light that a micro-patch hides: the occluder-map texels from `lo` to `hi` at
// w_o, back-projected from the receiver at t and w_r. 0 where the patch is not in front.
float patch_occlusion(vec2 lo, vec2 hi, float w_o, vec2 t, float w_r, vec2 scale)
{
    if (w_o <= w_r) {
        return 0.0;
    }
    vec2 m = scale * magnification(w_o, w_r);
    vec2 a = (lo - t) * m;
    vec2 b = (hi - t) * m;
    return overlap(a.x, b.x) * overlap(a.y, b.y);
}

// The fraction of the light above the plane {p : dot(n, p) = c} of light space: `slope` is (n.x, n.y)
// times the light's half-extents. The fraction of the unit square [-1, 1]^2 where
// slope.x p + slope.y q > c, as three pieces that are each well conditioned.
float fraction_above(vec2 slope, float c)
{
    float m = max(abs(slope.x), abs(slope.y));
    float l = min(abs(slope.x), abs(slope.y));
    if (c >= m + l) {
        return 0.0;
    }
    if (c <= -(m + l)) {
        return 1.0;
    }
    if (abs(c) <= m - l) {
        return 0.5 - 0.5 * c / m;
    }
    // A corner triangle of the square: its legs are (m + l - |c|)/m and (m + l - |c|)/l.
    float leg = m + l - abs(c);
    float corner = leg * leg / (8.0 * m * l);
    return c > 0.0 ? corner : 1.0 - corner;
}

#endif
