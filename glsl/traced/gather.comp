// Entry of the pass traced.gather (src/techniques/traced/passes.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "traced/frame.glsl"
#include "traced/lists.glsl"

// Writes the triangles that may hide some of the light from some receiver of a shaft into the shaft's list. One
// invocation handles one shaft.

layout(local_size_x = 32) in;

layout(set = 0, binding = 3, rgba32ui) readonly uniform uimage2D nodes;
layout(set = 0, binding = 4, rgba32f) readonly uniform image2D triangles;
layout(set = 0, binding = 5, std430) readonly buffer Slots { Slot slots[]; };
layout(set = 0, binding = 6, std430) buffer Entries { Head head; Entry entries[]; };
layout(set = 0, binding = 7, std430) buffer Lists { uint lists[]; };
layout(set = 0, binding = 8, VISIBILITY_FORMAT) writeonly uniform image2D visibility;

#include "traced/shaft.glsl"

// The corners of a triangle in light space, or relative to a point of it.
struct Corners {
    bool there;
    bool cut; // whether a texture says which parts of it block
    vec3 a;
    vec3 b;
    vec3 c;
};

Corners corners_of(uint triangle)
{
    vec4 a = imageLoad(triangles, texel(3u * triangle));
    vec4 b = imageLoad(triangles, texel(3u * triangle + 1u));
    vec4 c = imageLoad(triangles, texel(3u * triangle + 2u));
    return Corners(a.w > 0.0, a.w > CUT_FROM, in_light_space(a.xyz), in_light_space(b.xyz), in_light_space(c.xyz));
}

// How far a sum over the half sides of the receivers' box goes to either side.
float reach_of(vec3 along, Shaft shaft)
{
    return abs(dot(along, shaft.across)) + abs(dot(along, shaft.along)) + abs(dot(along, shaft.over));
}

// Whether a triangle may lie between a receiver of the shaft and the light: its corners are not all on the outer side of
// one of the shaft's sides, and its own plane does not have all receivers and the whole light on one side.
bool may_block(Shaft shaft, Corners t)
{
    vec3 x = vec3(t.a.x, t.b.x, t.c.x);
    vec3 y = vec3(t.a.y, t.b.y, t.c.y);
    vec3 z = vec3(t.a.z, t.b.z, t.c.z);
    vec3 left = x - (shaft.low.x + shaft.low.y * z);
    vec3 bottom = y - (shaft.low.z + shaft.low.w * z);
    vec3 right = shaft.high.x + shaft.high.y * z - x;
    vec3 top = shaft.high.z + shaft.high.w * z - y;
    vec3 inside = vec3(max(left.x, max(left.y, left.z)), max(bottom.x, max(bottom.y, bottom.z)),
                       max(right.x, max(right.y, right.z)));
    float least = min(min(inside.x, inside.y), min(inside.z, max(top.x, max(top.y, top.z))));
    vec3 size = abs(t.a) + abs(shaft.middle) + offsets;
    bool outside = least < -ROUNDING * (size.x + size.y + size.z) || min(z.x, min(z.y, z.z)) > shaft.far ||
                   (!is_sun() && max(z.x, max(z.y, z.z)) < light_end);
    vec3 normal = cross(t.b - t.a, t.c - t.a);
    float height = dot(normal, shaft.middle - t.a);
    float light = is_sun() ? -normal.z : -dot(normal, t.a);
    bool apart = abs(height) >= reach_of(normal, shaft) && abs(light) >= dot(abs(normal.xy), half_light);
    return t.there && !outside && !(apart && (height < 0.0) == (light < 0.0));
}

// What a triangle does to a shaft.
const int NOTHING = 0; // hides no sample from any receiver
const int FEW = 1;     // hides some in a few rows of samples at most from any receiver
const int MANY = 2;    // may hide any
const int ALL = 3;     // hides all samples from all receivers

// What the plane through a receiver and an edge is for a sample, dot(moment + cross(edge, receiver), sample - receiver), in
// the middle of the receivers' box and of the light, and how much more or less it may be elsewhere in them. The edge goes
// from a to b, its moment is a x b, all from the box's middle.
vec2 edge_range(vec3 moment, vec3 edge, Shaft shaft, vec3 light)
{
    mat3 turned = mat3(cross(edge, shaft.across), cross(edge, shaft.along), cross(edge, shaft.over));
    vec3 own = vec3(dot(moment, shaft.across), dot(moment, shaft.along), dot(moment, shaft.over));
    vec3 change = abs(light * turned - (is_sun() ? vec3(0.0) : own));
    change += half_light.x * abs(vec3(turned[0].x, turned[1].x, turned[2].x));
    change += half_light.y * abs(vec3(turned[0].y, turned[1].y, turned[2].y));
    return vec2(dot(light, moment), dot(half_light, abs(moment.xy)) + change.x + change.y + change.z);
}

