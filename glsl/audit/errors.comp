// Entry of the pass audit.errors (src/audit/passes.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "audit/candidates.glsl"

// Compares what the technique wrote with the truth, and sums the errors of a block of pixels in their order. One
// invocation handles one block.

layout(local_size_x = 64) in;

// The sums over a block's pixels in shadow: how many they are, of |error|, error squared and error, and the largest |error|.
struct Sums {
    uint pixels;
    float size;
    float square;
    float signed_sum;
    float worst;
    uint unused[3];
};

layout(set = 0, binding = 0, std430) readonly buffer Listed { uvec4 listed[]; };
layout(set = 0, binding = 1, std430) readonly buffer Parts { uint parts[]; };
layout(set = 0, binding = 2, std430) buffer Errors { Sums errors[]; };

layout(push_constant) uniform Push {
    uint candidates;
    uint blocks;
    uint pixels;
} push;

void main()
{
    uint block = gl_GlobalInvocationID.x;
    if (block >= push.blocks) {
        return;
    }
    Sums sums = Sums(0u, 0.0, 0.0, 0.0, 0.0, uint[3](0u, 0u, 0u));
    uint end = min((block + 1u) * PIXELS_A_BLOCK, listed[0].x);
    for (uint nth = block * PIXELS_A_BLOCK; nth < end; ++nth) {
        uint part = parts[nth];
        uint hidden = part & 0xffffu;
        uint all = part >> 16;
        bool whole = part != CUT_OFF;
        float v = uintBitsToFloat(listed[nth + 1u].y);
        float truth = all > 0u ? 1.0 - float(hidden) / float(all) : 1.0;
        // What is no number is as wrong as can be.
        float error = is_finite(v) ? v - truth : 1.0;
        if (whole && (truth < FULL || !(is_finite(v) && v >= FULL))) {
            sums.pixels += 1u;
            sums.size += abs(error);
            sums.square += error * error;
            sums.signed_sum += error;
            sums.worst = max(sums.worst, abs(error));
        }
    }
    errors[block] = sums;
}
