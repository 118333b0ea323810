// Entered from traced/tiles.comp, traced/gather.comp, traced/cover.comp and traced/rays.comp.
//
// What all passes of the technique share: the frame's constants, its receivers, and tiles of 4x4 pixels.
//
// Positions are in the hierarchy's space: world axes, metres, from a point near the occluders. Light space is as in
// common/light_space.glsl; a sun's z runs along its light from the same point, and its half-extents are tangents.

#ifndef TRACED_FRAME_GLSL
#define TRACED_FRAME_GLSL

// A light that shines to one side; one without a place; one that shines to all sides, and shows each receiver the disc or
// the stadium that faces it.
const uint LAMP = 0u;
const uint SUN = 1u;
const uint ROUND = 2u;

struct Frame {
    mat4 eye_from_ndc;  // normalized device coordinates to the hierarchy's space, relative to `eye`
    vec4 light_x;       // a point's x, y and z in light space, each as a plane
    vec4 light_y;
    vec4 light_z;
    vec2 half_light;    // half the light's width and height, m; for a sun the tangents of half its angular size
    float background;   // the depth of a pixel that shows no surface
    float depth_step;   // how far a pixel's depth may be from the surface's: a share of it where above 0, else this
                        // much below 0
    vec4 eye;           // the viewer; for an orthographic camera a point of its near plane
    vec4 towards;       // the direction towards the viewer of an orthographic camera; w is 1 for a perspective
    ivec2 extent;       // the G-buffer's width and height
    uint masked;        // 1 where the G-buffer has a mask of roles
    uint kind;          // LAMP, SUN or ROUND
    uint nodes;         // how many nodes the hierarchy has
    uint most;          // the most leaves that a shaft may hold
    float snap;         // how much coarser than 8 bits the grid is that a raster moves vertices to, in pixels
    uint samples;       // rays that a pixel of a dense shaft sends
    float weight;       // the sum of the samples' weights; 0 where all weigh the same
    uint side;          // samples along a side of the light: 8, 16 or 32
    uint weights[128];  // the weights of 8x8 samples, or of 16x16 with one for four of 32x32: 16 bits each, row by row
};

layout(set = 0, binding = 0) uniform texture2D gbuffer_depth;
layout(set = 0, binding = 1) uniform texture2D gbuffer_mask;
layout(set = 0, binding = 2, std430) readonly buffer Constants { Frame frame; };

// Pixels along a tile's sides.
const int TILE_SIDE = 4;
const int TILE_PIXELS = TILE_SIDE * TILE_SIDE;

// Shafts a tile: its receivers may lie in two groups, one behind the other.
const uint SHAFTS_A_TILE = 2u;

// With `#define TEXTURED` samples count for what the light's texture emits around them (traced/emission.comp), by color; with
// `#define COLOR` too there is a visible fraction of each color.
#ifdef TEXTURED
#define SUM vec3
#define WEIGHED true
layout(set = 0, binding = 8) uniform texture2D emission;
#else
#define SUM float
#define WEIGHED (frame.weight > 0.0)
#endif

#ifdef COLOR
#define VISIBILITY_FORMAT rgba32f
#else
#define VISIBILITY_FORMAT r32f
#endif

// What the nth sample of a light with `side` of them along a side counts for; see `weights`.
SUM weight_of(int nth, int side)
{
    ivec2 at = ivec2(nth % side, nth / side);
    int place = side == 32 ? (at.y >> 1) * 16 + (at.x >> 1) : nth;
    float share = frame.weight > 0.0 ? float(frame.weights[place >> 1] >> 16 * (place & 1) & 0xffffu) : 1.0;
#ifdef TEXTURED
    return share * texelFetch(emission, at, 0).rgb;
#else
    return share;
#endif
}

// The texel of the visible fraction where samples are seen that count for `seen` of `all`; a light that emits nothing is
// visible.
vec4 fraction_of(SUM seen, SUM all)
{
#ifdef TEXTURED
    return vec4(mix(seen / max(all, 1.0e-37), vec3(1.0), equal(all, vec3(0.0))), 1.0);
#else
    return vec4(vec3(all > 0.0 ? seen / all : 1.0), 1.0);
#endif
}

ivec2 tiles_in(ivec2 extent)
{
    return (extent + TILE_SIDE - 1) / TILE_SIDE;
}

