// Entry of the pass audit.sums (src/audit/passes.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "audit/candidates.glsl"

// Counts the candidates of a block that may be in shadow. One invocation handles one block.

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, std430) readonly buffer Candidates { uvec4 candidates[]; };
layout(set = 0, binding = 1, std430) buffer Sums { uint sums[]; };

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
    uint sum = 0u;
    uint end = min((block + 1u) * CANDIDATES_A_BLOCK, push.candidates);
    for (uint nth = block * CANDIDATES_A_BLOCK; nth < end; ++nth) {
        sum += candidates[nth].z & LISTED;
    }
    sums[block] = sum;
}
