// Entry of the pass traced.cover (src/techniques/traced/mod.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "traced/frame.glsl"
#include "traced/shaft.glsl"
#include "traced/lists.glsl"
#include "traced/cover.glsl"

// Tests the triangles of a shaft's list against all of the light's samples at once, for each of its receivers. One
// workgroup handles one shaft, each invocation two of its tile's pixels.

layout(local_size_x = 8) in;

layout(set = 0, binding = 3, std430) readonly buffer Shafts { Shaft shafts[]; };
layout(set = 0, binding = 4, rgba32f) readonly uniform image2D triangles;
layout(set = 0, binding = 5, std430) readonly buffer Totals { uint shaft_count; uint dense_count; };
layout(set = 0, binding = 6, std430) readonly buffer Listed { uvec2 listed[]; };
layout(set = 0, binding = 7, std430) readonly buffer Found { uvec4 found[]; };
layout(set = 0, binding = 8, std430) readonly buffer Lists { uint lists[]; };
layout(set = 0, binding = 9, r32f) writeonly uniform image2D visibility;

// A triangle in light space, as all receivers of the shaft need it.
struct Triangle {
    vec3 a;
    vec3 b;
    vec3 c;
    vec3 normal;
    float sharp;   // the height above its plane, times the normal's length, below which a receiver is in that plane
    float nearest; // the least and largest z of its corners
    float furthest;
};

Triangle triangle_of(uint nth)
{
    Triangle t;
    t.a = in_light_space(imageLoad(triangles, texel(3u * nth)).xyz);
    t.b = in_light_space(imageLoad(triangles, texel(3u * nth + 1u)).xyz);
    t.c = in_light_space(imageLoad(triangles, texel(3u * nth + 2u)).xyz);
    t.normal = cross(t.b - t.a, t.c - t.a);
    vec3 size = max(max(abs(t.a), abs(t.b)), abs(t.c));
    t.sharp = 2.0 * ROUNDING * length(t.normal) * (size.x + size.y + size.z);
    t.nearest = min(t.a.z, min(t.b.z, t.c.z));
    t.furthest = max(t.a.z, max(t.b.z, t.c.z));
    return t;
}

// The hidden samples of row j: those between the lines in their first and second components.
uint row_within(vec3 least, vec3 least_step, vec3 most, vec3 most_step, float j)
{
    vec3 from = least + least_step * j;
    vec3 to = most + most_step * j;
    return interval(max(max(from.x, from.y), from.z), min(min(to.x, to.y), to.z));
}

// The light's samples that a triangle hides from a receiver at `p`, four rows of eight a word. `towards` is where the
// segments to the light begin, as planes through the receiver see it: at the receiver, or for a sun (0, 0, 1).
uvec2 hidden_by(Triangle t, vec3 p, vec3 towards)
{
    vec3 a = t.a - p;
    vec3 b = t.b - p;
    vec3 c = t.c - p;
    float volume = dot(t.normal, a);
    float side = volume < 0.0 ? -1.0 : 1.0;
    vec3 ab = cross(a, b) * side;
    vec3 bc = cross(b, c) * side;
    vec3 ca = cross(c, a) * side;
    Line e0 = line_of(ab.xy, -dot(ab, towards));
    Line e1 = line_of(bc.xy, -dot(bc, towards));
    Line e2 = line_of(ca.xy, -dot(ca, towards));
    // A triangle wholly nearer to the light than the receiver is bounded on both sides; where rounding leaves a sliver
    // of it open, it has no samples.
    bool open = e0.least == e1.least && e1.least == e2.least;
    bool none = abs(volume) <= t.sharp || t.nearest > p.z || (open && t.furthest < p.z);
    vec2 l0 = least_of(e0);
    vec2 l1 = least_of(e1);
    vec2 l2 = least_of(e2);
    vec2 m0 = most_of(e0);
    vec2 m1 = most_of(e1);
    vec2 m2 = most_of(e2);
    vec3 l = vec3(l0.x, l1.x, l2.x);
    vec3 ls = vec3(l0.y, l1.y, l2.y);
    vec3 m = vec3(m0.x, m1.x, m2.x);
    vec3 ms = vec3(m0.y, m1.y, m2.y);
    uvec2 mask;
    mask.x = row_within(l, ls, m, ms, 0.0) | row_within(l, ls, m, ms, 1.0) << 8 |
             row_within(l, ls, m, ms, 2.0) << 16 | row_within(l, ls, m, ms, 3.0) << 24;
    mask.y = row_within(l, ls, m, ms, 4.0) | row_within(l, ls, m, ms, 5.0) << 8 |
             row_within(l, ls, m, ms, 6.0) << 16 | row_within(l, ls, m, ms, 7.0) << 24;
    return none ? uvec2(0u) : mask;
}

