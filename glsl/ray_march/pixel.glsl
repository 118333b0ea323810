// Entered from classify.comp, trace.comp and headless/forward.frag.
//
// The passes over the pixels share these inputs and the functions that find a pixel's place in the map.
//
// With `#define FORWARD` the pixels are fragments, whose place and plane the including shader has without a G-buffer:
// it defines `vec3 pixel_normal(ivec2 p, Receiver r)`.

#ifndef RAY_MARCH_PIXEL_GLSL
#define RAY_MARCH_PIXEL_GLSL

#ifdef FORWARD
#define GBUFFER_CONSTANTS
#else
#define GBUFFER
#endif
#include "common/light_space.glsl"
#include "ray_march/noise.glsl"

#define SEARCH
#include "ray_march/column.glsl"

layout(set = 0, binding = 2) uniform texture2DArray windows;
#ifndef FORWARD
layout(set = 0, binding = 3, FRACTION_FORMAT) writeonly uniform image2D visibility;
#endif

vec4 held_at(Levels l, int level, ivec2 node)
{
    return texelFetch(windows, place_of(l, level, node), 0);
}

// No point is known to be empty, unless the including shader defines SEEN and a test of its own.
#ifndef SEEN
bool seen(vec2 t, float w)
{
    return false;
}
#endif

