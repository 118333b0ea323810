// Entered from visibility.comp, tiles.comp, place.comp, histogram.comp, slice.frag and others.
//
// Slices: their distances, the part of a slice that the light's rays to a point cross, and how slices combine.
//
// With `#define PIXELS` it also declares the push constants of the passes over the pixels.

#ifndef OCCLUSION_TEXTURES_SLICES_GLSL
#define OCCLUSION_TEXTURES_SLICES_GLSL

#include "common/lists.glsl"

// ---------------------------------------------------------------------------------------------
// The distances at which slices begin and end, and the slice that a distance lies in.
//
// The range of the occluders' distances is cut into BINS equal parts; a slice is a run of these. The placement is an
// image of one row of texels: first the slice of every bin, then for every slice the distances of its upper plane, its
// lower plane and its texture, in metres from the light.

// Many small numbers divide this one, so that equal slices are equal.
const int BINS = 960;

// The bin of a depth that a projection from behind the light stores (near/d), with `near` the distance of the near
// plane from the projection point and `span` that of the far plane from the near one, both in metres or both in units
// of near.
//
// A projection from infinitely far stores depths that fall evenly from 1 to 0; `near` is 0 for it, and `span` the share
// of its heights that the slices have.
int bin_of(float stored, float near, float span)
{
    float t = (near > 0.0 ? near / stored - near : 1.0 - stored) / span;
    return clamp(int(t * float(BINS)), 0, BINS - 1);
}

// The first bin of a slice, where all of `slices` are equal.
int equal_bin(int slice, int slices)
{
    return (slice * BINS + slices / 2) / slices;
}

// ---------------------------------------------------------------------------------------------
// The part of a slice that the light's rays to a point cross (Eisemann and Decoret 2008, eq. 4).

// The window of a map that is seen from `eye` metres behind the light, or for parallel light from infinitely far.
struct MapWindow {
    vec2 texels_per_uv;
    vec2 first; // texel coordinates of u = v = 0
    float eye;
    bool parallel;
};

// The rectangle (least x and y, largest x and y) in texels that the rays from a light of `half_light` to `position`
// fill in the plane at distance `plane`: as large as the light, times the point's distance from the plane over its
// distance from the light. It is at least a texel wide, so that an occluder nearer to the point than that is not
// missed.
vec4 kernel_of(MapWindow m, vec3 position, float plane, vec2 half_light)
{
    vec2 per_metre = m.texels_per_uv / (m.parallel ? 1.0 : plane + m.eye);
    float share = m.parallel ? 1.0 : plane / position.z;
    float spread = m.parallel ? position.z - plane : 1.0 - share;
    vec2 centre = position.xy * share * per_metre + m.first;
    vec2 reach = max(half_light * max(spread, 0.0) * per_metre, vec2(0.5));
    return vec4(centre - reach, centre + reach);
}

// The share of a slice that counts for a point at distance z. A surface that blocks must not shadow itself: its own
// slice does not count, and the next one fades in with the point's distance from it (section 3.4), so that nothing
// jumps where a surface goes from slice to slice. A surface that only receives is in no slice: everything nearer to
// the light counts, and the part of a slice above the point as if the slice were filled evenly.
float slice_weight(float z, float upper, float lower, bool blocks)
{
    float thickness = lower - upper;
    float into = blocks ? z - lower : z - upper;
    return clamp(into / thickness, 0.0, 1.0);
}

// ---------------------------------------------------------------------------------------------
// The parts of slices that the light's rays to a tile's points cross.

// The place t of a point at w, in texels from u = v = 0, as if the eye were at the light's centre.
vec2 centred(MapWindow m, vec3 position, float w)
{
    return position.xy * (m.parallel ? 1.0 : w) * m.texels_per_uv;
}

// Half the width and height in texels of the kernel of a tile's furthest point, which is the widest.
vec2 tile_reach(MapWindow m, Tile tile, float plane, vec2 half_light)
{
    float spread = m.parallel ? -tile.w.x - plane : (1.0 - plane * tile.w.x) / (plane + m.eye);
    return max(half_light * max(spread, 0.0) * m.texels_per_uv, vec2(0.5));
}

