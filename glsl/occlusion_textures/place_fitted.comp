// Entry of the pass occlusion_textures.place_fitted (src/techniques/occlusion_textures/slices.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "occlusion_textures/slices.glsl"

// Places slices by a histogram of the faces' distances: slices are thin where there are many faces, and a slice's
// texture lies at their mean distance. The authors leave this to be done (Eisemann and Decoret 2008, section 5).
//
// Half of a slice's share is its share of the faces, half its share of the distance, so that surfaces the histogram
// misses, such as the walls of a box seen from above, are not left to one slice. A single invocation does it: a running
// sum over so few bins is shorter than sharing it out.

layout(local_size_x = 1) in;

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

void main()
{
    float total = 0.0;
    for (int i = 0; i < BINS; ++i) {
        total += float(histogram[i]);
    }
    float before = 0.0;
    int slice = 0;
    int begin = 0;
    float mass = 0.0;
    float sum = 0.0;
    for (int i = 0; i < BINS; ++i) {
        float here = float(histogram[i]);
        float share = 0.5 * (before + 0.5 * here) / max(total, 1.0) +
                      0.5 * (float(i) + 0.5) / float(BINS);
        // Slices have a bin at least, and all of them are used.
        int wanted = int(share * float(push.slices));
        int next = clamp(wanted, slice, slice + 1);
        next = clamp(next, push.slices - (BINS - i), push.slices - 1);
        if (next > slice && i > 0) {
            put(slice, begin, i, mass, sum);
            slice = next;
            begin = i;
            mass = 0.0;
            sum = 0.0;
        }
        imageStore(placement, ivec2(i, 0),
                   vec4(float(slice), push.near + push.eye, push.span, 0.0));
        before += here;
        mass += here;
        sum += here * float(i);
    }
    put(slice, begin, BINS, mass, sum);
}