// The samples behind a triangle's own plane, as seen from a receiver on one side of it, where it crosses the light's.
uvec2 behind_plane(Triangle t, vec3 p)
{
    float side = dot(t.normal, t.a - p) < 0.0 ? -1.0 : 1.0;
    Line own = line_of(t.normal.xy * side, -dot(t.normal, t.a) * side);
    vec3 l = vec3(least_of(own).x);
    vec3 ls = vec3(least_of(own).y);
    vec3 m = vec3(most_of(own).x);
    vec3 ms = vec3(most_of(own).y);
    uvec2 mask;
    mask.x = row_within(l, ls, m, ms, 0.0) | row_within(l, ls, m, ms, 1.0) << 8 |
             row_within(l, ls, m, ms, 2.0) << 16 | row_within(l, ls, m, ms, 3.0) << 24;
    mask.y = row_within(l, ls, m, ms, 4.0) | row_within(l, ls, m, ms, 5.0) << 8 |
             row_within(l, ls, m, ms, 6.0) << 16 | row_within(l, ls, m, ms, 7.0) << 24;
    return mask;
}

// The share of the light that its samples show.
float visible_share(uvec2 hidden)
{
    float seen = 0.0;
    for (int i = 0; i < (frame.weight > 0.0 ? SIDE * SIDE : 0); ++i) {
        uint bit = (i < 32 ? hidden.x : hidden.y) >> (i & 31) & 1u;
        seen += bit == 0u ? weight_of(i) : 0.0;
    }
    float count = float(SIDE * SIDE - bitCount(hidden.x) - bitCount(hidden.y));
    return frame.weight > 0.0 ? seen / frame.weight : count / float(SIDE * SIDE);
}

void main()
{
    uint nth = nth_group(gl_WorkGroupID.xy);
    if (nth >= shaft_count) {
        return;
    }
    // Even places first, then odd ones: drivers that cut a dispatch in halves get halves of equal work.
    uint evens = (shaft_count + 1u) / 2u;
    nth = nth < evens ? 2u * nth : 2u * (nth - evens) + 1u;
    uvec2 entry = listed[nth];
    uvec4 list = found[nth];
    if (list.y + list.w == 0u) {
        return;
    }
    int tile = int(entry.x / SHAFTS_A_TILE);
    int row = tiles_in(frame.extent).x;
    ivec2 first = ivec2(tile % row, tile / row) * TILE_SIDE;
    uint pixels = shafts[entry.x].pixels;
    int lane = int(gl_LocalInvocationIndex);
    ivec2 pixel0 = first + ivec2(lane % TILE_SIDE, lane / TILE_SIDE);
    ivec2 pixel1 = pixel0 + ivec2(0, 8 / TILE_SIDE);
    Receiver r0 = receiver_of(pixel0);
    Receiver r1 = receiver_of(pixel1);
    bool mine0 = (pixels >> lane & 1u) != 0u;
    bool mine1 = (pixels >> lane + 8 & 1u) != 0u;
    const uvec2 ALL = uvec2(0xffffffffu);
    uvec2 hidden0 = mine0 ? uvec2(0u) : ALL;
    uvec2 hidden1 = mine1 ? uvec2(0u) : ALL;
    vec3 p0 = r0.in_light;
    vec3 p1 = r1.in_light;
    vec3 towards0 = frame.sun != 0u ? vec3(0.0, 0.0, 1.0) : p0;
    vec3 towards1 = frame.sun != 0u ? vec3(0.0, 0.0, 1.0) : p1;
    for (uint i = 0u; i < list.y && (hidden0 & hidden1) != ALL; ++i) {
        Triangle t = triangle_of(lists[list.x + i]);
        hidden0 |= hidden_by(t, p0, towards0);
        hidden1 |= hidden_by(t, p1, towards1);
    }
    for (uint i = 0u; i < list.w && (hidden0 & hidden1) != ALL; ++i) {
        Triangle t = triangle_of(lists[list.z + i]);
        hidden0 |= hidden_by(t, p0, towards0) & behind_plane(t, p0);
        hidden1 |= hidden_by(t, p1, towards1) & behind_plane(t, p1);
    }
    if (mine0) {
        imageStore(visibility, pixel0, vec4(visible_share(hidden0)));
    }
    if (mine1) {
        imageStore(visibility, pixel1, vec4(visible_share(hidden1)));
    }
}
