// Entry of the pass traced.tiles (src/techniques/traced/passes.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "traced/frame.glsl"
#include "traced/lists.glsl"

// Makes the shafts of each tile, and counts the leaves of the hierarchy in each: so the work of a tile is known before
// it is done. One invocation handles one tile.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 3, rgba32ui) readonly uniform uimage2D nodes;
layout(set = 0, binding = 4, std430) buffer Slots { Slot slots[]; };
layout(set = 0, binding = 5, VISIBILITY_FORMAT) writeonly uniform image2D visibility;

#include "traced/shaft.glsl"

// The turns of a tile's walks: with those of a loop over a full list, in this pass or in traced/gather.comp, fewer than the
// 65,535 after which some drivers end loops without a word.
const int MOST_TURNS = 40000;

// Counts the leaves that a shaft holds, up to one more than a list may have, and writes down the first of them, and where
// the others lie.
uint leaves_in(Shaft shaft, uint slot, inout int turns)
{
    Planes planes = planes_of(shaft);
    uint found = 0u;
    uint at = 0u;
    uvec2 others = uvec2(0u);
    while (at < frame.nodes && found <= frame.most && turns > 0) {
        Node node = node_at(at);
        bool inside = meets(planes, node);
        if (inside && node.leaf && found < FIRST_LEAVES) {
            slots[slot].leaves[found] = node.link;
        }
        found += inside && node.leaf ? 1u : 0u;
        others.x = inside && node.leaf && found == FIRST_LEAVES ? at + 1u : others.x;
        others.y = inside && node.leaf ? at + 1u : others.y;
        at = inside || node.leaf ? at + 1u : node.link;
        --turns;
    }
    slots[slot].others = others;
    // A walk that is longer than some drivers let loops be is left to rays.
    return at < frame.nodes ? frame.most + 1u : found;
}

// How far the tile's receivers are off their surfaces, pixel by pixel: a word tells a position with the depth that is
// read again, where three would leave room for few workgroups, and sixteen positions for few waves.
shared float offs[TILE_PIXELS * gl_WorkGroupSize.x * gl_WorkGroupSize.y];

uint off_at(int pixel)
{
    return uint(pixel) * (gl_WorkGroupSize.x * gl_WorkGroupSize.y) + gl_LocalInvocationIndex;
}

// The position of one of the tile's receivers.
vec3 receiver_at(ivec2 corner, int pixel)
{
    return position_of(corner + ivec2(pixel % TILE_SIDE, pixel / TILE_SIDE), offs[off_at(pixel)]);
}

// Axes of a box around receivers, as the columns of a rotation: `across` and `down` are how their places change along the
// pixels' rows and columns.
mat3 axes_of(vec3 across, vec3 down)
{
    vec3 normal = cross(across, down);
    float size = dot(normal, normal);
    bool is_plane = size > 1.0e-8 * dot(across, across) * dot(down, down) && size > 1.0e-30;
    normal = is_plane ? normal * inversesqrt(size) : vec3(0.0, 0.0, 1.0);
    vec3 first = is_plane ? normalize(across) : vec3(1.0, 0.0, 0.0);
    return mat3(first, cross(normal, first), normal);
}

// A shaft, and whether it needs no walk: its receivers lie on a flat surface that blocks, and the whole light is behind it.
struct Made {
    Shaft shaft;
    bool turned_away;
};

// Receivers lie on one plane where the height of the box around them is at most this share of its width. (With a share of
// 0.01 some boxes hold an edge between two slopes: a dozen wrong pixels in a hall.)
const float FLAT = 1.0e-3;
// A plane says little of fewer receivers.
const int PLANE_PIXELS = 8;
// The least sine of the angle at which light falls onto the plane.
const float LEAST_SINE = 0.05;

// Whether a surface has the whole light behind it, as the viewer sees it: its own triangles hide all of it. The last of the
// axes, which are a rotation, is across the surface; `units` makes lengths along z of those along x.
bool is_turned_away(vec3 middle, mat3 axes, vec3 half_size, vec3 units)
{
    vec3 normal = axes[2];
    vec3 towards = frame.towards.xyz;
    vec3 to_viewer = frame.towards.w > 0.0
        ? in_light_space(frame.eye.xyz) * units - middle
        : vec3(dot(light_x.xyz, towards), dot(light_y.xyz, towards), dot(light_z.xyz, towards)) * units;
    vec3 to_light = is_sun() ? vec3(0.0, 0.0, -units.z) : -middle;
    float behind = -dot(normal, to_light) * (dot(normal, to_viewer) < 0.0 ? -1.0 : 1.0);
    float least = LEAST_SINE * (length(to_light) + length(half_light)) + dot(abs(normal.xy), half_light);
    return half_size.z < FLAT * min(half_size.x, half_size.y) && behind > least;
}