// The slots for the shafts of an image.
uint slots_in(ivec2 extent)
{
    ivec2 tiles = tiles_in(extent);
    return SHAFTS_A_TILE * uint(tiles.x * tiles.y);
}

struct Receiver {
    bool receives;
    bool blocks;   // its own surface blocks light
    float off;     // how far it is moved towards the viewer, off the surface that the depth tells
    vec3 position; // the hierarchy's space
    vec3 in_light; // light space
};

// The rounding of the arithmetic on positions, as a share of their size.
const float ROUNDING = 1.0 / 4194304.0;

// The light as the receivers at hand see it: light space, and half the light's width and height.
vec4 light_x;
vec4 light_y;
vec4 light_z;
vec2 half_light;

// How far before the light's plane segments to it end, in metres: what lies in that plane does not block.
float light_end;

vec3 in_light_space(vec3 p)
{
    vec4 q = vec4(p, 1.0);
    return vec3(dot(light_x, q), dot(light_y, q), dot(light_z, q));
}

bool is_sun()
{
    return frame.kind == SUN;
}

// Turns light space towards a point: that of a round light has its z towards it; its x lies along a capsule.
void turn_light(vec3 about)
{
    vec3 to = in_light_space(about);
    float radius = half_light.y;
    bool capsule = half_light.x > half_light.y;
    vec3 z = normalize(capsule ? vec3(0.0, to.yz) : to + vec3(0.0, 0.0, 1.0e-30));
    // Axes that turn with z, without a jump but opposite to the light's own (Duff and others 2017).
    float pole = z.z < -0.9999 ? -0.9999 : z.z;
    float share = -z.x * z.y / (1.0 + pole);
    vec3 x = capsule ? vec3(1.0, 0.0, 0.0) : normalize(vec3(1.0 - z.x * z.x / (1.0 + pole), share, -z.x));
    vec3 y = cross(z, x);
    mat3x4 rows = mat3x4(light_x, light_y, light_z);
    light_x = rows * x;
    light_y = rows * y;
    light_z = rows * z;
    // The disc that fills a sphere's cone lies in the plane of its centre.
    float away = dot(to, to);
    if (!capsule) {
        half_light *= sqrt(away / max(away - radius * radius, 1.0e-6 * away));
    }
}

// Sets light space for receivers about a point.
void face_light(vec3 about)
{
    light_x = frame.light_x;
    light_y = frame.light_y;
    light_z = frame.light_z;
    half_light = frame.half_light;
    if (frame.kind == ROUND) {
        turn_light(about);
    }
    vec3 away = abs(vec3(light_x.w, light_y.w, light_z.w));
    light_end = 32.0 * ROUNDING * (max(away.x, max(away.y, away.z)) + max(half_light.x, half_light.y));
}

// From here on light space is grid space: the cells of an n by n grid over the light are the units of its x and y, z is as it
// was. A lamp's samples lie in its plane z = 0, and segments to a sun's go along (x, y, -1).
void enter_grid(int side)
{
    vec2 size = max(half_light, max(max(half_light.x, half_light.y) * 1.0e-4, light_end));
    light_x *= 0.5 * float(side) / size.x;
    light_y *= 0.5 * float(side) / size.y;
}

// Whether a point lies within a round light, which hides nothing of itself.
bool in_light(vec3 p)
{
    vec3 to = vec3(dot(frame.light_x, vec4(p, 1.0)), dot(frame.light_y, vec4(p, 1.0)), dot(frame.light_z, vec4(p, 1.0)));
    to.x -= clamp(to.x, frame.half_light.y - frame.half_light.x, frame.half_light.x - frame.half_light.y);
    return dot(to, to) <= frame.half_light.y * frame.half_light.y;
}

// The most that a surface's distance counts as changing from a pixel to the next, in pixels.
const float STEEP = 8.0;

// How much the depth changes from a pixel to the next along an axis: by more of the two sides where they are of one
// surface, else by less.
float slope_along(ivec2 pixel, float depth, ivec2 axis)
{
    ivec2 last = frame.extent - 1;
    float before = abs(texelFetch(gbuffer_depth, clamp(pixel - axis, ivec2(0), last), 0).x - depth);
    float after = abs(texelFetch(gbuffer_depth, clamp(pixel + axis, ivec2(0), last), 0).x - depth);
    float less = min(before, after);
    float more = max(before, after);
    return more < 4.0 * less ? more : less;
}