// The i and j of a place in the light, from its middle.
vec2 turned(vec2 p)
{
    return (p + turn * vec2(-p.y, p.x)) / (1.0 + turn * turn);
}

// How many rows of samples traced/cover.glsl looks at for a triangle that hides some in a few of them; one less where it
// looks at pairs, and the first of them may be the one before. With 32 rows of samples it looks at all.
float few_rows(int side)
{
    return side == 8 ? 2.0 : side == 16 ? 3.0 : 0.0;
}

// The least and largest of where a corner, which is `away` steps of the grid from the box's middle, is seen in the light by
// the box's receivers, less where that middle is; `shares` are how much further away it is there for the furthest and the
// nearest receiver, and `half_size` is half the box's size.
vec2 seen_at(float away, vec2 shares, float half_size)
{
    vec2 ends = away * shares;
    float shift = is_sun() ? half_size * shares.y : half_size * max(abs(1.0 - shares.x), abs(1.0 - shares.y));
    return vec2(min(ends.x, ends.y) - shift, max(ends.x, ends.y) + shift);
}

// How much of the grid two corners may be apart, as any receiver sees them.
float seen_apart(float a, float b, float share_a, float share_b, float half_size)
{
    return abs(a - b) * share_a + (abs(b) + half_size) * abs(share_b - share_a);
}

// The part of the light that a triangle may hide which passed may_block.
int part_hidden(Shaft shaft, Corners t)
{
    vec3 z = vec3(t.a.z, t.b.z, t.c.z);
    float nearest = min(z.x, min(z.y, z.z));
    float furthest = max(z.x, max(z.y, z.z));
    vec3 a = t.a - shaft.middle;
    vec3 b = t.b - shaft.middle;
    vec3 c = t.c - shaft.middle;
    vec3 light = is_sun() ? vec3(0.0, 0.0, -1.0) : -shaft.middle;
    vec3 normal = cross(b - a, c - a);
    float height = -dot(normal, a);
    float over = is_sun() ? -normal.z : dot(normal, light - a);
    // More than these products of coordinates round, and than the coordinates do.
    vec3 size = max(max(abs(a), abs(b)), abs(c));
    vec3 products = 4.0 * size.yzx * size.zxy + 2.0 * (size.yzx * offsets.zxy + size.zxy * offsets.yzx);
    float rounding = ROUNDING * dot(size + abs(light) + vec3(half_light, 0.0), products);
    float free = abs(height) - reach_of(normal, shaft);
    // All samples are on the outer side of an edge for all receivers, or on the inner side of each.
    float side = height > 0.0 ? -1.0 : 1.0;
    vec2 first = edge_range(cross(a, b), b - a, shaft, light);
    vec2 second = edge_range(cross(b, c), c - b, shaft, light);
    vec2 third = edge_range(cross(c, a), a - c, shaft, light);
    vec3 middle = side * vec3(first.x, second.x, third.x);
    vec3 change = vec3(first.y, second.y, third.y) + rounding;
    bool none = free >= 0.0 && any(lessThan(middle, -change));
    bool between = furthest < shaft.near && (is_sun() || nearest >= light_end);
    bool opposite = free > rounding && abs(over) > dot(abs(normal.xy), half_light) + rounding &&
                    (height < 0.0) != (over < 0.0);
    bool all_hidden = between && opposite && !t.cut && all(greaterThan(middle, change));
    // Where the corners are seen in the light, in steps of the grid. Samples are at whole steps; a triangle that spans none
    // in x or in y hides none.
    const float MARGIN = 1.0 / 64.0;
    vec2 seen_a = turned(a.xy);
    vec2 seen_b = turned(b.xy);
    vec2 seen_c = turned(c.xy);
    vec2 half_size = abs(turned(shaft.across.xy)) + abs(turned(shaft.along.xy)) + abs(turned(shaft.over.xy));
    vec3 at_nearest = (is_sun() ? 1.0 : shaft.near) / (shaft.near - z);
    vec3 at_furthest = (is_sun() ? 1.0 : shaft.far) / (shaft.far - z);
    vec2 base = (is_sun() ? vec2(0.0) : turned(shaft.middle.xy)) + (0.5 * float(frame.side) - 0.5);
    vec2 low;
    vec2 high;
    for (int axis = 0; axis < 2; ++axis) {
        vec2 a_at = seen_at(seen_a[axis], vec2(at_furthest.x, at_nearest.x), half_size[axis]);
        vec2 b_at = seen_at(seen_b[axis], vec2(at_furthest.y, at_nearest.y), half_size[axis]);
        vec2 c_at = seen_at(seen_c[axis], vec2(at_furthest.z, at_nearest.z), half_size[axis]);
        low[axis] = base[axis] + min(a_at.x, min(b_at.x, c_at.x));
        high[axis] = base[axis] + max(a_at.y, max(b_at.y, c_at.y));
    }
    none = none || (between && any(lessThan(floor(high + MARGIN), low - MARGIN)));
    // How many rows of samples.
    float most = max(max(seen_apart(seen_a.y, seen_b.y, at_nearest.x, at_nearest.y, half_size.y),
                         seen_apart(seen_b.y, seen_c.y, at_nearest.y, at_nearest.z, half_size.y)),
                     seen_apart(seen_c.y, seen_a.y, at_nearest.z, at_nearest.x, half_size.y));
    bool few = between && most < few_rows(int(frame.side)) - 2.0 * MARGIN;
    return none ? NOTHING : all_hidden ? ALL : few ? FEW : MANY;
}

