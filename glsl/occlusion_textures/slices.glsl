// Entered from visibility.comp, tiles.comp, place.comp, histogram.comp, slice.frag and others.
//
// Slices: where they lie, the part of one that the light's rays come through, and what they hide together.
//
// With `#define PIXELS` also the numbers of the passes over the pixels.

#ifndef OCCLUSION_TEXTURES_SLICES_GLSL
#define OCCLUSION_TEXTURES_SLICES_GLSL

#include "common/lists.glsl"

// ---------------------------------------------------------------------------------------------
// Where slices begin and end, and which of them a distance lies in.
//
// The distances that the occluders reach are cut into BINS equal parts; a slice is a run of these. The
// placement is an image of one row: of every bin the slice that it belongs to, then of every slice the
// distances of its upper plane, its lower plane and its texture, in metres from the light.

// Many small numbers divide it, so that equal slices are equal.
const int BINS = 960;

// The bin of a depth that a projection from behind the light stores (near/d), with `near` the distance of
// the near plane and `span` that of the far one from it, both from the projection point or both in units
// of near.
int bin_of(float stored, float near, float span)
{
    float t = (near / stored - near) / span;
    return clamp(int(t * float(BINS)), 0, BINS - 1);
}

// The first bin of a slice of `slices` equal ones.
int equal_bin(int slice, int slices)
{
    return (slice * BINS + slices / 2) / slices;
}

// ---------------------------------------------------------------------------------------------
// The part of a slice that the light's rays to a point come through (Eisemann and Decoret 2008, eq. 4).

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

// ---------------------------------------------------------------------------------------------
// The parts of slices that the light's rays to a tile's points come through.

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
// every texel begin up to a window and a half before the kernel.
float level_reach(float shorter)
{
    return 3.0 * max(shorter, 1.0) + 1.0;
}

// ---------------------------------------------------------------------------------------------
// From what slices hide each to what they hide together.

const int PRODUCT = 0;
const int SUM = 1;
const int MAXIMUM = 2;

// What is hidden of the light behind one more slice, that hides `more` of it for itself: as if slices knew
// nothing of each other (eq. 5), as if none were behind another, as if all were. Written so that no rounding makes
// it more than 1: from 0.5 on 1 - hidden is exact, and below it what is left of it rounds to 1 at most.
float hidden_with(int combine, float hidden, float more)
{
    return combine == PRODUCT ? hidden + (1.0 - hidden) * more
           : combine == SUM   ? min(hidden + more, 1.0)
                              : max(hidden, more);
}

const float FEW = 1.0e-3;

// As `hidden_with`, where the slice's window says what its blocking texels (x) have in common with those of all
// slices above it (y): z are both. `before` is what the slice right above hides of its own window.
float hidden_with_correlated(float hidden, float before, vec3 window)
{
    float own = window.x;
    float covered = window.y;
    float independent = own * covered;
    float correlation = window.z - independent;
    // How far from independent they could be, towards nested and towards disjoint.
    float most = min(own, covered) - independent;
    float least = independent - max(own + covered - 1.0, 0.0);
    // Where the window does not tell: as much as may go on from the slice right above.
    float prior = own > 0.0 ? min(before, window.z) / own : 0.0;
    float towards = correlation >= 0.0 ? (correlation + FEW * prior) / (most + FEW)
                                       : correlation / (least + FEW);
    // The light's rays through the window are not the same as through the slices above: what is hidden
    // there takes the place of what the window has of it.
    float both = own * hidden;
    both += towards >= 0.0 ? towards * (min(own, hidden) - both)
                           : towards * (both - max(own + hidden - 1.0, 0.0));
    return clamp(hidden + own - both, 0.0, 1.0);
}

// ---------------------------------------------------------------------------------------------
#ifdef PIXELS
// The numbers of the passes over the pixels.

layout(push_constant) uniform Push {
    mat4 light_from_ndc;
    vec2 texels_per_uv; // map texels a unit of u and v
    vec2 first;         // texel coordinates of u = v = 0
    vec2 half_light;    // half the light's width and height, m
    ivec2 extent;       // of the G-buffer
    float background;
    float eye;          // how far behind the light the projection point is, m
    int map;            // the map's side in texels
    int flags;          // slices; bit 8: masked; from bit 9 on how slices are combined; bit 12: mip
} push;

int slices() { return push.flags & 255; }
uint all_slices() { return 0xffffffffu >> (32 - slices()); } // a bit each
bool is_masked() { return (push.flags & 256) != 0; }
int combination() { return push.flags >> 9 & 7; }
int level_kind() { return (push.flags & 1 << 12) != 0 ? 2 : 0; } // MIP, N_BUFFER

GBuffer gbuffer()
{
    return GBuffer(push.light_from_ndc, push.extent, push.background, is_masked());
}

MapWindow map_window()
{
    return MapWindow(push.texels_per_uv, push.first, push.eye);
}
#endif

#endif
