// Entry of the pass soft_shadow_map.superblocks (src/techniques/soft_shadow_map/nodes.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "soft_shadow_map/node.glsl"

// Combines sixteen blocks to one superblock; moments move to the common mean by the parallel-axis rule.
// One invocation handles one superblock; z is the side.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0, std430) readonly buffer Blocks { uvec4 blocks[]; };
layout(set = 0, binding = 1, std430) buffer Nodes { uvec4 nodes[]; };

layout(push_constant) uniform Push {
    int row; // superblocks a row
} push;

void main()
{
    ivec2 super = ivec2(gl_GlobalInvocationID.xy);
    if (super.x >= push.row || super.y >= push.row) {
        return;
    }
    int side = int(gl_GlobalInvocationID.z);
    int first = (side * push.row * FAN + super.y * FAN) * push.row * FAN + super.x * FAN;
    int index = ((side * push.row + super.y) * push.row + super.x) * FAMILY;

    int sides = int(gl_NumWorkGroups.z);
    int all_blocks = sides * push.row * FAN * push.row * FAN;
    int slopes = 2 * sides * push.row * push.row * FAMILY; // where the moments of slopes begin in nodes
    vec3 slope = vec3(0.0);
    float count = 0.0;
    float sum = 0.0;
    float w_min = 3.0e38;
    float w_max = 0.0;
    uint mask = 0u;
    for (int i = 0; i < FAN * FAN; ++i) {
        int at = first + (i / FAN) * push.row * FAN + i % FAN;
        uvec4 a = blocks[2 * at];
        uvec4 b = blocks[2 * at + 1];
        nodes[2 * (index + 1 + i)] = a;
        nodes[2 * (index + 1 + i) + 1] = b;
        uvec4 c = blocks[2 * all_blocks + at];
        nodes[slopes + index + 1 + i] = c;
        vec3 of_block = uintBitsToFloat(c.xyz);
        slope += vec3(of_block.x + dot(vec2(i % FAN, i / FAN) * float(BLOCK), of_block.yz), of_block.yz);
        Node node = unpack_node(a, b);
        if (node.count > 0.0) {
            count += node.count;
            sum += node.count * node.mean;
            w_min = min(w_min, node.w_min);
            w_max = max(w_max, node.w_max);
            mask |= 1u << i;
        }
    }
    if (count == 0.0) {
        nodes[2 * index] = uvec4(0u);
        nodes[2 * index + 1] = uvec4(0u);
        nodes[slopes + index] = uvec4(0u);
        return;
    }
    float mean = sum / count;
    // Like blocks.comp, this subtracts the sum of what rounding left.
    float rest = 0.0;
    for (int i = 0; i < FAN * FAN; ++i) {
        int at = first + (i / FAN) * push.row * FAN + i % FAN;
        Node node = unpack_node(blocks[2 * at], blocks[2 * at + 1]);
        rest += node.count > 0.0 ? node.count * (node.mean - mean) : 0.0;
    }
    mean += rest / count;
    float s2 = 0.0;
    float s3 = 0.0;
    for (int i = 0; i < FAN * FAN; ++i) {
        int at = first + (i / FAN) * push.row * FAN + i % FAN;
        Node node = unpack_node(blocks[2 * at], blocks[2 * at + 1]);
        if (node.count > 0.0) {
            float d = node.mean - mean;
            s2 += node.s2 + node.count * d * d;
            s3 += node.s3 + 3.0 * d * node.s2 + node.count * d * d * d;
        }
    }
    nodes[2 * index] = floatBitsToUint(vec4(count, mean, w_min, w_max));
    nodes[2 * index + 1] = uvec4(floatBitsToUint(vec2(s2, s3)), mask, 0u);
    nodes[slopes + index] = floatBitsToUint(vec4(slope, 0.0));
}
