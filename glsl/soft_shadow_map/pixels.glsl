// Entered from tiles.comp and gather_pixels.comp.
//
// The push constants that the passes over the pixels share.

#ifndef SOFT_SHADOW_MAP_PIXELS_GLSL
#define SOFT_SHADOW_MAP_PIXELS_GLSL

layout(push_constant) uniform Push {
    vec2 scale;         // (du/Lx, dv/Ly), 1/m
    vec2 texels_per_uv; // occluder texels a unit of u and v
    vec2 first;         // texel coordinates of u = v = 0
    float w_max;        // no occluder is nearer than 1/w_max
    float spread;       // the series' limit, see classify
    float snap;         // how far a raster moves a vertex, in texels
    int row;            // superblocks a row
    int sums;           // where the prefix sums begin in the gather's nodes
    int flags;          // bit 0: two sides; bit 1: their mean
    float depth_error;  // how far off an occluder's w may be beyond its rounding, 1/m
} push;

// The place t, in texels of the occluder map, of a point of light space with w = 1/position.z.
vec2 place_of(vec3 position, float w)
{
    return uv_of(position, w) * push.texels_per_uv + push.first;
}

#endif
