// Entered from columns.comp, level.comp and pixel.glsl; at first skip what is behind SEARCH.
//
// The columns of solid matter that the layers give over each texel, and the test whether a ray meets one.
//
// A column is (top, bottom, second top, second bottom): heights, growing towards the light, between which there is
// matter. The second interval is below the first, and 0 where there is none; an empty column is 0. Height is
// w = 1/distance from the projection point, or the distance from the far plane where the projection is orthographic:
// either way a straight line in space is a straight line in (texels, height).

#ifndef RAY_MARCH_COLUMN_GLSL
#define RAY_MARCH_COLUMN_GLSL

const float FAR_OFF = 3.0e38;

// The bounds of a window's columns; each component is the maximum over the columns:
//     x   the highest top                   y   minus the lowest bottom
//     z   minus the lowest first top        w   the highest first bottom
// No ray is stopped above x or below -y; between w and -z, where that is an interval, every ray is.
vec4 bounds_of(vec4 column)
{
    if (column.x <= 0.0) {
        return vec4(0.0, -FAR_OFF, 0.0, FAR_OFF);
    }
    return vec4(column.x, -(column.z > 0.0 ? column.w : column.y), -column.x, column.y);
}

// How far a surface goes down from a texel at height h towards a neighbour. It does not where the step is more than
// twice the one by which it comes down from the other side, or the one by which it goes on down behind the neighbour:
// the neighbour then shows another surface. A wire over a floor neither comes down nor goes on. Heights of 0 mean no
// surface.
float step_down(float h, float neighbour, float behind_it, float opposite)
{
    float drop = h - neighbour;
    float before = opposite > h ? opposite - h : FAR_OFF;
    float behind = behind_it > 0.0 && behind_it <= neighbour ? neighbour - behind_it : FAR_OFF;
    float slope = min(before, behind) < FAR_OFF ? min(before, behind) : 0.0;
    return neighbour > 0.0 && drop <= 2.0 * slope ? max(drop, 0.0) : 0.0;
}

// Cuts off the ends of a piece of matter over a texel, whose surfaces go so far up or down within half a texel at its
// top and its bottom. A column is as high all over its texel as at its centre, and rays that graze a solid meet the
// corners that stick out. At most half the piece is cut off from either side, and nothing of a sheet.
vec2 beveled(vec2 piece, float above, float below)
{
    float most = 0.5 * max(piece.x - piece.y, 0.0);
    return vec2(piece.x - min(above, most), piece.y + min(below, most));
}

// The column of a solid between its nearest faces (top) and its furthest back faces; 0 where it has none.
vec4 one_interval(float top, float far_back)
{
    return vec4(top, far_back > 0.0 ? min(far_back, top) : top, 0.0, 0.0);
}

// The column of the matter between nearest faces, nearest back faces, furthest front faces and furthest back faces,
// each 0 where there are none. Matter reaches from a front face to the next back face; a face without its other side
// is a sheet.
vec4 two_intervals(float top, float near_back, float far_front, float far_back)
{
    float bottom = near_back > 0.0 ? near_back : top;
    if (far_front <= 0.0 || far_front >= bottom) {
        // No front face lies below the first back face: the matter is one piece, or several that overlap.
        return one_interval(top, far_back);
    }
    float second = far_back > 0.0 ? min(far_back, far_front) : far_front;
    return vec4(top, bottom, far_front, second);
}

#ifdef SEARCH
#define VALUE vec4
#include "nbuffer/levels.glsl"
#include "common/light_space.glsl"

// Whether a ray through the map meets a column.
//
// A ray is followed from its receiver towards the light by its height above it, `s`: over the receiver at
// s = 0, over `t + s g` of the map at height `w + s`. It enters and leaves texels in that order, so that
// the heights over one texel are an interval.
//
// The including shader declares the bounds of the map's windows, and the test for what the eye sees, if there is one.

// The bounds of a window; at level 0 the texel's column.
vec4 held_at(Levels l, int level, ivec2 node);

// The piece of matter between the two of a texel's column; 0 where there is none.
vec2 middle_at(ivec2 texel);

// Whether a point of (texels, height) is known to be empty.
bool seen(vec2 t, float w);

vec4 combine(vec4 a, vec4 b)
{
    return max(a, b);
}

vec4 value_at(Levels l, int level, ivec2 node)
{
    vec4 held = held_at(l, level, node);
    return level == 0 ? bounds_of(held) : held;
}

// A receiver in the map, and its own plane: a point (x, y) texels at height h lies n.x x + n.y y + n_0 - c h above it
// (see light_space.glsl). A surface that is less than `margin` above the plane at a texel's centre stops no ray of the
// receiver: it may be the receiver's own.
struct Place {
    vec2 t;
    float w;
    vec2 n;
    float n_0;
    float c;
    float margin;
};

