// Entry of the passes audit.rays and audit.refine (src/audit/passes.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "traced/frame.glsl"
#include "audit/candidates.glsl"
#include "audit/light.glsl"

// Sends the rays of a listed pixel to a turned grid of 32x32 places of the light, shifted at random: first to every
// second one along both sides, and, with REFINE, to the others where the first ones disagree. One workgroup handles two
// pixels, each invocation a sixteenth of the rays of one.

layout(local_size_x = 32) in;

layout(set = 0, binding = 3, rgba32ui) readonly uniform uimage2D nodes;
layout(set = 0, binding = 4, std430) readonly buffer Header { vec4 root_low; vec4 root_step; };
layout(set = 0, binding = 5, std430) readonly buffer Listed { uvec4 listed[]; };
layout(set = 0, binding = 6, rgba32f) readonly uniform image2D triangles;
#ifdef REFINE
layout(set = 0, binding = 7, std430) buffer Parts { uint parts[]; };
#else
layout(set = 0, binding = 7, std430) writeonly buffer Parts { uint parts[]; };
#endif

#include "hierarchy/segment.glsl"

// The turns of all loops of an invocation: some drivers end loops without a word after 65,535 of them.
const int MOST_TURNS = 60000;

const int SIDE = 32;

#ifdef REFINE
const int FIRST = 16;
const int END = 64;
const uint PLACE = LANES;
#else
const int FIRST = 0;
const int END = 16;
const uint PLACE = 0u;
#endif

// The place that an invocation's nth ray goes to, as (i, j) of the grid.
ivec2 cell_of(int lane, int nth)
{
    int group = nth >> 4;
    return 2 * ivec2(nth & 15, lane) + ivec2(group & 1, group >> 1);
}

// Where a place lies, each coordinate from -1 to 1: on the turned grid of traced/cover.glsl, and of the torus shifted.
vec2 place_at(ivec2 cell, vec2 shift)
{
    vec2 turned = vec2(cell) + vec2(float(cell.y) + 0.5, float(SIDE - cell.x) - 0.5) / float(SIDE);
    return fract(turned / float(SIDE) + shift) * 2.0 - 1.0;
}

void main()
{
    uint nth = gl_GlobalInvocationID.x / LANES;
    if (nth >= listed[0].x) {
        return;
    }
    int lane = int(gl_GlobalInvocationID.x % LANES);
    uvec4 candidate = listed[nth + 1u];
    uint part = 2u * LANES * nth + PLACE + uint(lane);
    bool traced = (candidate.z & TRACED) != 0u;
#ifdef REFINE
    uint blocked_before = 0u;
    uint sent_before = 0u;
    for (uint i = 0u; i < LANES; ++i) {
        uint first = parts[2u * LANES * nth + i];
        blocked_before += first & 0xffffu;
        sent_before += first >> 16;
    }
    traced = traced && blocked_before > 0u && blocked_before < sent_before;
#endif
    Receiver r = receiver_of(ivec2(candidate.x & 0xffffu, candidate.x >> 16));
    Figure f = figure_of(r);
    vec2 shift = vec2(unit(hashed(candidate.w + 3u)), unit(hashed(candidate.w + 4u)));
    int end = traced ? END : FIRST;
    int turns = MOST_TURNS;
    uint sent = 0u;
    uint hidden = 0u;
    for (int ray = FIRST; ray < end && turns > 0; ++ray) {
        vec2 at = place_at(cell_of(lane, ray), shift);
        bool counts = is_of(f, at);
        at *= f.half_size;
        vec3 along = (f.base - r.position + f.u * at.x + f.v * at.y) * f.end;
        Segment s = segment_of(r.position, along, push.kind != SUN, root_low.xyz, root_step.xyz);
        bool hit = counts && blocked(s, frame.nodes, turns);
        // A ray whose walk was cut off says nothing.
        counts = counts && (hit || turns > 0);
        sent += counts ? 1u : 0u;
        hidden += hit ? 1u : 0u;
    }
    parts[part] = hidden | sent << 16;
}
