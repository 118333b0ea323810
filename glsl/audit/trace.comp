// Entry of the passes audit.trace and audit.trace_cut (src/audit/passes.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "traced/frame.glsl"
#include "audit/candidates.glsl"
#include "audit/light.glsl"

// Counts the cells of the light, of 32 by 16, whose samples are hidden from a listed pixel: all triangles of its pyramid
// are tested against all of them. One invocation handles one pixel.
//
// The samples lie on a turned grid, and what a triangle hides of a row of cells is an interval of bits, as in
// traced/cover.glsl, which has the derivation for the light's own plane. Here the plane is that of the pixel's figure, and
// a fourth line always bounds the interval: a segment ends before it has reached the triangle's plane.

layout(local_size_x = 16) in;

layout(set = 0, binding = 3, rgba32ui) readonly uniform uimage2D nodes;
layout(set = 0, binding = 4, std430) readonly buffer Listed { uvec4 listed[]; };
layout(set = 0, binding = 5, rgba32f) readonly uniform image2D triangles;
layout(set = 0, binding = 6, std430) buffer Parts { uint parts[]; };

#include "audit/pyramid.glsl"
#ifdef CUT
layout(set = 0, binding = 7) uniform texture2D cut_outs;
layout(set = 0, binding = 8) uniform utexture2D opacities;
#include "hierarchy/cut.glsl"
#endif

// Cells along the light's width and height: a row of cells is a word.
const int COLUMNS = 32;
const int ROWS = 16;

const float FAR = 1.0e9;

// A line's bounds on i in the jth row of cells, as x + y j.
struct Bounds {
    vec2 least;
    vec2 most;
    bool is_least;
};

// The bounds of what lies on the inner side of a plane, dot(n, s) + c >= 0 for a sample s from the figure's middle.
Bounds bounds_of(Figure f, vec3 n, float c)
{
    const vec2 CELLS = vec2(float(COLUMNS), float(ROWS));
    vec2 slope = vec2(dot(n, f.u), dot(n, f.v)) * f.half_size;
    vec2 cell = slope * 2.0 / CELLS;
    float k = c - slope.x - slope.y + dot(cell, vec2(0.5 / CELLS.y, 1.0 - 0.5 / CELLS.x));
    float i = cell.x - cell.y / CELLS.x;
    float j = cell.y + cell.x / CELLS.y;
    // A plane along a row of cells bounds none of them, or all.
    float least = 1.0e-7 * (abs(j) * CELLS.y + abs(k)) + 1.0e-37;
    i = abs(i) < least ? (i < 0.0 ? -least : least) : i;
    vec2 at = vec2(-k, -j) / i;
    bvec2 least_side = bvec2(i > 0.0);
    return Bounds(mix(vec2(-FAR, 0.0), at, least_side), mix(at, vec2(FAR, 0.0), least_side), i > 0.0);
}

// The first cells of a row; a shift by all 32 bits is not the same everywhere, and neither is a field of them.
uint first_cells(int count)
{
    return (0xffffffffu >> COLUMNS - max(count, 1)) * uint(min(count, 1));
}

// The cells of a row from above `least` to `most`; a sample at the very edge of two triangles belongs to one.
uint interval(float least, float most)
{
    int from = int(clamp(least + 1.0, 0.0, float(COLUMNS)));
    int to = int(clamp(most + 1.0, 0.0, float(COLUMNS)));
    return first_cells(to) & ~first_cells(from);
}

// The light's cells, four rows of cells each.
struct Cells {
    uvec4 a;
    uvec4 b;
    uvec4 c;
    uvec4 d;
};

// The bounds of a triangle's four lines, one a component.
struct Lines {
    vec4 least;
    vec4 least_step;
    vec4 most;
    vec4 most_step;
};

uint row_within(Lines l, float j)
{
    vec4 from = l.least + l.least_step * j;
    vec4 to = l.most + l.most_step * j;
    return interval(max(max(from.x, from.y), max(from.z, from.w)), min(min(to.x, to.y), min(to.z, to.w)));
}

// Four rows of cells, the first of them the jth.
uvec4 rows_within(Lines l, float j)
{
    return uvec4(row_within(l, j), row_within(l, j + 1.0), row_within(l, j + 2.0), row_within(l, j + 3.0));
}

