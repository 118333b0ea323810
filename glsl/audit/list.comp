// Entry of the pass audit.list (src/audit/passes.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "audit/candidates.glsl"

// Lists the candidates that may be in shadow, or an even selection of them where they are more than may be traced: each
// nth of them from a random first one, n a fraction. One invocation handles one block.

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, std430) readonly buffer Candidates { uvec4 candidates[]; };
layout(set = 0, binding = 1, std430) readonly buffer Sums { uint sums[]; };
layout(set = 0, binding = 2, std430) buffer Listed { uvec4 listed[]; };
layout(set = 0, binding = 3, std430) buffer Arguments { uint groups[4]; };

layout(push_constant) uniform Push {
    uint candidates;
    uint blocks;
    uint pixels;
} push;

// The quotient and the remainder of (a b + c) / n, for b and c up to n, and a and n below 2^20: the product may be more
// than 32 bits hold.
uvec2 divided(uint a, uint b, uint c, uint n)
{
    uvec2 result = uvec2(0u);
    for (int bit = 19; bit >= 0; --bit) {
        result *= 2u;
        result.y += (a >> bit & 1u) != 0u ? b : 0u;
        result += uvec2(result.y / n, 0u);
        result.y %= n;
    }
    result.y += c;
    return uvec2(result.x + result.y / n, result.y % n);
}

void main()
{
    uint block = gl_GlobalInvocationID.x;
    if (block >= push.blocks) {
        return;
    }
    uint before = 0u;
    uint all = 0u;
    for (uint i = 0u; i < push.blocks; ++i) {
        before += i < block ? sums[i] : 0u;
        all += sums[i];
    }
    uint chosen = min(all, push.pixels);
    if (block == 0u) {
        listed[0] = uvec4(chosen, all, 0u, 0u);
        groups[0] = (chosen + PIXELS_A_GROUP - 1u) / PIXELS_A_GROUP;
        groups[1] = 1u;
        groups[2] = 1u;
    }
    // The candidate with the number r, from 0 up, is in the list where a multiple of `all` lies above r chosen - chosen +
    // start and not above r chosen + start.
    uint start = all > 0u ? hashed(candidates[0].w) % all : 0u;
    uvec2 at = divided(before, chosen, start, max(all, 1u));
    uint first = start < chosen ? 1u : 0u;
    uint end = min((block + 1u) * CANDIDATES_A_BLOCK, push.candidates);
    for (uint nth = block * CANDIDATES_A_BLOCK; nth < end; ++nth) {
        uvec4 candidate = candidates[nth];
        if ((candidate.z & LISTED) != 0u) {
            if (at.y < chosen) {
                listed[at.x + first] = candidate;
            }
            at.y += chosen;
            at += uvec2(at.y / all, 0u);
            at.y %= all;
        }
    }
}
