// The parts of slices that the light's rays to a tile's points come through.

#ifndef OCCLUSION_TEXTURES_TILE_KERNEL_GLSL
#define OCCLUSION_TEXTURES_TILE_KERNEL_GLSL

#include "occlusion_textures/kernel.glsl"
#include "visibility/tile.glsl"

// t of a point, at w: its place in the map if the eye were at the light's centre, from that of u = v = 0.
vec2 centred(MapWindow m, vec3 position, float w)
{
    return position.xy * w * m.texels_per_uv;
}

// Half the width and height in texels of the kernel of a tile's furthest point, which is the widest.
vec2 tile_reach(MapWindow m, Tile tile, float plane, vec2 half_light)
{
    return max(half_light * max(1.0 - plane * tile.w.x, 0.0) * m.texels_per_uv / (plane + m.eye), vec2(0.5));
}

// A rectangle that holds the kernels of all of a tile's points in a plane, whatever rounding the pass over the
// pixels has: a kernel's centre is t, drawn towards u = v = 0 by as much as the eye is behind the light.
vec4 tile_kernel(MapWindow m, Tile tile, float plane, vec2 half_light)
{
    float share = plane / (plane + m.eye);
    vec2 reach = tile_reach(m, tile, plane, half_light);
    vec2 widest = half_light * m.texels_per_uv / (plane + m.eye);
    reach += (abs(m.first) + widest) * TILE_ROUNDING + TILE_TEXEL;
    return vec4(tile.t_min * share + m.first - reach, tile.t_max * share + m.first + reach);
}

// How far from a kernel its means from levels reach, at most, by its shorter side in texels: windows are less than
// twice as wide as that, or two texels; four side by side are interpolated between, of which those that are not at
// every texel begin up to a window and a half before what is asked for.
float level_reach(float shorter)
{
    return 3.0 * max(shorter, 1.0) + 1.0;
}

#endif
