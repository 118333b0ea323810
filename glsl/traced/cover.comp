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
layout(set = 0, binding = 7, std430) readonly buffer Found { uint found[]; };
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

// The light's samples that a triangle hides from a receiver at `p`: four rows of eight a word.
uvec2 hidden_by(Triangle t, vec3 p)
{
    vec3 a = t.a - p;
    vec3 b = t.b - p;
    vec3 c = t.c - p;
    float volume = dot(t.normal, a);
    float side = volume < 0.0 ? -1.0 : 1.0;
    vec3 ab = cross(a, b) * side;
    vec3 bc = cross(b, c) * side;
    vec3 ca = cross(c, a) * side;
    vec3 own = t.normal * side;
    vec2 half_light = frame.half_light;
    bool sun = frame.sun != 0u;
    Bound e0 = bound_of(ab.xy, sun ? -ab.z : -dot(ab, p), half_light);
    Bound e1 = bound_of(bc.xy, sun ? -bc.z : -dot(bc, p), half_light);
    Bound e2 = bound_of(ca.xy, sun ? -ca.z : -dot(ca, p), half_light);
    // A segment to a lamp ends at its plane.
    Bound e3 = bound_of(sun ? vec2(0.0) : own.xy, sun ? 1.0 : -dot(own, t.a), half_light);
    // A triangle wholly nearer to the light than the receiver is bounded on both sides; where rounding leaves a sliver
    // of it open, it has no samples.
    bool open = max(max(e0.least.x, e1.least.x), e2.least.x) <= -FAR || min(min(e0.most.x, e1.most.x), e2.most.x) >= FAR;
    bool none = abs(volume) <= t.sharp || t.nearest > p.z || (open && t.furthest < p.z);
    uvec2 mask = uvec2(0u);
    for (int row = 0; row < SIDE; ++row) {
        float j = float(row);
        float least = max(max(e0.least.x + e0.least.y * j, e1.least.x + e1.least.y * j),
                          max(e2.least.x + e2.least.y * j, e3.least.x + e3.least.y * j));
        float most = min(min(e0.most.x + e0.most.y * j, e1.most.x + e1.most.y * j),
                         min(e2.most.x + e2.most.y * j, e3.most.x + e3.most.y * j));
        uint bits = interval(least - row_offset(row), most - row_offset(row));
        if (row < ROWS_A_WORD) {
            mask.x |= bits << SIDE * row;
        } else {
            mask.y |= bits << SIDE * (row - ROWS_A_WORD);
        }
    }
    return none ? uvec2(0u) : mask;
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
    uint end = entry.y + found[nth];
    for (uint i = entry.y; i < end && (hidden0 & hidden1) != ALL; ++i) {
        Triangle t = triangle_of(lists[i]);
        hidden0 |= hidden_by(t, r0.in_light);
        hidden1 |= hidden_by(t, r1.in_light);
    }
    ivec2 counts = 64 - ivec2(bitCount(hidden0.x) + bitCount(hidden0.y), bitCount(hidden1.x) + bitCount(hidden1.y));
    if (mine0) {
        imageStore(visibility, pixel0, vec4(float(counts.x) / 64.0));
    }
    if (mine1) {
        imageStore(visibility, pixel1, vec4(float(counts.y) / 64.0));
    }
}
