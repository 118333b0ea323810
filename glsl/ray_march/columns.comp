#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "ray_march/column.glsl"

// Depth layers to columns. A surface that is steeper than its matter is thick would let rays through
// between texels; each interval reaches down to where its top goes on in the neighbours.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform texture2D front_depth;
layout(set = 0, binding = 1) uniform texture2D back_depth;
layout(set = 0, binding = 2) uniform texture2D near_back_depth;
layout(set = 0, binding = 3) uniform texture2D far_front_depth;
layout(set = 0, binding = 4, rgba32f) writeonly uniform image2DArray windows;

layout(push_constant) uniform Push {
    int map;      // the map's side in texels
    int layers;   // 2, or 4 where there are the nearest back and the furthest front faces too
    float height; // of what is stored as 1
} push;

float stored(int layer, ivec2 p)
{
    if (any(lessThan(p, ivec2(0))) || any(greaterThanEqual(p, ivec2(push.map)))) {
        return 0.0;
    }
    return layer == 0 ? texelFetch(front_depth, p, 0).x : texelFetch(far_front_depth, p, 0).x;
}

// Nearest faces (0) or furthest front faces (1), 0 where there are none.
float height_at(int layer, ivec2 p)
{
    float depth = stored(layer, p);
    return depth < 1.0 || layer == 0 ? depth * push.height : 0.0;
}

// How far the surface of a layer goes down from a texel within its neighbours.
float drop_of(int layer, ivec2 p, float h)
{
    float most = 0.0;
    for (int i = 0; i < 2; ++i) {
        ivec2 axis = i == 0 ? ivec2(1, 0) : ivec2(0, 1);
        float before = height_at(layer, p - axis);
        float after = height_at(layer, p + axis);
        most = max(most, step_down(h, before, height_at(layer, p - 2 * axis), after));
        most = max(most, step_down(h, after, height_at(layer, p + 2 * axis), before));
    }
    return most;
}

void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    if (p.x >= push.map || p.y >= push.map) {
        return;
    }
    vec4 column = vec4(0.0);
    float top = height_at(0, p);
    if (top > 0.0) {
        float far_back = texelFetch(back_depth, p, 0).x;
        far_back = far_back < 1.0 ? far_back * push.height : 0.0;
        if (push.layers == 4) {
            float near_back = texelFetch(near_back_depth, p, 0).x * push.height;
            column = two_intervals(top, near_back, height_at(1, p), far_back);
        } else {
            column = one_interval(top, far_back);
        }
        column.y = min(column.y, top - drop_of(0, p, top));
        if (column.z > 0.0) {
            column.w = min(column.w, column.z - drop_of(1, p, column.z));
        }
    }
    imageStore(windows, ivec3(p, 0), column);
}
