#version 450
#extension GL_GOOGLE_include_directive : require
#include "soft_shadow_map/node.glsl"

// Sixteen blocks to one superblock; moments move to the common mean by the parallel-axis rule.
// One invocation a superblock; z is the side.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0, std430) readonly buffer Blocks { vec4 blocks[]; };
layout(set = 0, binding = 1, std430) buffer Superblocks { vec4 superblocks[]; };

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
    int index = (side * push.row + super.y) * push.row + super.x;

    float count = 0.0;
    float sum = 0.0;
    float w_min = 3.0e38;
    float w_max = 0.0;
    for (int i = 0; i < FAN * FAN; ++i) {
        vec4 a = blocks[2 * (first + (i / FAN) * push.row * FAN + i % FAN)];
        if (a.x > 0.0) {
            count += a.x;
            sum += a.x * a.y;
            w_min = min(w_min, a.z);
            w_max = max(w_max, a.w);
        }
    }
    if (count == 0.0) {
        superblocks[2 * index] = vec4(0.0);
        superblocks[2 * index + 1] = vec4(0.0);
        return;
    }
    float mean = sum / count;
    float s2 = 0.0;
    float s3 = 0.0;
    for (int i = 0; i < FAN * FAN; ++i) {
        int at = 2 * (first + (i / FAN) * push.row * FAN + i % FAN);
        vec4 a = blocks[at];
        vec4 b = blocks[at + 1];
        if (a.x > 0.0) {
            float d = a.y - mean;
            s2 += b.x + a.x * d * d;
            s3 += b.y + 3.0 * d * b.x + a.x * d * d * d;
        }
    }
    superblocks[2 * index] = vec4(count, mean, w_min, w_max);
    superblocks[2 * index + 1] = vec4(s2, s3, 0.0, 0.0);
}