// A rectangle that holds the kernels of all of a tile's points in a plane, for any rounding of the pass over the
// pixels. A kernel's centre is t, moved towards u = v = 0 by the eye's distance behind the light.
vec4 tile_kernel(MapWindow m, Tile tile, float plane, vec2 half_light)
{
    float share = m.parallel ? 1.0 : plane / (plane + m.eye);
    vec2 reach = tile_reach(m, tile, plane, half_light);
    vec2 widest = half_light * m.texels_per_uv * (m.parallel ? abs(plane) : 1.0 / (plane + m.eye));
    reach += (abs(m.first) + widest) * TILE_ROUNDING + TILE_TEXEL;
    return vec4(tile.t_min * share + m.first - reach, tile.t_max * share + m.first + reach);
}

// The most texels by which means from levels reach beyond a kernel, for the length of its shorter side in texels:
// windows are less than twice as wide as that, or two texels; four side by side are interpolated between, of which
// those that are not at every texel begin up to a window and a half before the kernel.
float level_reach(float shorter)
{
    return 3.0 * max(shorter, 1.0) + 1.0;
}

// ---------------------------------------------------------------------------------------------
// The combination of the parts that single slices hide.

const int PRODUCT = 0;
const int SUM = 1;
const int MAXIMUM = 2;

// The hidden part of the light behind one more slice, which hides `more` of it by itself: for independent slices
// (eq. 5), for disjoint ones, or for nested ones. No rounding makes it more than 1: from 0.5 on 1 - hidden is exact,
// and below it the rest rounds to 1 at most.
float hidden_with(int combine, float hidden, float more)
{
    return combine == PRODUCT ? hidden + (1.0 - hidden) * more
           : combine == SUM   ? min(hidden + more, 1.0)
                              : max(hidden, more);
}

const float FEW = 1.0e-3;

// `hidden_with` for correlated slices: `window` holds the shares of the kernel that the slice blocks (x), that the
// slices above it block (y), and that both block (z). `before` is the share that the slice right above blocks in its
// own window.
float hidden_with_correlated(float hidden, float before, vec3 window)
{
    float own = window.x;
    float covered = window.y;
    float independent = own * covered;
    float correlation = window.z - independent;
    // The largest deviations from independence: that of nested slices, and that of disjoint ones.
    float most = min(own, covered) - independent;
    float least = independent - max(own + covered - 1.0, 0.0);
    // Where the window gives no overlap (FEW), the share that may continue from the slice right above is assumed.
    float prior = own > 0.0 ? min(before, window.z) / own : 0.0;
    float towards = correlation >= 0.0 ? (correlation + FEW * prior) / (most + FEW)
                                       : correlation / (least + FEW);
    // The light's rays through this window differ from those through the slices above: what is hidden there replaces
    // the share that the window has of it.
    float both = own * hidden;
    both += towards >= 0.0 ? towards * (min(own, hidden) - both)
                           : towards * (both - max(own + hidden - 1.0, 0.0));
    return clamp(hidden + own - both, 0.0, 1.0);
}

// ---------------------------------------------------------------------------------------------
#ifdef PIXELS
// The push constants of the passes over the pixels.

layout(push_constant) uniform Push {
    vec2 texels_per_uv; // map texels a unit of u and v
    vec2 first;         // texel coordinates of u = v = 0
    vec2 half_light;    // half the light's width and height, m; tangents for a sun
    float eye;          // how far behind the light the projection point is, m
    int map;            // the map's side in texels
    int flags;          // bits 0 to 7: slices; from bit 8 on how slices are combined; bit 11: mip; bit 12: near
    float top;          // the w of the map's near plane
    float snap;         // how far a raster moves a vertex, in texels
} push;

int slices() { return push.flags & 255; }
uint all_slices() { return 0xffffffffu >> (32 - slices()); } // a bit for each slice
int combination() { return push.flags >> 8 & 7; }
bool looks_near() { return (push.flags & 1 << 12) != 0; } // at the nearest faces, for what slices leave out
int level_kind() { return (push.flags & 1 << 11) != 0 ? 2 : 0; } // MIP, N_BUFFER

MapWindow map_window()
{
    return MapWindow(push.texels_per_uv, push.first, push.eye, is_parallel());
}
#endif

#endif
