// Entry of the pass traced.gather (src/techniques/traced/passes.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "traced/frame.glsl"
#include "traced/lists.glsl"

// Writes the triangles that may hide some of the light from some receiver of a shaft into the shaft's list. One
// invocation handles one shaft.

layout(local_size_x = 64) in;

layout(set = 0, binding = 3, rgba32ui) readonly uniform uimage2D nodes;
layout(set = 0, binding = 4, rgba32f) readonly uniform image2D triangles;
layout(set = 0, binding = 5, std430) readonly buffer Slots { Slot slots[]; };
layout(set = 0, binding = 6, std430) buffer Entries { uint shaft_count; uint dense_count; Entry entries[]; };
layout(set = 0, binding = 7, std430) buffer Lists { uint lists[]; };
layout(set = 0, binding = 8, r32f) writeonly uniform image2D visibility;

#include "traced/shaft.glsl"

// Whether a triangle may lie between a receiver of the shaft and the light: its corners are not all on the outer side of
// one of the shaft's sides, and its own plane does not have all receivers and the whole light on one side.
bool may_block(Shaft shaft, vec3 a, vec3 b, vec3 c)
{
    vec3 x = vec3(a.x, b.x, c.x);
    vec3 y = vec3(a.y, b.y, c.y);
    vec3 z = vec3(a.z, b.z, c.z);
    vec3 left = x - (shaft.low.x + shaft.low.y * z);
    vec3 bottom = y - (shaft.low.z + shaft.low.w * z);
    vec3 right = shaft.high.x + shaft.high.y * z - x;
    vec3 top = shaft.high.z + shaft.high.w * z - y;
    vec3 inside = vec3(max(left.x, max(left.y, left.z)), max(bottom.x, max(bottom.y, bottom.z)),
                       max(right.x, max(right.y, right.z)));
    float least = min(min(inside.x, inside.y), min(inside.z, max(top.x, max(top.y, top.z))));
    float slack = ROUNDING * (dot(abs(a), vec3(1.0)) + dot(abs(shaft.most), vec3(1.0)));
    if (least < -slack || min(z.x, min(z.y, z.z)) > shaft.most.z) {
        return false;
    }
    if (!is_sun() && max(z.x, max(z.y, z.z)) < light_end()) {
        return false;
    }
    vec3 normal = cross(b - a, c - a);
    vec3 middle = 0.5 * (shaft.least + shaft.most) - a;
    vec3 half_size = 0.5 * (shaft.most - shaft.least);
    float height = dot(normal, middle);
    float spread = dot(abs(normal), half_size);
    float light = is_sun() ? -normal.z : -dot(normal, a);
    float reach = dot(abs(normal.xy), half_light);
    bool above = height >= spread && light >= reach;
    bool below = height <= -spread && light <= -reach;
    return !(above || below);
}

void main()
{
    uint nth = nth_group(gl_WorkGroupID.xy) * gl_WorkGroupSize.x + gl_LocalInvocationIndex;
    if (nth >= shaft_count) {
        return;
    }
    uint slot = entries[nth].slot;
    uint first = entries[nth].first;
    Shaft shaft = slots[slot].shaft;
    ivec2 corner = corner_of(slot);
    face_light(shaft.pixels, corner);
    Planes planes = planes_of(shaft);
    // First the leaves: a turn of a walk costs all that it may do, so that the triangles come after it. Most shafts have few,
    // which are known.
    uint leaves = shaft.count - 1u;
    if (leaves <= FIRST_LEAVES) {
        for (uint i = 0u; i < leaves; ++i) {
            lists[first + i] = slots[slot].leaves[i];
        }
    } else {
        uint at = 0u;
        leaves = 0u;
        while (at < frame.nodes) {
            Node node = node_at(at);
            bool inside = meets(planes, node);
            if (inside && node.leaf) {
                lists[first + leaves] = node.link;
                leaves += 1u;
            }
            at = inside || node.leaf ? at + 1u : node.link;
        }
    }
    // Then their triangles, behind the leaves: those that cross the light's plane from the end of the list's room on
    // backwards.
    uint room = leaves * (LEAF + 1u);
    uint plain = 0u;
    uint crossing = 0u;
    for (uint i = 0u; i < leaves * LEAF; ++i) {
        uint triangle = lists[first + i / LEAF] * LEAF + i % LEAF;
        vec4 a = imageLoad(triangles, texel(3u * triangle));
        vec4 b = imageLoad(triangles, texel(3u * triangle + 1u));
        vec4 c = imageLoad(triangles, texel(3u * triangle + 2u));
        vec3 la = in_light_space(a.xyz);
        vec3 lb = in_light_space(b.xyz);
        vec3 lc = in_light_space(c.xyz);
        bool crosses = !is_sun() && min(la.z, min(lb.z, lc.z)) < light_end();
        if (a.w > 0.0 && may_block(shaft, la, lb, lc)) {
            lists[first + (crosses ? room - 1u - crossing : leaves + plain)] = triangle;
            plain += crosses ? 0u : 1u;
            crossing += crosses ? 1u : 0u;
        }
    }
    entries[nth] = Entry(slot, first, first + leaves, plain, first + room - crossing, crossing);
    // Nothing is between the light and the receivers of an empty shaft.
    for (int i = 0; i < (plain + crossing == 0u ? TILE_PIXELS : 0); ++i) {
        if ((shaft.pixels >> i & 1u) != 0u) {
            imageStore(visibility, corner + ivec2(i % TILE_SIDE, i / TILE_SIDE), vec4(1.0));
        }
    }
}