// The place of a depth in a pixel, in homogeneous coordinates from the viewer.
vec4 place_of(ivec2 pixel, float depth)
{
    vec2 ndc = (vec2(pixel) + 0.5) * 2.0 / vec2(frame.extent) - 1.0;
    vec4 at_zero = frame.eye_from_ndc * vec4(ndc, 0.0, 1.0);
    return at_zero + frame.eye_from_ndc[2] * depth;
}

// The direction from a place, from the viewer, towards the viewer.
vec3 towards_viewer(vec3 from_eye)
{
    return frame.towards.w > 0.0 ? -normalize(from_eye) : frame.towards.xyz;
}

// The position of a pixel's receiver that is moved so far off its surface.
vec3 position_of(ivec2 pixel, float off)
{
    vec4 p = place_of(pixel, texelFetch(gbuffer_depth, pixel, 0).x);
    vec3 from_eye = p.xyz / p.w;
    return frame.eye.xyz + from_eye + towards_viewer(from_eye) * off;
}

// The receiver of a pixel, moved towards the viewer by as much as its depth and its position may be off: so it lies on
// the viewer's side of its own surface.
Receiver receiver_of(ivec2 pixel)
{
    Receiver r = Receiver(false, false, 0.0, vec3(0.0), vec3(0.0));
    if (any(greaterThanEqual(pixel, frame.extent))) {
        return r;
    }
    float depth = texelFetch(gbuffer_depth, pixel, 0).x;
    float role = frame.masked != 0u ? texelFetch(gbuffer_mask, pixel, 0).x : 1.0;
    if (depth == frame.background || role <= 0.25) {
        return r;
    }
    vec4 p = place_of(pixel, depth);
    vec3 from_eye = p.xyz / p.w;
    float step = frame.depth_step > 0.0 ? frame.depth_step * depth : -frame.depth_step;
    vec4 q = p + frame.eye_from_ndc[2] * (frame.background == 0.0 ? step : -step);
    vec3 moved = from_eye - q.xyz / q.w;
    vec3 size = abs(frame.eye.xyz) + abs(from_eye);
    // A raster that moves vertices, by half a step of its grid at most, moves the surface: by as much as the depth changes
    // over that, but no more than it does on a surface whose distance changes by STEEP pixels a pixel.
    float slope = slope_along(pixel, depth, ivec2(1, 0)) + slope_along(pixel, depth, ivec2(0, 1));
    vec4 sloped = p + frame.eye_from_ndc[2] * (frame.background == 0.0 ? slope : -slope);
    float footprint = length(frame.eye_from_ndc[0].xyz) * 2.0 / (float(frame.extent.x) * abs(p.w));
    float rise = min(length(from_eye - sloped.xyz / sloped.w), STEEP * footprint);
    float snapped = 0.5 * frame.snap * rise;
    // What rounds in any direction must not be more than how far the move takes the receiver off a surface that it is seen
    // on grazingly; otherwise a sheet that is lit from behind hides nothing from itself.
    float grazing = length(vec2(1.0, rise / max(footprint, 1.0e-30)));
    float off = snapped + 2.0 * length(moved) + 8.0 * ROUNDING * max(max(size.x, size.y), size.z) * grazing;
    r.blocks = role > 0.75;
    r.off = off;
    r.position = frame.eye.xyz + from_eye + towards_viewer(from_eye) * off;
    r.in_light = in_light_space(r.position);
    // At the plane of a lamp and behind it there is nothing to hide, nor within a round light.
    r.receives = is_sun() || (frame.kind == ROUND ? !in_light(r.position) : r.in_light.z > 2.0 * off + light_end);
    return r;
}

// Sets light space for the receivers of some pixels, a bit each, of the tile whose first pixel is `corner`.
void face_light(uint pixels, ivec2 corner)
{
    int first = findLSB(int(pixels));
    Receiver r = Receiver(false, false, 0.0, vec3(0.0), vec3(0.0));
    if (frame.kind == ROUND && first >= 0) {
        r = receiver_of(corner + ivec2(first % TILE_SIDE, first / TILE_SIDE));
    }
    face_light(r.position);
}

// The first pixel of a slot's tile.
ivec2 corner_of(uint slot)
{
    int tile = int(slot / SHAFTS_A_TILE);
    int across = tiles_in(frame.extent).x;
    return ivec2(tile % across, tile / across) * TILE_SIDE;
}

#endif