struct Ray {
    vec2 g;      // texels a unit of height
    float start; // the s at which it begins and ends
    float end;
};

// The most turns of all searches of a pixel; rays that are left then are not counted. Mesa's CPU driver cuts an invocation
// off, silently, after 65535 turns of all its loops together: 256 rays with their searches stay below, as no loop is
// within a turn. A ray that grazes a floor looks at nearly every texel on its way, up to three turns each.
const int TURNS = 64000;

// The most steps of a linear search, with room for halvings; a pixel of 256 rays that often halve in vain may still
// come to Mesa's limit.
const int STEPS = 200;

// Heights are compared with what they were made of by one addition; this is more than its rounding.
const float SLACK = 1.0e-6;

// Rays are cut with more slack than heights are compared with, so that no cut changes what a ray meets.
const float CUT_SLACK = 4.0 * SLACK;

bool is_clear(Place p, vec2 centre, float top)
{
    return dot(centre, p.n) + p.n_0 - p.c * top > p.margin;
}

// Whether all columns of a window with bounds b stop a ray that is within it from height w0 to w1.
bool stops_all(Place p, vec2 lo, float window, vec4 b, float w0, float w1)
{
    // The first top that is least clear of the plane lies where the plane is highest.
    vec2 highest = mix(lo + 0.5, lo + window - 0.5, lessThan(p.n, vec2(0.0)));
    float top = p.c > 0.0 ? b.x : -b.z;
    return max(w0, b.w) <= min(w1, -b.z) && is_clear(p, highest, top);
}

// Whether a ray that is over a texel from s0 to s1 meets one of its column's intervals (top, bottom).
bool meets_interval(Place p, Ray ray, vec2 centre, vec2 interval, float s0, float s1)
{
    float lo = max(p.w + s0, interval.y * (1.0 - SLACK));
    float hi = min(p.w + s1, interval.x * (1.0 + SLACK));
    if (interval.x <= 0.0 || lo > hi || !is_clear(p, centre, interval.x)) {
        return false;
    }
    // The nearest and the furthest faces exist, whether or not the eye sees them; matter between them may be what the
    // eye looks through.
    bool crosses = p.w + s0 < interval.y || p.w + s1 > interval.x;
    float s = 0.5 * (lo + hi) - p.w;
    return crosses || !seen(p.t + s * ray.g, p.w + s);
}

// The hit test: whether a ray that is over a texel from s0 to s1 meets its column.
bool meets(Place p, Ray ray, ivec2 texel, vec4 column, float s0, float s1)
{
    vec2 centre = vec2(texel) + 0.5;
    return meets_interval(p, ray, centre, column.xy, s0, s1) ||
           meets_interval(p, ray, centre, column.zw, s0, s1) ||
           column.z > 0.0 && meets_interval(p, ray, centre, middle_at(texel), s0, s1);
}

// The heights above a receiver between which a window with bounds b has matter.
vec2 matter_above(Place p, vec4 b)
{
    return vec2(-b.y * (1.0 - CUT_SLACK), b.x * (1.0 + CUT_SLACK)) - p.w;
}

vec2 inverse_of(vec2 g)
{
    // A ray along a row or a column of texels never leaves it.
    return vec2(abs(g.x) < 1.0e-30 ? 1.0e30 : 1.0 / g.x, abs(g.y) < 1.0e-30 ? 1.0e30 : 1.0 / g.y);
}

// Cuts a ray to the part over the map.
Ray over_map(Place p, Ray ray, int map)
{
    vec2 inverse = inverse_of(ray.g);
    vec2 a = -p.t * inverse;
    vec2 b = (float(map) - p.t) * inverse;
    vec2 from = min(a, b);
    vec2 to = max(a, b);
    return Ray(ray.g, max(ray.start, max(from.x, from.y)), min(ray.end, min(to.x, to.y)));
}

// The lines between texels that a ray crosses: at s = (line - t) * inverse, for every x and y.
struct Lines {
    vec2 t;
    vec2 g;
    vec2 inverse;
    bvec2 up; // whether x and y grow along the ray
};

Lines lines_of(Place p, Ray ray)
{
    return Lines(p.t, ray.g, inverse_of(ray.g), greaterThanEqual(ray.g, vec2(0.0)));
}

// The s at which a ray crosses the lines where it leaves a square window.
vec2 leaves_at(Lines l, vec2 lo, float window)
{
    return (mix(lo, lo + window, l.up) - l.t) * l.inverse;
}

