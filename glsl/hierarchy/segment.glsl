// Entered from traced/rays.comp.
//
// Whether anything blocks a segment: the one function that a device with ray queries would answer by itself. The including
// shader declares `nodes`, `triangles` and ROUNDING, the rounding of the arithmetic on positions as a share of their size.

#ifndef HIERARCHY_SEGMENT_GLSL
#define HIERARCHY_SEGMENT_GLSL

#include "hierarchy/tree.glsl"

#ifdef CUT
#include "hierarchy/cut.glsl"

// A number for each ray, spread evenly over 0..1 among the rays of a receiver.
vec2 ray_number;
#endif

// A segment, and what is the same for all nodes that it meets.
struct Segment {
    vec3 from;
    vec3 along;
    float ends;    // 1 for a segment, which ends at from + along; 0 for a ray
    vec3 in_steps; // `from` in steps of the root's box
    vec3 inverse;  // 1 over `along` in steps
};

Segment segment_of(vec3 from, vec3 along, bool ends)
{
    vec3 step = root_step();
    vec3 d = along / step;
    // Along a plane of boxes it leaves none of them through that plane.
    d = mix(d, vec3(1.0e-30), lessThan(abs(d), vec3(1.0e-30)));
    return Segment(from, along, ends ? 1.0 : 0.0, (from - root_low()) / step, 1.0 / d);
}

bool meets(Segment s, Node node)
{
    vec3 a = (node.low - s.in_steps) * s.inverse;
    vec3 b = (node.high - s.in_steps) * s.inverse;
    vec3 enter = min(a, b);
    vec3 leave = max(a, b);
    float first = max(max(enter.x, enter.y), max(enter.z, 0.0));
    float last = min(min(leave.x, leave.y), leave.z);
    return first <= last * (1.0 + 4.0 * ROUNDING) && first * s.ends <= 1.0;
}

// On which side of an edge a direction passes: twice dot(cross(p, q), d). It has the other sign, to the bit, for the other
// triangle of the edge, and is rounded by the edge's length, not by its distance.
float edge_side(vec3 p, vec3 q, vec3 d)
{
    return dot(cross(p + q, q - p), d);
}

// Whether a triangle blocks the segment, as traced/cover.glsl has it for all samples at once.
bool crosses(Segment s, uint triangle)
{
    vec4 corner = imageLoad(triangles, texel(3u * triangle));
    vec3 a = corner.xyz - s.from;
    vec3 b = imageLoad(triangles, texel(3u * triangle + 1u)).xyz - s.from;
    vec3 c = imageLoad(triangles, texel(3u * triangle + 2u)).xyz - s.from;
    vec3 normal = cross(b - a, c - a);
    float volume = dot(normal, a);
    float side = volume < 0.0 ? -1.0 : 1.0;
    vec3 edges = vec3(edge_side(a, b, s.along), edge_side(b, c, s.along), edge_side(c, a, s.along)) * side;
    float inside = min(min(edges.x, edges.y), edges.z);
    float reach = dot(normal, s.along) * side;
    vec3 size = max(max(abs(a), abs(b)), abs(c)) + abs(s.from);
    float sharp = 0.5 * ROUNDING * length(normal) * (size.x + size.y + size.z);
    bool hit = corner.w > 0.0 && inside >= 0.0 && reach * s.ends >= abs(volume) * s.ends && abs(volume) > sharp;
#ifdef CUT
    if (hit && corner.w > CUT_FROM) {
        // Each edge's side is the share of the corner across from it.
        hit = stops(cut_of(triangle), edges.yzx, even_number(ray_number, triangle >> 1u));
    }
#endif
    return hit;
}

// Whether any triangle blocks the segment. Each turn of a loop takes one from `turns`; where none is left nothing more is
// found, and `turns` is 0.
bool blocked(Segment s, uint node_count, inout int turns)
{
    bool hit = false;
    uint at = 0u;
    while (at < node_count && !hit && turns > 0) {
        // Up to four leaves are collected before their triangles are tested: a turn of the walk costs all that it may do.
        uvec4 leaves = uvec4(0u);
        int count = 0;
        while (at < node_count && count < 4 && turns > 0) {
            Node node = node_at(at);
            bool inside = meets(s, node);
            bool found = inside && node.leaf;
            leaves = found ? uvec4(node.link, leaves.xyz) : leaves;
            count += found ? 1 : 0;
            at = inside || node.leaf ? at + 1u : node.link;
            --turns;
        }
        for (int i = 0; i < count * int(LEAF) && !hit; ++i) {
            hit = crosses(s, leaves.x * LEAF + uint(i) % LEAF);
            leaves = uint(i) % LEAF == LEAF - 1u ? leaves.yzww : leaves;
            --turns;
        }
    }
    return hit;
}

#endif
