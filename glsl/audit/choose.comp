// Entry of the pass audit.choose (src/audit/passes.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "traced/frame.glsl"
#include "hierarchy/tree.glsl"
#include "audit/candidates.glsl"
#include "audit/light.glsl"

// Chooses a random pixel of each cell of the image, and says whether it may be in shadow: by the technique, which wrote so,
// or by the truth, where a triangle reaches into the pyramid between the pixel and the light. One invocation handles one
// cell.

layout(local_size_x = 64) in;

layout(set = 0, binding = 3, rgba32ui) readonly uniform uimage2D nodes;
layout(set = 0, binding = 4, std430) readonly buffer Header { vec4 root_low; vec4 root_step; };
layout(set = 0, binding = 5, r32f) readonly uniform image2D visibility;
layout(set = 0, binding = 6, rgba32f) readonly uniform image2D triangles;
layout(set = 0, binding = 7, std430) readonly buffer Number { uint frame_number; uint light_index; };
layout(set = 0, binding = 8, std430) writeonly buffer Candidates { uvec4 candidates[]; };

// The turns of all loops of an invocation: some drivers end loops without a word after 65,535 of them.
const int MOST_TURNS = 60000;

// The pyramid between a receiver and a figure, in the hierarchy's space about the receiver. What lies outside of one of
// the planes hides nothing.
struct Pyramid {
    vec3 tip;
    vec3 side[4]; // normals of planes through the tip; the inside is where they point
    vec3 normal;  // the figure's plane: the inside is where dot(normal, p) >= base
    float base;
    vec3 corner[4];
};

// How much wider than it is the pyramid may be for the arithmetic's rounding, along a plane's normal.
float slack(vec3 normal, vec3 size)
{
    return 8.0 * ROUNDING * dot(abs(normal), size);
}

Pyramid pyramid_of(vec3 tip, Figure f)
{
    Pyramid p;
    p.tip = tip;
    vec3 middle = f.base - tip;
    // A line or a point has no pyramid of its own; one that is a little wider holds it.
    float least = 1.0e-3 * length(middle);
    vec3 u = f.u * max(f.half_size.x, least);
    vec3 v = f.v * max(f.half_size.y, least);
    p.corner = vec3[4](middle - u - v, middle + u - v, middle + u + v, middle - u + v);
    for (int i = 0; i < 4; ++i) {
        vec3 n = cross(p.corner[i], p.corner[i + 1 & 3]);
        p.side[i] = normalize(dot(n, middle) < 0.0 ? -n : n);
    }
    p.normal = f.normal;
    p.base = push.kind == SUN ? -3.0e38 : dot(f.normal, middle);
    return p;
}

// Whether a box, about the tip, may reach into the pyramid; `size` bounds the coordinates that it was made from.
bool reaches(Pyramid p, vec3 low, vec3 high, vec3 size)
{
    bool inside = true;
    for (int i = 0; i < 4; ++i) {
        vec3 furthest = max(p.side[i] * low, p.side[i] * high);
        inside = inside && furthest.x + furthest.y + furthest.z >= -slack(p.side[i], size);
    }
    vec3 furthest = max(p.normal * low, p.normal * high);
    return inside && furthest.x + furthest.y + furthest.z >= p.base - slack(p.normal, size);
}

// Whether a triangle may hide any of the figure from the tip.
bool may_hide(Pyramid p, uint triangle, vec3 size)
{
    vec4 first = imageLoad(triangles, texel(3u * triangle));
    vec3 a = first.xyz - p.tip;
    vec3 b = imageLoad(triangles, texel(3u * triangle + 1u)).xyz - p.tip;
    vec3 c = imageLoad(triangles, texel(3u * triangle + 2u)).xyz - p.tip;
    bool inside = first.w > 0.0;
    for (int i = 0; i < 4; ++i) {
        float furthest = max(max(dot(p.side[i], a), dot(p.side[i], b)), dot(p.side[i], c));
        inside = inside && furthest >= -slack(p.side[i], size);
    }
    float furthest = max(max(dot(p.normal, a), dot(p.normal, b)), dot(p.normal, c));
    inside = inside && furthest >= p.base - slack(p.normal, size);
    // A triangle's plane with the tip and the whole figure on one side hides nothing: the pixel's own surface mostly.
    vec3 n = cross(b - a, c - a);
    float allowed = slack(n, size);
    float of_tip = -dot(n, a);
    vec4 of_corners = vec4(0.0);
    for (int i = 0; i < 4; ++i) {
        of_corners[i] = of_tip + dot(n, p.corner[i]);
    }
    float least = min(min(of_corners.x, of_corners.y), min(of_corners.z, of_corners.w));
    float most = max(max(of_corners.x, of_corners.y), max(of_corners.z, of_corners.w));
    bool before = of_tip >= -allowed && least >= allowed;
    bool behind = of_tip <= allowed && most <= -allowed;
    return inside && !before && !behind;
}

bool may_be_shadowed(Pyramid p)
{
    vec3 size = abs(p.tip) + abs(root_low.xyz) + 65535.0 * root_step.xyz;
    vec3 from = root_low.xyz - p.tip;
    bool found = false;
    uint at = 0u;
    int turns = MOST_TURNS;
    while (at < frame.nodes && !found && turns > 0) {
        // As in hierarchy/segment.glsl, leaves are collected before their triangles are tested.
        uvec4 leaves = uvec4(0u);
        int count = 0;
        while (at < frame.nodes && count < 4 && turns > 0) {
            Node node = unpacked_node(imageLoad(nodes, texel(at)));
            bool inside =
                reaches(p, from + root_step.xyz * node.low, from + root_step.xyz * node.high, size);
            bool leaf = inside && node.leaf;
            leaves = leaf ? uvec4(node.link, leaves.xyz) : leaves;
            count += leaf ? 1 : 0;
            at = inside || node.leaf ? at + 1u : node.link;
            --turns;
        }
        for (int i = 0; i < count * int(LEAF) && !found; ++i) {
            found = may_hide(p, leaves.x * LEAF + uint(i) % LEAF, size);
            leaves = uint(i) % LEAF == LEAF - 1u ? leaves.yzww : leaves;
            --turns;
        }
    }
    return found || turns <= 0;
}

void main()
{
    uint nth = gl_GlobalInvocationID.x;
    if (nth >= push.cells.x * push.cells.y) {
        return;
    }
    uint seed = hashed(hashed(hashed(frame_number) + light_index) + nth);
    vec2 cell = vec2(nth % push.cells.x, nth / push.cells.x);
    vec2 within = vec2(unit(hashed(seed + 1u)), unit(hashed(seed + 2u)));
    // A pixel on the border of cells belongs to each by its share, so that all pixels are as likely.
    vec2 place = (cell + within) * vec2(frame.extent) / vec2(push.cells);
    ivec2 pixel = min(ivec2(place), frame.extent - 1);
    Receiver r = receiver_of(pixel);
    float v = imageLoad(visibility, pixel).x;
    Figure f = figure_of(r);
    bool judged = r.receives && f.there;
    // Beyond its reach a light adds nothing, and it does not matter what was written.
    bool counts = !r.receives || within_reach(r.position);
    bool traced = counts && judged && may_be_shadowed(pyramid_of(r.position, f));
    bool listed = traced || (counts && !(is_finite(v) && v >= FULL));
    uint flags = (listed ? LISTED : 0u) | (traced ? TRACED : 0u);
    candidates[nth] = uvec4(uint(pixel.x) | uint(pixel.y) << 16, floatBitsToUint(v), flags, seed);
}