// The texel that a ray is over at s: behind each line that it has crossed by then, and before every other line. Rounded
// coordinates could give another texel, and which texels a ray visits would depend on the windows that it came through.
ivec2 texel_under(Lines l, float s)
{
    vec2 at = floor(l.t + s * l.g);
    vec2 ahead = mix(vec2(-1.0), vec2(1.0), l.up);
    vec2 enters = (mix(at + 1.0, at, l.up) - l.t) * l.inverse;
    vec2 leaves = leaves_at(l, at, 1.0);
    at += mix(vec2(0.0), ahead, greaterThanEqual(vec2(s), leaves));
    at -= mix(vec2(0.0), ahead, lessThan(vec2(s), enters));
    return ivec2(at);
}

// Hierarchical search (Curtis 2009, algorithm 2): windows that cannot stop the ray are passed at once, and larger ones
// tried next; otherwise smaller ones are. Two departures: the window lies ahead of the ray instead of around it, and a
// window whose columns have a common height that the ray passes stops it without a look at its texels. `s` is where the
// ray is stopped. `turns` is how many turns it may have, and then how many are left; at 0 nothing is known of the ray.
bool search_hierarchical(Place p, Ray ray, Levels l, bool eye, inout int turns, out float s)
{
    Lines lines = lines_of(p, ray);
    s = ray.start;
    vec2 extent = abs((ray.end - ray.start) * ray.g);
    int top = top_of(l);
    int level = clamp(l.kind == THIRDS ? log_three(int(max(extent.x, extent.y)) + 1)
                                       : log_above(int(max(extent.x, extent.y)) + 1), 0, top);
    for (; turns > 0; --turns) {
        ivec2 texel = clamp(texel_under(lines, s), ivec2(0), ivec2(l.map - 1));
        int window = window_of(l, level);
        ivec2 node = node_at(l, level, l.kind == MIP ? texel : mix(texel - window + 1, texel, lines.up));
        vec2 lo = vec2(l.kind == MIP ? node << level : node);
        vec2 leaves = leaves_at(lines, lo, float(window));
        float next = min(min(leaves.x, leaves.y), ray.end);
        vec4 held = held_at(l, level, node);
        vec4 b = level == 0 ? bounds_of(held) : held;
        vec2 matter = matter_above(p, b);
        bool passes = next < matter.x || s > matter.y;
        if (!passes && level > 0) {
            if (!eye && stops_all(p, lo, float(window), b, p.w + s, p.w + next)) {
                return true;
            }
            // Below all matter of the window the ray meets nothing.
            s = max(s, matter.x);
            --level;
        } else {
            if (!passes && meets(p, ray, node, held, s, next)) {
                return true;
            }
            if (next >= ray.end) {
                return false;
            }
            s = next;
            level = passes ? min(level + 1, top) : level;
        }
    }
    return false;
}

// The column of the texel that a ray is over at s.
vec4 column_under(Place p, Ray ray, float s, Levels l, out ivec2 texel)
{
    texel = clamp(ivec2(floor(p.t + s * ray.g)), ivec2(0), ivec2(l.map - 1));
    return held_at(l, 0, texel);
}

bool meets_either(Place p, Ray ray, float s0, float s1, Levels l)
{
    ivec2 texel;
    vec4 column = column_under(p, ray, s0, l, texel);
    if (meets(p, ray, texel, column, s0, s1)) {
        return true;
    }
    column = column_under(p, ray, s1, l, texel);
    return meets(p, ray, texel, column, s0, s1);
}

// Linear search with binary refinement (section 3.3). A step covers a texel at most, unless the ray is longer than
// STEPS texels. It is tested from both its ends over all the heights between them, so that nothing between two steps
// is lost, however thin; halving the step then finds whether the ray really meets what was found.
bool search_linear(Place p, Ray ray, Levels l, out float s)
{
    s = ray.start;
    vec2 extent = abs((ray.end - ray.start) * ray.g);
    int steps = clamp(int(ceil(max(extent.x, extent.y))), 1, STEPS);
    float width = (ray.end - ray.start) / float(steps);
    for (int i = 0; i < steps; ++i) {
        float s0 = ray.start + float(i) * width;
        float s1 = i + 1 < steps ? s0 + width : ray.end;
        bool met = meets_either(p, ray, s0, s1, l);
        // Three halvings are an eighth of a texel.
        for (int halving = 0; met && halving < 3; ++halving) {
            float middle = 0.5 * (s0 + s1);
            if (meets_either(p, ray, s0, middle, l)) {
                s1 = middle;
            } else {
                met = meets_either(p, ray, middle, s1, l);
                s0 = middle;
            }
        }
        if (met) {
            s = s0;
            return true;
        }
    }
    return false;
}
#endif

#endif
