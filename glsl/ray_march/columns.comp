// Entry of the pass ray_march.columns (src/techniques/ray_march/passes.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "ray_march/column.glsl"

// Converts depth layers to columns. A surface that is steeper than its matter is thick would let rays through between
// texels, so each interval reaches down to where its top goes on in the neighbouring texels. Corners of sloping solids
// are cut off.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform texture2D front_depth;
layout(set = 0, binding = 1) uniform texture2D back_depth;
layout(set = 0, binding = 2) uniform texture2D near_back_depth;
layout(set = 0, binding = 3) uniform texture2D far_front_depth;
layout(set = 0, binding = 4, rgba32f) writeonly uniform image2DArray windows;

layout(set = 0, binding = 5) uniform texture2D middle_front_depth;
layout(set = 0, binding = 6) uniform texture2D middle_back_depth;

layout(push_constant) uniform Push {
    int map;      // the map's side in texels
    int layers;   // 2; 4 where there are the nearest back and the furthest front faces too; 6 where those between are
    float height; // the height of a stored 1
    int middle;   // the layer of the windows for the pieces between the first and the last
} push;

const int FRONT = 0;
const int FAR_FRONT = 1;
const int NEAR_BACK = 2;
const int BACK = 3;
const int MIDDLE_FRONT = 4;
const int MIDDLE_BACK = 5;

float stored(int layer, ivec2 p)
{
    if (any(lessThan(p, ivec2(0))) || any(greaterThanEqual(p, ivec2(push.map)))) {
        return 0.0;
    }
    return layer == FRONT          ? texelFetch(front_depth, p, 0).x
           : layer == FAR_FRONT    ? texelFetch(far_front_depth, p, 0).x
           : layer == NEAR_BACK    ? texelFetch(near_back_depth, p, 0).x
           : layer == MIDDLE_FRONT ? texelFetch(middle_front_depth, p, 0).x
           : layer == MIDDLE_BACK  ? texelFetch(middle_back_depth, p, 0).x
                                   : texelFetch(back_depth, p, 0).x;
}

// The height of a layer's faces, 0 where there are none.
float height_at(int layer, ivec2 p)
{
    float depth = stored(layer, p);
    bool nearest = layer != FAR_FRONT && layer != BACK;
    return depth < 1.0 || nearest ? depth * push.height : 0.0;
}

// How far a layer's surface at height h goes up or down within half a texel: along each axis towards the neighbour in
// which it more likely goes on.
float half_slope(int layer, ivec2 p, float h)
{
    float most = 0.0;
    for (int i = 0; i < 2; ++i) {
        ivec2 axis = i == 0 ? ivec2(1, 0) : ivec2(0, 1);
        float before = height_at(layer, p - axis);
        float after = height_at(layer, p + axis);
        float least = min(before > 0.0 ? abs(h - before) : FAR_OFF, after > 0.0 ? abs(h - after) : FAR_OFF);
        most = max(most, least < FAR_OFF ? 0.5 * least : 0.0);
    }
    return most;
}

// How far the surface of a layer goes down from a texel towards its neighbours.
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

// The piece of matter between the first and the last over a texel: its top and its bottom, 0 where there is none.
vec2 middle_at(ivec2 p, vec4 column)
{
    float top = height_at(MIDDLE_FRONT, p);
    if (top <= column.z) {
        return vec2(0.0);
    }
    // Down to the last piece where no back face lies before it: they overlap.
    float back = height_at(MIDDLE_BACK, p);
    vec2 piece = vec2(top, back > 0.0 ? max(back, column.z) : top);
    float drop = drop_of(MIDDLE_FRONT, p, top);
    piece = beveled(piece, half_slope(MIDDLE_FRONT, p, top), half_slope(MIDDLE_BACK, p, piece.y));
    return vec2(piece.x, min(piece.y, piece.x - drop));
}

void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    if (p.x >= push.map || p.y >= push.map) {
        return;
    }
    vec4 column = vec4(0.0);
    vec2 middle = vec2(0.0);
    float top = height_at(0, p);
    if (top > 0.0) {
        float far_back = height_at(BACK, p);
        column = push.layers >= 4
                     ? two_intervals(top, height_at(NEAR_BACK, p), height_at(FAR_FRONT, p), far_back)
                     : one_interval(top, far_back);
        bool two = column.z > 0.0;
        if (two && push.layers == 6) {
            middle = middle_at(p, column);
        }
        float drop = drop_of(FRONT, p, top);
        float below = half_slope(two ? NEAR_BACK : BACK, p, column.y);
        column.xy = beveled(column.xy, half_slope(FRONT, p, top), below);
        column.y = min(column.y, column.x - drop);
        if (two) {
            drop = drop_of(FAR_FRONT, p, column.z);
            float above = half_slope(FAR_FRONT, p, column.z);
            column.zw = beveled(column.zw, above, half_slope(BACK, p, column.w));
            column.w = min(column.w, column.z - drop);
        }
    }
    imageStore(windows, ivec3(p, 0), column);
    if (push.layers == 6) {
        imageStore(windows, ivec3(p, push.middle), vec4(middle, 0.0, 0.0));
    }
}
