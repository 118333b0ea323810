// Entry of the passes soft_shadow_map.patch_emit_back and soft_shadow_map.patch_emit_front (src/techniques/soft_shadow_map/receiver_map.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "soft_shadow_map/node.glsl"

// Every occupied texel to a micro-patch, in the order of the blocks (Atty 2006, section 4.3: the
// render-to-vertex-buffer that its authors wished for). One invocation a block.

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, std430) readonly buffer Texels { float texels[]; };
layout(set = 0, binding = 1, std430) readonly buffer Blocks { uvec4 blocks[]; };
layout(set = 0, binding = 2, std430) readonly buffer Offsets { uint offsets[]; };
layout(set = 0, binding = 3, std430) buffer Patches { uvec2 patches[]; };

layout(push_constant) uniform Push {
    int row;  // blocks a row
    int side;
} push;

const int GROUP = 64;

void main()
{
    int count = push.row * push.row;
    int block = int(gl_GlobalInvocationID.x);
    if (block >= count) {
        return;
    }
    int side = push.side * count;
    int group = block / GROUP;
    uint at = offsets[group];
    for (int i = group * GROUP; i < block; ++i) {
        at += uint(uintBitsToFloat(blocks[2 * (side + i)].x));
    }
    uvec2 lo = uvec2(block % push.row, block / push.row) * uint(BLOCK);
    for (int n = 0; n < BLOCK_TEXELS; ++n) {
        float w = texels[(side + block) * BLOCK_TEXELS + n];
        if (w > 0.0) {
            uvec2 p = lo + uvec2(n % BLOCK, n / BLOCK);
            patches[at] = uvec2(p.x | (p.y << 16), floatBitsToUint(w));
            at += 1u;
        }
    }
}