#ifdef CUT
// The cells of the jth row whose rays an opacity texture stops; `ab` and so on are the planes through the tip and an edge,
// `middle` is where the figure's middle is from the tip.
uint row_stopped(Cut cut, Figure f, uint triangle, mat3 planes, vec3 middle, uint cells, int j)
{
    const vec2 CELLS = vec2(float(COLUMNS), float(ROWS));
    uint stopped = 0u;
    while (cells != 0u) {
        int i = findLSB(int(cells));
        cells &= cells - 1u;
        vec2 at = vec2(i, j) + vec2(float(j) + 0.5, CELLS.x - 0.5 - float(i)) / CELLS.yx;
        at = (at / CELLS * 2.0 - 1.0) * f.half_size;
        vec3 ray = middle + f.u * at.x + f.v * at.y;
        uint cell = 1u << i;
        bool stop = stops(cut, ray * planes, even_number(vec2(i, j), triangle >> 1u));
        stopped |= stop ? cell : 0u;
    }
    return stopped;
}
#endif

// The jth row of cells.
uint row_of(Cells cells, int j)
{
    uvec4 four = mix(mix(cells.a, cells.b, bvec4(j >= 4)), mix(cells.c, cells.d, bvec4(j >= 12)), bvec4(j >= 8));
    uvec2 two = mix(four.xy, four.zw, bvec2((j & 2) != 0));
    return mix(two.x, two.y, (j & 1) != 0);
}

// The cells that a triangle hides, with those that are hidden already.
Cells with_hidden(Cells hidden, Figure f, vec3 tip, vec3 middle, uint triangle)
{
    vec4 corner = imageLoad(triangles, texel(3u * triangle));
    vec3 a = corner.xyz - tip;
    vec3 b = imageLoad(triangles, texel(3u * triangle + 1u)).xyz - tip;
    vec3 c = imageLoad(triangles, texel(3u * triangle + 2u)).xyz - tip;
    vec3 normal = cross(b - a, c - a);
    float volume = dot(normal, a);
    float side = volume < 0.0 ? -1.0 : 1.0;
    vec3 ab = cross(a, b) * side;
    vec3 bc = cross(b, c) * side;
    vec3 ca = cross(c, a) * side;
    Bounds e0 = bounds_of(f, ab, dot(ab, middle));
    Bounds e1 = bounds_of(f, bc, dot(bc, middle));
    Bounds e2 = bounds_of(f, ca, dot(ca, middle));
    normal *= side;
    float reach = push.kind == SUN_DISC ? 3.0e38 : dot(normal, middle) - abs(volume) / f.end;
    Bounds own = bounds_of(f, push.kind == SUN_DISC ? vec3(0.0) : normal, reach);
    // A receiver in the triangle's plane sees it edge-on. A triangle wholly before the receiver is bounded on both sides;
    // where rounding leaves a sliver of it open, it hides nothing.
    vec3 size = max(max(abs(a), abs(b)), abs(c)) + abs(tip);
    bool flat_on = abs(volume) <= 2.0 * ROUNDING * length(normal) * (size.x + size.y + size.z);
    // A point has no sides that edges could be open to.
    bool open = push.kind != POINT && e0.is_least == e1.is_least && e1.is_least == e2.is_least;
    float nearest = min(min(-dot(f.normal, a), -dot(f.normal, b)), -dot(f.normal, c));
    bool none = corner.w == 0.0 || flat_on || (open && nearest > 0.0);
    Lines l;
    l.least = vec4(none ? FAR : e0.least.x, e1.least.x, e2.least.x, own.least.x);
    l.least_step = vec4(none ? 0.0 : e0.least.y, e1.least.y, e2.least.y, own.least.y);
    l.most = vec4(e0.most.x, e1.most.x, e2.most.x, own.most.x);
    l.most_step = vec4(e0.most.y, e1.most.y, e2.most.y, own.most.y);
#ifdef CUT
    bool is_cut = corner.w > CUT_FROM && !none;
    if (is_cut) {
        Cut cut = cut_of(triangle);
        mat3 planes = mat3(bc, ca, ab);
        // In a loop: some drivers compile each call anew, and for long.
        for (int j = 0; j < ROWS; ++j) {
            uint open = row_within(l, float(j)) & ~row_of(hidden, j);
            uint row = row_stopped(cut, f, triangle, planes, middle, open, j);
            uvec4 stopped = mix(uvec4(0u), uvec4(row), equal(ivec4(0, 1, 2, 3), ivec4(j & 3)));
            hidden.a |= j < 4 ? stopped : uvec4(0u);
            hidden.b |= j >= 4 && j < 8 ? stopped : uvec4(0u);
            hidden.c |= j >= 8 && j < 12 ? stopped : uvec4(0u);
            hidden.d |= j >= 12 ? stopped : uvec4(0u);
        }
    }
    // That is all that it hides.
    l.least.x = is_cut ? FAR : l.least.x;
    l.least_step.x = is_cut ? 0.0 : l.least_step.x;
#endif
    hidden.a |= rows_within(l, 0.0);
    hidden.b |= rows_within(l, 4.0);
    hidden.c |= rows_within(l, 8.0);
    hidden.d |= rows_within(l, 12.0);
    return hidden;
}

