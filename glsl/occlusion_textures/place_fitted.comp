// Entry of the pass occlusion_textures.place_fitted (src/techniques/occlusion_textures/slices.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "occlusion_textures/slices.glsl"

// Places slices by a histogram of the faces' distances: slices are thin where there are many faces, and a slice's
// texture lies at their mean distance. The authors leave this to be done (Eisemann and Decoret 2008, section 5).
//
// Half of a slice's share is its share of the faces, half its share of the distance, so that surfaces the histogram
// misses, such as the walls of a box seen from above, are not left to one slice. One workgroup does it; each invocation
// has EACH bins side by side.

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, rgba32f) writeonly uniform image2D placement;
layout(set = 0, binding = 1, std430) readonly buffer Histogram { uint histogram[]; };

layout(push_constant) uniform Push {
    float near; // distance of the nearest occluder from the light's plane, m
    float far;
    float eye;  // how far behind the light the projection point is, m
    float plane; // where in a slice without faces its texture lies: 0 at the top, 1 at the bottom
    int slices;
    float span; // what the slices share: metres, or the share of an orthographic map's heights
} push;

const int EACH = BINS / 64;
const int MOST_SLICES = 32;

shared uint totals[2][64];       // the faces up to an invocation's last bin; the two take turns
shared int wanted_at[MOST_SLICES]; // the first bin that a slice could begin at by its share
shared int begins[MOST_SLICES + 1]; // the first bin of a slice; behind the last one BINS
shared uint masses[MOST_SLICES]; // a slice's faces
shared uint sums[MOST_SLICES];   // the sum of their bins: fewer than 2^17 faces times 960 bins are below 2^27

float distance_of_bin(float bin)
{
    return mix(push.near, push.far, bin / float(BINS));
}

// Writes a slice from bin `begin` to before bin `end`, with `mass` faces at a mean of `sum`/`mass` bins.
void put(int slice, int begin, int end, float mass, float sum)
{
    float plane = mass > 0.0 ? sum / mass + 0.5 : mix(float(begin), float(end), push.plane);
    imageStore(placement, ivec2(BINS + slice, 0),
               vec4(distance_of_bin(float(begin)), distance_of_bin(float(end)), distance_of_bin(plane),
                    0.0));
}

// The slice that a bin belongs to by its share, with `here` faces in it, `before` in those before it, and `total` in all.
int wanted(int bin, uint here, uint before, uint total)
{
    float share = 0.5 * (float(before) + 0.5 * float(here)) / max(float(total), 1.0) +
                  0.5 * (float(bin) + 0.5) / float(BINS);
    // Slices have a bin at least, and all of them are used.
    return clamp(int(share * float(push.slices)), push.slices - (BINS - bin), push.slices - 1);
}

void main()
{
    int me = int(gl_LocalInvocationIndex);
    int first = me * EACH;
    uint mine = 0u;
    for (int i = 0; i < EACH; ++i) {
        mine += histogram[first + i];
    }
    if (me < MOST_SLICES) {
        wanted_at[me] = BINS;
        begins[me] = BINS;
        masses[me] = 0u;
        sums[me] = 0u;
    }
    // Each step adds what lies twice as far before.
    int turn = 0;
    totals[0][me] = mine;
    barrier();
    for (int apart = 1; apart < 64; apart *= 2) {
        totals[1 - turn][me] = totals[turn][me] + (me >= apart ? totals[turn][me - apart] : 0u);
        turn = 1 - turn;
        barrier();
    }
    uint total = totals[turn][63];
    uint before = totals[turn][me] - mine;

    // Where the wanted slice grows from bin to bin, the slices up to it are wanted from there on. The first bin is in
    // slice 0, whatever it wants.
    int last = 0;
    if (me > 0) {
        uint previous = histogram[first - 1];
        last = first > 1 ? wanted(first - 1, previous, before - previous, total) : 0;
    }
    uint running = before;
    for (int i = 0; i < EACH; ++i) {
        uint here = histogram[first + i];
        int now = first + i > 0 ? wanted(first + i, here, running, total) : 0;
        for (int slice = last + 1; slice <= now; ++slice) {
            atomicMin(wanted_at[slice], first + i);
        }
        last = max(last, now);
        running += here;
    }
    barrier();

    // A slice begins where it is wanted, and behind the first bin of each slice before it.
    if (me < push.slices) {
        int begin = 0;
        for (int slice = 1; slice <= me; ++slice) {
            begin = max(begin + 1, wanted_at[slice]);
        }
        begins[me] = begin;
    }
    if (me == 0) {
        begins[push.slices] = BINS;
    }
    barrier();

    int slice = 0;
    while (slice + 1 < push.slices && begins[slice + 1] <= first) {
        ++slice;
    }
    uint mass = 0u;
    uint sum = 0u;
    for (int i = 0; i < EACH; ++i) {
        int bin = first + i;
        if (bin == begins[slice + 1]) {
            atomicAdd(masses[slice], mass);
            atomicAdd(sums[slice], sum);
            ++slice;
            mass = 0u;
            sum = 0u;
        }
        imageStore(placement, ivec2(bin, 0), vec4(float(slice), push.near + push.eye, push.span, 0.0));
        uint here = histogram[bin];
        mass += here;
        sum += here * uint(bin);
    }
    atomicAdd(masses[slice], mass);
    atomicAdd(sums[slice], sum);
    barrier();
    if (me < push.slices) {
        put(me, begins[me], begins[me + 1], float(masses[me]), float(sums[me]));
    }
}
