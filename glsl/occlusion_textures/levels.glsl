// Entered from first_level.comp, next_level.comp and visibility.comp.
//
// The image array that keeps the levels of all tiles: a tile's levels from the first one on lie in consecutive layers,
// tile after tile. Level 0 is the mask.

#ifndef OCCLUSION_TEXTURES_LEVELS_GLSL
#define OCCLUSION_TEXTURES_LEVELS_GLSL

#include "nbuffer/levels.glsl"

ivec3 place_of_tile(Levels l, int tile, int level, ivec2 node)
{
    int layers = l.kind == MIP ? 1 : top_of(l);
    return place_of(l, level, node) + ivec3(0, 0, tile * layers - 1);
}

#ifdef RECTANGLES
// Means of any rectangle from levels of windows of 2^k x 2^k texels, interpolated between windows and levels (Eisemann
// and Decoret 2008, section 3.2).

// The most windows side by side that cover a rectangle; a longer one is sampled.
const int MOST_WINDOWS = 8;

vec4 node_value(Levels l, int tile, int level, ivec2 node)
{
    ivec2 n = clamp(node, ivec2(0), ivec2(side_of(l, level) - 1));
    if (level == 0) {
        return vec4(tile_means(texelFetch(mask, n, 0).x, tile, IS_CORRELATED));
    }
    return texelFetch(filtered, place_of_tile(l, tile, level, n), 0);
}

// The mean over a window of a level around a place, interpolated between the four nearest nodes.
vec4 window_mean(Levels l, int tile, int level, vec2 centre)
{
    float window = float(1 << level);
    vec2 at = l.kind == MIP ? centre / window - 0.5 : centre - 0.5 * window;
    ivec2 corner = ivec2(floor(at));
    vec2 f = at - vec2(corner);
    vec4 upper = mix(node_value(l, tile, level, corner), node_value(l, tile, level, corner + ivec2(1, 0)), f.x);
    vec4 lower = mix(node_value(l, tile, level, corner + ivec2(0, 1)),
                     node_value(l, tile, level, corner + ivec2(1, 1)), f.x);
    return mix(upper, lower, f.y);
}

// Means cannot distinguish an empty rectangle from one with little in it, so none counts as empty.
bool is_empty(vec2 lo, vec2 hi)
{
    return false;
}

// The shares of a rectangle, `lo` to `hi` in texels, that a slice blocks, that those above it block, and that both
// block: the mean over windows as wide as its shorter side, side by side along the longer one.
vec3 mean_of(int slice, vec2 lo, vec2 hi)
{
    int tile = IS_CORRELATED ? slice : slice >> 2;
    Levels l = Levels(push.map, level_kind());
    vec2 size = hi - lo;
    float shorter = max(min(size.x, size.y), 1.0);
    float exact = min(log2(shorter), float(top_of(l)));
    int level = int(exact);
    int next = min(level + 1, top_of(l));
    float f = exact - float(level);
    int count = clamp(int(max(size.x, size.y) / shorter + 0.5), 1, MOST_WINDOWS);
    vec2 along = size.x > size.y ? vec2(size.x, 0.0) : vec2(0.0, size.y);
    vec2 middle = 0.5 * (lo + hi) - 0.5 * along;
    vec4 sum = vec4(0.0);
    for (int i = 0; i < count; ++i) {
        vec2 centre = middle + along * ((float(i) + 0.5) / float(count));
        sum += mix(window_mean(l, tile, level, centre), window_mean(l, tile, next, centre), f);
    }
    // A full window may come out as 1 + 2^-23 where drivers interpolate as x + y a - x a.
    sum = min(sum / float(count), 1.0);
    return IS_CORRELATED ? sum.xyz : vec3(sum[slice & 3]);
}
#endif

#endif