// The cells of the jth row of cells whose samples are of the figure; `mirror` is -1 along the axes that are mirrored.
uint cells_of(Figure f, vec2 mirror, int j)
{
    uint cells = 0u;
    const vec2 CELLS = vec2(float(COLUMNS), float(ROWS));
    for (int i = 0; i < COLUMNS; ++i) {
        vec2 at = vec2(i, j) + vec2(float(j) + 0.5, CELLS.x - 0.5 - float(i)) / CELLS.yx;
        cells |= is_of(f, (at / CELLS * 2.0 - 1.0) * mirror) ? 1u << i : 0u;
    }
    return cells;
}

// How many cells there are.
uint count_of(uvec4 cells)
{
    ivec4 counts = bitCount(ivec4(cells));
    return uint(counts.x + counts.y + counts.z + counts.w);
}

// The figure, as the pixel's mirror image of the grid lies on it.
Figure mirrored_figure(Receiver r, vec2 mirror)
{
    Figure f = figure_of(r);
    f.u *= mirror.x;
    f.v *= mirror.y;
    return f;
}

void main()
{
    uint nth = gl_GlobalInvocationID.x;
    if (nth >= listed[0].x) {
        return;
    }
    uvec4 candidate = listed[nth + 1u];
    face_light(vec3(0.0));
    Receiver r = receiver_of(ivec2(candidate.x & 0xffffu, candidate.x >> 16));
    // Each pixel has one of four mirror images of the grid: what the grid gets wrong is not the same in all of them.
    vec2 mirror = vec2((candidate.w & 1u) != 0u ? -1.0 : 1.0, (candidate.w & 2u) != 0u ? -1.0 : 1.0);
    const uvec4 ALL = uvec4(0xffffffffu);
    const uvec4 NONE = uvec4(0u);
    Cells hidden = Cells(NONE, NONE, NONE, NONE);
    uint at = (candidate.z & TRACED) != 0u ? 0u : frame.nodes;
    int turns = MOST_TURNS;
    bool open = true;
    while (at < frame.nodes && open && turns > 0) {
        // The pyramid is made again each time: it is not kept in registers while triangles are tested.
        Pyramid p = pyramid_of(r.position, figure_of(r), root_low(), root_step());
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
        Figure f = mirrored_figure(still(r, turns), mirror);
        for (int i = 0; i < count * int(LEAF); ++i) {
            hidden = with_hidden(hidden, f, r.position, f.base - r.position, leaves.x * LEAF + uint(i) % LEAF);
            leaves = uint(i) % LEAF == LEAF - 1u ? leaves.yzww : leaves;
            --turns;
        }
        open = (hidden.a & hidden.b & hidden.c & hidden.d) != ALL;
    }
    Figure f = figure_of(still(r, turns));
    uint all = uint(COLUMNS * ROWS);
    uint blocked = count_of(hidden.a) + count_of(hidden.b) + count_of(hidden.c) + count_of(hidden.d);
    if (push.kind == POLYGON || f.stadium.y > 0.0) {
        all = 0u;
        blocked = 0u;
        // In a loop: a polygon's corners make much of a row's code.
        for (int j = 0; j < ROWS; ++j) {
            uint cells = cells_of(f, mirror, j);
            all += uint(bitCount(int(cells)));
            blocked += uint(bitCount(int(cells & row_of(hidden, j))));
        }
    }
    // A walk that was cut off says nothing.
    parts[nth] = turns > 0 ? blocked | all << 16 : CUT_OFF;
}
