// Entry of the pass audit.figures (src/audit/passes.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "audit/candidates.glsl"

// Adds the blocks' sums in their order, and writes the frame's figures where the host reads them, with the frame's number
// and a sum of all words: words of two frames are none.

layout(local_size_x = 1) in;

// As in audit/errors.comp.
struct Sums {
    uint pixels;
    float size;
    float square;
    float signed_sum;
    float worst;
    uint unused[3];
};

layout(set = 0, binding = 0, std430) readonly buffer Listed { uvec4 listed[]; };
layout(set = 0, binding = 1, std430) readonly buffer Errors { Sums errors[]; };
layout(set = 0, binding = 2, std430) readonly buffer Number { uint frame_number; uint light_index; };
layout(set = 0, binding = 3, std430) buffer Figures { uint figures[16]; };

layout(push_constant) uniform Push {
    uint candidates;
    uint blocks;
    uint pixels;
} push;

void main()
{
    uint pixels = 0u;
    vec3 sums = vec3(0.0);
    float worst = 0.0;
    for (uint block = 0u; block < push.blocks; ++block) {
        Sums of = errors[block];
        pixels += of.pixels;
        sums += vec3(of.size, of.square, of.signed_sum);
        worst = max(worst, of.worst);
    }
    uint words[16] = uint[16](
        frame_number, pixels, push.candidates, floatBitsToUint(sums.x), floatBitsToUint(sums.y),
        floatBitsToUint(sums.z), floatBitsToUint(worst), listed[0].x, listed[0].y, 0u, 0u, 0u, 0u, 0u, 0u, 0u);
    // Fowler, Noll and Vo 1991, as in src/audit/mod.rs.
    uint sum = 0x811c9dc5u;
    for (int i = 0; i < 15; ++i) {
        sum = (sum ^ words[i]) * 0x01000193u;
        figures[i] = words[i];
    }
    figures[15] = sum;
}
