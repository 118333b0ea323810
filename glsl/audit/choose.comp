// Entry of the pass audit.choose (src/audit/passes.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "traced/frame.glsl"
#include "audit/candidates.glsl"
#include "audit/light.glsl"

// Chooses a random pixel of each cell of the image, and says whether it may be in shadow: by the technique, which wrote so,
// or by the truth, where a triangle reaches into the pyramid between the pixel and the light. One invocation handles one
// cell.

layout(local_size_x = 64) in;

layout(set = 0, binding = 3, rgba32ui) readonly uniform uimage2D nodes;
layout(set = 0, binding = 4, r32f) readonly uniform image2D visibility;
layout(set = 0, binding = 5, rgba32f) readonly uniform image2D triangles;
layout(set = 0, binding = 6, std430) readonly buffer Number { uint frame_number; uint light_index; };
layout(set = 0, binding = 7, std430) buffer Candidates { uvec4 candidates[]; };

#include "audit/pyramid.glsl"

float furthest(Side side, vec3 a, vec3 b, vec3 c)
{
    return max(max(dot(side.normal, a), dot(side.normal, b)), dot(side.normal, c)) - side.offset;
}

// Whether a triangle may hide any of the figure from the tip.
bool may_hide(Pyramid p, uint triangle, vec3 size)
{
    vec4 first = imageLoad(triangles, texel(3u * triangle));
    vec3 a = first.xyz - p.tip;
    vec3 b = imageLoad(triangles, texel(3u * triangle + 1u)).xyz - p.tip;
    vec3 c = imageLoad(triangles, texel(3u * triangle + 2u)).xyz - p.tip;
    float sides = min(min(furthest(p.a, a, b, c), furthest(p.b, a, b, c)),
                      min(furthest(p.c, a, b, c), furthest(p.d, a, b, c)));
    bool inside = first.w > 0.0 && min(sides, furthest(p.base, a, b, c)) >= 0.0;
    // A triangle's plane with the tip and the whole figure on one side hides nothing: the pixel's own surface mostly.
    vec3 n = cross(b - a, c - a);
    float allowed = slack(n, size);
    float of_tip = -dot(n, a);
    // A sun's figure is a metre away and stands for directions: where these go in the end, the plane's place has no part in.
    float start = push.kind == SUN_DISC ? 0.0 : of_tip;
    vec4 of_corners = start + vec4(dot(n, p.corner[0]), dot(n, p.corner[1]), dot(n, p.corner[2]), dot(n, p.corner[3]));
    float least = min(min(of_corners.x, of_corners.y), min(of_corners.z, of_corners.w));
    float most = max(max(of_corners.x, of_corners.y), max(of_corners.z, of_corners.w));
    // A tip that is as good as in the plane is on its own surface, on the side from which the viewer sees it.
    vec3 to_viewer = frame.towards.w > 0.0 ? frame.eye.xyz - p.tip : frame.towards.xyz;
    float side = abs(of_tip) > allowed ? of_tip : dot(n, to_viewer);
    bool before = side >= 0.0 && least >= allowed;
    bool behind = side <= 0.0 && most <= -allowed;
    return inside && !before && !behind;
}

bool may_be_shadowed(Pyramid p)
{
    vec3 size = size_about(p.tip, root_low(), root_step());
    bool found = false;
    uint at = 0u;
    int turns = MOST_TURNS;
    while (at < frame.nodes && !found && turns > 0) {
        // As in hierarchy/segment.glsl, leaves are collected before their triangles are tested.
        uvec4 leaves = uvec4(0u);
        int count = 0;
        while (at < frame.nodes && count < 4 && turns > 0) {
            Node node = node_at(at);
            bool inside = reaches(p, node);
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
    face_light(vec3(0.0));
    Receiver r = receiver_of(pixel);
    float v = imageLoad(visibility, pixel).x;
    Figure f = figure_of(r);
    bool judged = is_lit(r) && f.there;
    // Beyond its reach a light adds nothing, and it does not matter what was written.
    bool counts = !is_lit(r) || within_reach(r.position);
    bool traced = counts && judged && may_be_shadowed(pyramid_of(r.position, f, root_low(), root_step()));
    bool listed = traced || (counts && !(is_finite(v) && v >= FULL));
    uint flags = (listed ? LISTED : 0u) | (traced ? TRACED : 0u);
    candidates[nth] = uvec4(uint(pixel.x) | uint(pixel.y) << 16, floatBitsToUint(v), flags, seed);
}