#ifdef FORWARD
// A forward pass's push constants belong to the drawn mesh.
layout(set = 0, binding = 0, std140) uniform Push {
#else
layout(push_constant) uniform Push {
#endif
    vec2 texels_per_unit; // map texels a unit of u and v, or a metre where the projection is orthographic
    vec2 first;           // texel coordinates of u = v = 0
    vec2 half_light;      // half the light's width and height, m; tangents for a sun
    float eye;            // how far behind the light the projection point is, m; or the far plane's distance
    float top;            // the height of the near plane; no occluder is higher
    float snap;           // how far a raster moves a vertex, in texels
    float depth_error;    // how far off an occluder's height may be beyond its rounding
    int map;              // the map's side in texels
    int flags;            // see below
    uint seed;
} push;

// Bits 0 to 7 of the flags: the number of rays, 1 to 256, less one.
int rays() { return (push.flags & 255) + 1; }
// Bits 8 to 15 of the flags: the rows of cells of a jittered grid, less one.
int cell_rows() { return (push.flags >> 8 & 255) + 1; }
bool is_orthographic() { return (push.flags & 1 << 17) != 0; }
bool is_modern() { return (push.flags & 1 << 19) != 0; }
bool classifies() { return (push.flags & 1 << 21) != 0; }
bool filters() { return (push.flags & 1 << 22) != 0; }
bool has_middle() { return (push.flags & 1 << 30) != 0; }
bool is_disc() { return (push.flags & 1 << 28) != 0; }
#ifdef FORWARD
bool is_polygon() { return false; }
#else
bool is_polygon() { return (push.flags & 1 << 29) != 0; }
#endif
int sampling() { return push.flags >> 23 & 3; }

// Whether rays are weighed by a texture, which classify.comp asks: its variant for the usual settings without color is for
// lights without one.
#if defined(USUAL) && !defined(COLOR)
bool is_textured() { return false; }
#else
bool is_textured() { return (push.flags & 1 << 27) != 0; }
#endif

// `#define USUAL` leaves out what only unusual settings need: the rays then take 0.4 of the time.
#ifdef USUAL
bool is_linear() { return false; }
bool looks_from_eye() { return false; }
int level_kind() { return N_BUFFER; }
#else
bool is_linear() { return (push.flags & 1 << 18) != 0; }
bool looks_from_eye() { return (push.flags & 1 << 20) != 0; }
int level_kind() { return push.flags >> 25 & 3; }
#endif

Levels levels()
{
    return Levels(push.map, level_kind());
}

// The last layer of the windows has the third pieces of matter, where there are such.
vec2 middle_at(ivec2 texel)
{
    return has_middle() ? texelFetch(windows, ivec3(texel, layers_of(levels())), 0).xy : vec2(0.0);
}

#ifdef FORWARD
vec3 pixel_normal(ivec2 p, Receiver r);
#else
// The normal of the plane that a pixel shows, on the side that light comes from.
vec3 pixel_normal(ivec2 p, Receiver r)
{
    vec3 normal = receiver_normal(p, r.position);
    // A surface that does not block light is lit through its other side as well.
    return !r.blocks && c_of(normal, r.position) > 0.0 ? -normal : normal;
}
#endif

#ifndef FORWARD
// A polygon is given in the list of pixels: its corners, counter-clockwise, in metres; and the triangles that it is cut
// into, each as the share of the area before it and the numbers of its corners, 4 bits each, behind which the share is 1.
// The last of these has 1 over the area and the number of corners.
const int LAST_PIECE = 15;

// The part of the polygon where dot(n, p) > c.
float part_of_polygon_above(vec2 n, float c)
{
    float reach = dot(abs(n), push.half_light);
    if (abs(c) >= reach) {
        return c < 0.0 ? 1.0 : 0.0;
    }
    float steep = length(n);
    mat2 turn = mat2(n.y, n.x, -n.x, n.y) / steep;
    int count = int(pieces[LAST_PIECE].y);
    vec2 a = turn * corners[count - 1] - vec2(0.0, c / steep);
    float area = 0.0;
    for (int i = 0; i < count; ++i) {
        vec2 b = turn * corners[i] - vec2(0.0, c / steep);
        area -= area_above(a, b);
        a = b;
    }
    return clamp(area * uintBitsToFloat(pieces[LAST_PIECE].x), 0.0, 1.0);
}

// The point of the polygon for one of [0, 1]^2.
vec2 in_polygon(vec2 s)
{
    int at = 0;
    float before = 0.0;
    float behind = uintBitsToFloat(pieces[1].x);
    while (s.x >= behind && behind < 1.0) {
        ++at;
        before = behind;
        behind = uintBitsToFloat(pieces[at + 1].x);
    }
    uint numbers = pieces[at].y;
    vec2 within = vec2(clamp((s.x - before) / (behind - before), 0.0, 1.0), s.y);
    return in_triangle(corners[numbers & 15u], corners[numbers >> 4 & 15u], corners[numbers >> 8 & 15u], within);
}
#endif

// The part of the light above the pixel's own plane; all of it where the pixel's surface does not block.
float part_above(Receiver r)
{
#ifndef FORWARD
    if (r.blocks && is_polygon()) {
        return part_of_polygon_above(r.normal.xy, c_of(r.normal, r.position));
    }
#endif
    vec2 slope = r.normal.xy * push.half_light;
    float c = c_of(r.normal, r.position);
    return !r.blocks ? 1.0 : is_disc() ? fraction_of_disc_above(slope, c) : fraction_above(slope, c);
}

// The pixel's place in the map. For a receiver without a normal the plane is the map's own and must not be used.
Place place_of(Receiver r)
{
    vec3 position = r.position;
    vec3 normal = r.blocks ? r.normal : TOWARDS_LIGHT;
    vec2 n = normal.xy / push.texels_per_unit;
    float offset = dot(n, push.first);
    Place p;
    p.n = n;
    if (is_orthographic()) {
        p.w = push.eye - position.z;
        p.t = position.xy * push.texels_per_unit + push.first;
        p.n_0 = normal.z * push.eye - dot(normal, position) - offset;
        p.c = normal.z;
    } else {
        position.z += push.eye;
        p.w = 1.0 / position.z;
        p.t = position.xy * p.w * push.texels_per_unit + push.first;
        p.n_0 = normal.z - offset;
        p.c = dot(normal, position);
    }
    p.margin = plane_rounding(n, p.n_0, p.c, p.t, p.w, push.snap, push.depth_error) +
               own_slope(r.blocks) * 0.5 * length(1.0 / push.texels_per_unit);
    return p;
}

// The distance in metres from the light's plane to a point at height w.
float distance_of(float w)
{
    return is_orthographic() ? push.eye - w : 1.0 / w - push.eye;
}

// Texels a unit of height along the ray to a point of the light, which is given as its half-extents are.
vec2 slope_to(Place p, float distance_from_light, vec2 point)
{
    vec2 across = push.texels_per_unit * point;
    if (is_parallel()) {
        return across;
    }
    return is_orthographic()
               ? (across + push.first - p.t) / distance_from_light
               : (across + push.eye * (push.first - p.t)) / (distance_from_light * p.w);
}

// The heights above a receiver between which a column could stop one of its rays, none where they end before they
// start; and the bounds of a window of columns that contains all of its rays there, if the map holds that window.
struct Reach {
    float start;
    float end;
    bool whole;
    vec2 from;
    float side;
    vec4 bounds;
};

// Two refinements are enough to close in on the penumbra (Curtis 2009 section 3.6), after the one with the whole map's
// highest occluder.
const int REFINEMENTS = 3;

// Refines the reach (Curtis 2009 section 3.6): the window of the map that rays below the highest occluder can come
// through bounds how high the highest occluder within it is, and so on. From the first window on, the lowest occluder
// bounds it too. Only t and w of the place are read.
Reach reach_of(Place p, float distance_from_light)
{
    Reach reach = Reach(0.0, push.top * (1.0 + SLACK) - p.w, false, vec2(0.0), 0.0, vec4(0.0));
    if (!classifies()) {
        return reach;
    }
    vec2 g_a = slope_to(p, distance_from_light, -push.half_light);
    vec2 g_b = slope_to(p, distance_from_light, push.half_light);
    vec2 end = vec2(push.map - 1);
    for (int i = 0; i < REFINEMENTS && reach.start <= reach.end; ++i) {
        vec2 from = floor(p.t + min(reach.start * g_a, reach.end * g_a));
        vec2 to = floor(p.t + max(reach.start * g_b, reach.end * g_b));
        if (any(greaterThan(from, end)) || any(lessThan(to, vec2(0.0)))) {
            reach.end = reach.start - 1.0;
            return reach;
        }
        reach.from = clamp(from, vec2(0.0), end);
        vec2 to_inside = clamp(to, vec2(0.0), end);
        reach.whole = from == reach.from && to == to_inside;
        vec2 size = to_inside - reach.from + 1.0;
        reach.side = max(size.x, size.y);
        // The last window is exact, earlier ones are up to twice as wide.
        reach.bounds = i + 1 < REFINEMENTS
                           ? wider_window_value(levels(), ivec2(reach.from), int(reach.side))
                           : window_value(levels(), ivec2(reach.from), int(reach.side));
        vec2 matter = matter_above(p, reach.bounds);
        reach.start = max(reach.start, matter.x);
        reach.end = min(reach.end, matter.y);
    }
    return reach;
}

// ---------------------------------------------------------------------------------------------
// Whether rays must find a pixel's visible fraction. Where they need not, `v` is the fraction; where they must, `reach`
// has the heights that the rays must search. The receiver gets a normal where one is needed.
bool is_open(ivec2 p, inout Receiver r, out float v, out Reach reach)
{
    v = 1.0;
    reach = Reach(0.0, -1.0, false, vec2(0.0), 0.0, vec4(0.0));
    if (!r.receives || !is_before_light(r.position)) {
        return false;
    }
    reach = reach_of(place_of(r), r.position.z);
    bool open = reach.start <= reach.end;
    // Most pixels need no normal.
    if (open || r.blocks) {
        r.normal = pixel_normal(p, r);
        v = part_above(r);
        // With a texture, only rays find how much of the emission lies above the plane.
        open = v > 0.0 && (open || (is_textured() && v < 1.0));
    }
    if (open && v == 1.0 && reach.whole && !looks_from_eye()) {
        Place place = place_of(r);
        if (stops_all(place, reach.from, reach.side, reach.bounds, place.w + reach.start,
                      place.w + reach.end)) {
            open = false;
            v = 0.0;
        }
    }
    return open;
}

#ifdef TEXTURED
layout(set = 0, binding = 7) uniform texture2D light_texture;

// The light's emission at a point of [0, 1]^2.
FRACTION emitted_at(vec2 s)
{
    ivec2 size = textureSize(light_texture, 0);
    ivec2 texel = clamp(ivec2(s * vec2(size)), ivec2(0), size - 1);
    vec3 color = emitted_by(texelFetch(light_texture, texel, 0));
#ifdef COLOR
    return color;
#else
    return luminance(color);
#endif
}
#endif

struct Found {
    FRACTION visible;
    int hidden;    // the number of rays that are stopped
    float heights; // the sum of the heights at which they are stopped
};

// Traces all rays of a receiver with a normal, between two heights above it.
Found found_by_rays(ivec2 p, Receiver r, float start, float end)
{
    Place place = place_of(r);
    float above = part_above(r);
    Found found = Found(FRACTION(0.0), 0, 0.0);
#ifdef TEXTURED
    FRACTION emitted = FRACTION(0.0);
    FRACTION arrived = FRACTION(0.0);
#endif
    int turns = TURNS;
    int counted = 0;
    for (; counted < rays(); ++counted) {
        vec2 s = light_sample(sampling(), is_modern(), counted, rays(), cell_rows(), uvec2(p), push.seed);
        vec2 q = 2.0 * s - 1.0;
        vec2 point = (is_disc() ? on_disc(q) : q) * push.half_light;
#ifndef FORWARD
        if (is_polygon()) {
            point = in_polygon(s);
        }
#endif
#ifdef TEXTURED
        // The texture covers the rectangle around a disc or a polygon.
        FRACTION weight = emitted_at(is_disc() || is_polygon() ? 0.5 + 0.5 * point / push.half_light : s);
#endif
        // The pixel's own surface hides this point of the light; no ray is needed.
        if (r.blocks && dot(r.normal.xy, point) <= c_of(r.normal, r.position)) {
#ifdef TEXTURED
            emitted += weight;
#endif
            continue;
        }
        Ray ray = over_map(place, Ray(slope_to(place, r.position.z, point), start, end), push.map);
        bool hit = false;
        if (ray.start <= ray.end) {
            float height;
            hit = is_linear() ? search_linear(place, ray, levels(), height)
                              : search_hierarchical(place, ray, levels(), looks_from_eye(), turns, height);
            if (turns <= 0) {
                break;
            }
            found.hidden += int(hit);
            found.heights += hit ? height : 0.0;
        }
#ifdef TEXTURED
        emitted += weight;
        arrived += hit ? FRACTION(0.0) : weight;
#endif
    }
#ifdef TEXTURED
    // The share of the emission at the rays' points; all of it where the points emit nothing.
    FRACTION nothing = FRACTION(1.0e-30);
    found.visible = (arrived + nothing) / (emitted + nothing);
#else
    found.visible = FRACTION(max(above - float(found.hidden) / float(max(counted, 1)), 0.0));
#endif
    return found;
}

#endif
