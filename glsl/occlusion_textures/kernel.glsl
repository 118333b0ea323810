// The part of a slice that the light's rays to a point come through (Eisemann and Decoret 2008, eq. 4).

#ifndef OCCLUSION_TEXTURES_KERNEL_GLSL
#define OCCLUSION_TEXTURES_KERNEL_GLSL

// Texels of a map seen from `eye` metres behind the light.
struct MapWindow {
    vec2 texels_per_uv;
    vec2 first; // texel coordinates of u = v = 0
    float eye;
};

// The rectangle (least x and y, largest x and y) in texels that the rays from a light of `half_light` to
// `position` fill in the plane at distance `plane`: as large as the light, times the point's distance from
// the plane over its distance from the light. At least a texel wide, so that what is nearer than that is
// not missed.
vec4 kernel_of(MapWindow m, vec3 position, float plane, vec2 half_light)
{
    vec2 per_metre = m.texels_per_uv / (plane + m.eye);
    float share = plane / position.z;
    vec2 centre = position.xy * share * per_metre + m.first;
    vec2 reach = max(half_light * max(1.0 - share, 0.0) * per_metre, vec2(0.5));
    return vec4(centre - reach, centre + reach);
}

// How much of a slice counts for a point at distance z. A surface that blocks must not shadow itself: its
// own slice does not count, and the next one in so far as the point is away from it (section 3.4), so that
// nothing jumps where a surface goes from slice to slice. What only receives is in no slice: all that is
// nearer the light counts, a slice's part above the point as if the slice were filled evenly.
float slice_weight(float z, float upper, float lower, bool blocks)
{
    float thickness = lower - upper;
    float into = blocks ? z - lower : z - upper;
    return clamp(into / thickness, 0.0, 1.0);
}

#endif
