// Entry of the pass occlusion_textures.histogram_start (src/techniques/occlusion_textures/slices.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "occlusion_textures/slices.glsl"

// Clears the histogram of distances.

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, std430) buffer Histogram { uint histogram[]; };

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i < uint(BINS)) {
        histogram[i] = 0u;
    }
}