// The shaft from some of the tile's receivers, a bit each, to the light, which faces them; `blocking` has a bit for each
// pixel whose surface blocks.
Made shaft_of(ivec2 corner, uint pixels, uint blocking)
{
    vec3 first = receiver_at(corner, max(findLSB(int(pixels)), 0));
    face_light(first);
    enter_turned_grid(int(frame.side));
    first = in_light_space(first);
    Shaft shaft = empty_shaft();
    // The box is the same whatever a metre is: its z is in cells, too.
    vec3 units = vec3(1.0, 1.0, length(light_x.xyz));
    vec3 sum = vec3(0.0);
    vec3 weighted[2] = vec3[2](vec3(0.0), vec3(0.0));
    vec3 weights = vec3(0.0);
    for (int i = 0; i < TILE_PIXELS; ++i) {
        if ((pixels >> i & 1u) != 0u) {
            vec3 p = in_light_space(receiver_at(corner, i));
            shaft = with_receiver(shaft, p, uint(i));
            vec2 at = vec2(i % TILE_SIDE, i / TILE_SIDE);
            p = (p - first) * units;
            sum += p;
            weighted[0] += at.x * p;
            weighted[1] += at.y * p;
            weights += vec3(at, 1.0);
        }
    }
    weights /= max(weights.z, 1.0);
    mat3 axes = axes_of(weighted[0] - weights.x * sum, weighted[1] - weights.y * sum);
    vec3 low = vec3(0.0);
    vec3 high = vec3(0.0);
    for (int i = 0; i < TILE_PIXELS; ++i) {
        if ((pixels >> i & 1u) != 0u) {
            vec3 p = ((in_light_space(receiver_at(corner, i)) - first) * units) * axes;
            low = min(low, p);
            high = max(high, p);
        }
    }
    mat3 sizes = mat3(abs(axes[0]), abs(axes[1]), abs(axes[2]));
    vec3 half_size = 0.5 * (high - low) + 2.0 * ROUNDING * ((offsets + abs(first)) * units * sizes + high - low);
    shaft.middle = first + axes * (0.5 * (low + high)) / units;
    shaft.across = axes[0] * half_size.x / units;
    shaft.along = axes[1] * half_size.y / units;
    shaft.over = axes[2] * half_size.z / units;
    bool is_surface = bitCount(int(pixels)) >= PLANE_PIXELS && (pixels & ~blocking) == 0u;
    return Made(shaft, is_surface && is_turned_away(shaft.middle * units, axes, half_size, units));
}

// A tile whose receivers lie further apart than this share of their distance from the viewer may be torn.
const float TEAR = 1.0 / 32.0;

// The receivers, a bit each, on the nearer side of the middle of a torn tile's longest side: one whose two groups together
// are much shorter than the whole. None of a tile that is not torn.
uint nearer_group(ivec2 corner, uint pixels, vec3 low, vec3 high)
{
    vec3 size = high - low;
    int axis = size.x >= max(size.y, size.z) ? 0 : size.y >= size.z ? 1 : 2;
    float middle = 0.5 * (low[axis] + high[axis]);
    float away = length(0.5 * (low + high) - frame.eye.xyz);
    bool may_be_torn = pixels != 0u && (size[axis] > TEAR * away || frame.towards.w == 0.0);
    vec2 near = vec2(3.0e38, -3.0e38);
    vec2 far = near;
    uint group = 0u;
    for (int i = 0; i < (may_be_torn ? TILE_PIXELS : 0); ++i) {
        float x = receiver_at(corner, i)[axis];
        bool mine = (pixels >> i & 1u) != 0u;
        if (mine && x < middle) {
            group |= 1u << i;
            near = vec2(min(near.x, x), max(near.y, x));
        } else if (mine) {
            far = vec2(min(far.x, x), max(far.y, x));
        }
    }
    bool torn = group != 0u && max(near.y - near.x, 0.0) + max(far.y - far.x, 0.0) < 0.5 * size[axis];
    return torn ? group : 0u;
}

void main()
{
    uint row = evens_first(gl_WorkGroupID.y, gl_NumWorkGroups.y) * gl_WorkGroupSize.y + gl_LocalInvocationID.y;
    ivec2 tile = ivec2(gl_GlobalInvocationID.x, row);
    ivec2 corner = tile * TILE_SIDE;
    ivec2 count = tiles_in(frame.extent);
    if (any(greaterThanEqual(tile, count))) {
        return;
    }
    face_light(vec3(0.0));
    vec3 low = vec3(3.0e38);
    vec3 high = vec3(-3.0e38);
    uint pixels = 0u;
    uint blocking = 0u;
    for (int i = 0; i < TILE_PIXELS; ++i) {
        ivec2 pixel = corner + ivec2(i % TILE_SIDE, i / TILE_SIDE);
        Receiver r = receiver_of(pixel);
        offs[off_at(i)] = r.off;
        if (r.receives) {
            low = min(low, r.position);
            high = max(high, r.position);
            pixels |= 1u << i;
            blocking |= r.blocks ? 1u << i : 0u;
        } else if (all(lessThan(pixel, frame.extent))) {
            imageStore(visibility, pixel, vec4(1.0));
        }
    }
    uint slot = SHAFTS_A_TILE * uint(tile.y * count.x + tile.x);
    uint nearer = nearer_group(corner, pixels, low, high);
    slots[slot + 1u].shaft.count = 0u;
    int turns = MOST_TURNS;
    for (uint group = 0u; group < (nearer != 0u ? 2u : 1u); ++group) {
        Made made = shaft_of(corner, group == 0u ? pixels & ~nearer : nearer, blocking);
        Shaft shaft = made.shaft;
        bool needed = shaft.pixels != 0u && !made.turned_away;
        slots[slot + group].shaft = shaft;
        if (needed) {
            slots[slot + group].shaft.count = 1u + leaves_in(shaft, slot + group, turns);
        }
        for (int i = 0; i < (made.turned_away ? TILE_PIXELS : 0); ++i) {
            if ((shaft.pixels >> i & 1u) != 0u) {
                imageStore(visibility, corner + ivec2(i % TILE_SIDE, i / TILE_SIDE), vec4(vec3(0.0), 1.0));
            }
        }
    }
}
