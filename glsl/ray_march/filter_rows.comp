#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// The listed pixels, filtered along their rows.

layout(local_size_x = 64) in;

layout(set = 0, binding = 0) uniform texture2D gbuffer_depth;
layout(set = 0, binding = 1, std430) readonly buffer Pixels {
    uint count;
    uint none[3];
    mat4 ndc_from_light;
    uint pixels[];
};
layout(set = 0, binding = 2) uniform texture2D noisy;
layout(set = 0, binding = 3, r32f) writeonly uniform image2D halfway;

#include "common/receiver.glsl"
#include "ray_march/filter.glsl"
#include "ray_march/normal.glsl"

layout(push_constant) uniform Push {
    mat4 light_from_ndc;
    ivec2 extent; // of the G-buffer
} push;

vec3 position_at(ivec2 p)
{
    return position_of(push.light_from_ndc, vec2(p), push.extent, texelFetch(gbuffer_depth, p, 0).x);
}

float value_at(ivec2 p)
{
    return texelFetch(noisy, p, 0).x;
}

void main()
{
    uint nth = gl_GlobalInvocationID.x;
    if (nth >= count) {
        return;
    }
    ivec2 p = ivec2(pixels[3u * nth] & 0xffffu, pixels[3u * nth] >> 16u);
    vec4 own = texelFetch(noisy, p, 0);
    float width = own.y;
    float v = value_at(p);
    if (width > 0.0) {
        vec3 normal = unfolded(own.zw);
        vec3 position = position_at(p);
        float sum = v;
        float weights = 1.0;
        ivec2 axis = ivec2(1, 0);
        float depth = texelFetch(gbuffer_depth, p, 0).x;
        float pixel = pixel_width(push.light_from_ndc, vec2(p), push.extent, depth);
        int reach = min(int(ceil(2.5 * width / pixel)), REACH);
        for (int i = 1; i <= 2 * reach; ++i) {
            ivec2 q = p + axis * ((i + 1) / 2) * (1 - 2 * (i & 1));
            if (any(lessThan(q, ivec2(0))) || any(greaterThanEqual(q, push.extent))) {
                continue;
            }
            vec4 its = texelFetch(noisy, q, 0);
            float value = its.x;
            if (value >= 0.0) {
                // What is known for sure has no normal; its place says enough.
                vec3 its_normal = its.y < 0.0 ? normal : unfolded(its.zw);
                float weight = filter_weight(position_at(q) - position, normal, its_normal, width);
                sum += weight * value;
                weights += weight;
            }
        }
        v = sum / weights;
    }
    imageStore(halfway, p, vec4(v));
}
