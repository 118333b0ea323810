// Entry of the pass occlusion_textures.place (src/techniques/occlusion_textures/slices.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "occlusion_textures/slices.glsl"

// Places slices of equal thickness (Eisemann and Decoret 2008, section 3.4).

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, rgba32f) writeonly uniform image2D placement;

layout(push_constant) uniform Push {
    float near; // distance of the nearest occluder from the light's plane, m
    float far;
    float eye;  // how far behind the light the projection point is, m
    float plane; // where in a slice its texture lies: 0 at the top, 1 at the bottom
    int slices;
    float span; // what the slices share: metres, or the share of an orthographic map's heights
} push;

float distance_of_bin(int bin)
{
    return mix(push.near, push.far, float(bin) / float(BINS));
}

void main()
{
    int i = int(gl_GlobalInvocationID.x);
    if (i < BINS) {
        int slice = 0;
        for (int k = 1; k < push.slices; ++k) {
            slice += int(equal_bin(k, push.slices) <= i);
        }
        imageStore(placement, ivec2(i, 0),
                   vec4(float(slice), push.near + push.eye, push.span, 0.0));
    } else if (i < BINS + push.slices) {
        int slice = i - BINS;
        float upper = distance_of_bin(equal_bin(slice, push.slices));
        float lower = distance_of_bin(equal_bin(slice + 1, push.slices));
        imageStore(placement, ivec2(i, 0), vec4(upper, lower, mix(upper, lower, push.plane), 0.0));
    }
}