void main()
{
    uint groups = (head.shafts + gl_WorkGroupSize.x - 1u) / gl_WorkGroupSize.x;
    uint nth = evens_first(nth_group(gl_WorkGroupID.xy), groups) * gl_WorkGroupSize.x + gl_LocalInvocationIndex;
    if (nth >= head.shafts) {
        return;
    }
    uint slot = entries[nth].slot;
    uint first = entries[nth].first;
    Shaft shaft = slots[slot].shaft;
    ivec2 corner = corner_of(slot);
    face_light(shaft.pixels, corner);
    enter_turned_grid(int(frame.side));
    Planes planes = planes_of(shaft);
    // First the leaves: a turn of a walk costs all that it may do, so that the triangles come after it. The first of them
    // are known. They have the second half of the room for their triangles.
    uint most = shaft.count - 1u;
    uint leaves = min(most, FIRST_LEAVES);
    uint behind = first + most * (LEAF - 1u);
    for (uint i = 0u; i < leaves; ++i) {
        lists[behind + i] = slots[slot].leaves[i];
    }
    uvec2 others = slots[slot].others;
    uint at = most > FIRST_LEAVES ? others.x : others.y;
    // Another compiler's rounding must not find more leaves than there is room for.
    while (at < others.y && leaves < most) {
        Node node = node_at(at);
        bool inside = meets(planes, node);
        if (inside && node.leaf) {
            lists[behind + leaves] = node.link;
            leaves += 1u;
        }
        at = inside || node.leaf ? at + 1u : node.link;
    }
    // Then those of their triangles that may block, from the front: none takes the place of a leaf that is still to be read.
    uint end = 0u;
    for (uint i = 0u; i < leaves * LEAF; ++i) {
        uint triangle = lists[behind + i / LEAF] * LEAF + i % LEAF;
        if (may_block(shaft, corners_of(triangle))) {
            lists[first + end] = triangle;
            end += 1u;
        }
    }
    // Then what they hide. Those that span a few rows of samples stay in front, the others go to the end, and the last of
    // them take the places of those that hide nothing.
    uint few = 0u;
    uint many_from = end;
    uint crossing = 0u;
    bool hidden = false;
    while (few < many_from && !hidden) {
        uint triangle = lists[first + few];
        Corners t = corners_of(triangle);
        int part = part_hidden(shaft, t);
        crossing |= part != NOTHING && !is_sun() && min(t.a.z, min(t.b.z, t.c.z)) < light_end ? 1u : 0u;
        hidden = part == ALL;
        many_from -= part == FEW ? 0u : 1u;
        uint unread = lists[first + many_from];
        if (part == NOTHING) {
            end -= 1u;
            lists[first + many_from] = lists[first + end];
        } else if (part != FEW) {
            lists[first + many_from] = triangle;
        }
        if (part == FEW) {
            few += 1u;
        } else if (few < many_from) {
            lists[first + few] = unread;
        }
    }
    uint many = end - many_from;
    bool shadowed = few + many > 0u && !hidden;
    if (shadowed) {
        uint place = atomicAdd(head.shadowed, 1u);
        uvec2 groups = groups_as_far_as(place);
        atomicMax(head.groups[0], groups.x);
        atomicMax(head.groups[1], groups.y);
        entries[slots_in(frame.extent) + place] = Entry(slot, first, few, first + many_from, many, crossing);
    }
    for (int i = 0; i < (shadowed ? 0 : TILE_PIXELS); ++i) {
        if ((shaft.pixels >> i & 1u) != 0u) {
            imageStore(visibility, corner + ivec2(i % TILE_SIDE, i / TILE_SIDE), vec4(vec3(hidden ? 0.0 : 1.0), 1.0));
        }
    }
}
