// Entry of the pass traced.emission (src/techniques/traced/passes.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "common/light_space.glsl"

// Writes what each of the light's samples emits: the mean of the light's texture over as much as a cell around the sample.
// One workgroup handles one sample. (Means over the cells themselves, whose samples are off their middles by the turn of
// the grid: mean error of a light with a color in each quadrant, 64 samples, 3.0 %.)

// So many that the largest textures need fewer turns than llvmpipe's 65,535.
layout(local_size_x = 128) in;

layout(set = 0, binding = 0) uniform texture2D light_texture;
layout(set = 0, binding = 1, rgba32f) writeonly uniform image2D emission;

layout(push_constant) uniform Push {
    int side;  // samples along a side of the light
    int color; // 1: red, green and blue count each; 0: luminance does
} push;

shared vec3 sums[gl_WorkGroupSize.x];

void main()
{
    ivec2 cell = ivec2(gl_WorkGroupID.xy);
    float side = float(push.side);
    vec2 at = vec2(cell) + vec2(float(cell.y) + 0.5, side - 0.5 - float(cell.x)) / side;
    vec2 size = vec2(textureSize(light_texture, 0));
    vec2 low = max(at - 0.5, 0.0) / side * size;
    vec2 high = min(at + 0.5, side) / side * size;
    ivec2 first = ivec2(floor(low));
    ivec2 count = ivec2(min(ceil(high), size)) - first;
    int lane = int(gl_LocalInvocationIndex);
    vec3 sum = vec3(0.0);
    for (int i = lane; i < count.x * count.y; i += int(gl_WorkGroupSize.x)) {
        ivec2 texel = first + ivec2(i % count.x, i / count.x);
        vec2 within = max(min(vec2(texel) + 1.0, high) - max(vec2(texel), low), 0.0);
        sum += within.x * within.y * emitted_by(texelFetch(light_texture, texel, 0));
    }
    sums[lane] = sum;
    barrier();
    if (lane == 0) {
        vec3 all = vec3(0.0);
        for (int i = 0; i < int(gl_WorkGroupSize.x); ++i) {
            all += sums[i];
        }
        vec3 mean = all / ((high.x - low.x) * (high.y - low.y));
        imageStore(emission, cell, vec4(push.color != 0 ? mean : vec3(luminance(mean)), 1.0));
    }
}
