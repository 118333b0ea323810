// Entry of the passes ray_march.filter_columns and ray_march.filter_rows (src/techniques/ray_march/passes.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// Filters the listed pixels along their rows, or with `#define COLUMNS` along their columns.

layout(local_size_x = 64) in;

#define GBUFFER_CONSTANTS
#include "ray_march/noise.glsl"
#include "common/lists.glsl"

layout(set = 0, binding = 0) uniform texture2D gbuffer_depth;
layout(set = 0, binding = 1, std430) readonly buffer Pixels {
    uint count;
    uint none[3];
    mat4 ndc_from_light;
    vec2 corners[16];
    uvec2 pieces[16];
    uint pixels[];
};
layout(set = 0, binding = 2) uniform texture2D noisy;
#ifdef COLUMNS
layout(set = 0, binding = 3) uniform texture2D halfway;
layout(set = 0, binding = 4, FRACTION_FORMAT) writeonly uniform image2D visibility;
#else
layout(set = 0, binding = 3, FRACTION_FORMAT) writeonly uniform image2D halfway;
#endif
#ifdef COLOR
layout(set = 0, binding = 5) uniform texture2D surfaces;
#endif

vec3 position_at(ivec2 p)
{
    return position_of(gbuffer.light_from_ndc, vec2(p), gbuffer.extent, texelFetch(gbuffer_depth, p, 0).x);
}

// The value to filter, below 0 where the pixel receives nothing.
FRACTION value_at(ivec2 p)
{
#ifdef COLUMNS
    vec4 value = texelFetch(halfway, p, 0);
#else
    vec4 value = texelFetch(noisy, p, 0);
#endif
#ifdef COLOR
    return value.rgb;
#else
    return value.x;
#endif
}

// A pixel's normal, and the width of its filter in metres; the width is below 0 where the visible fraction is exact and
// there is no normal.
vec4 surface_at(ivec2 p)
{
    vec4 value = texelFetch(noisy, p, 0);
#ifdef COLOR
    return vec4(unfolded(texelFetch(surfaces, p, 0).xy), value.w);
#else
    return vec4(unfolded(value.zw), value.y);
#endif
}

void main()
{
    uint nth = place_in_list(gl_WorkGroupID.xy, gl_LocalInvocationIndex);
    if (nth >= count) {
        return;
    }
    ivec2 p = ivec2(pixels[3u * nth] & 0xffffu, pixels[3u * nth] >> 16u);
    vec4 own = surface_at(p);
    float width = own.w;
    FRACTION v = value_at(p);
    if (width > 0.0) {
        vec3 position = position_at(p);
        FRACTION sum = v;
        float weights = 1.0;
#ifdef COLUMNS
        ivec2 axis = ivec2(0, 1);
#else
        ivec2 axis = ivec2(1, 0);
#endif
        float depth = texelFetch(gbuffer_depth, p, 0).x;
        float pixel = pixel_width(gbuffer.light_from_ndc, vec2(p), gbuffer.extent, depth);
        int reach = min(int(ceil(2.5 * width / pixel)), REACH);
        for (int i = 1; i <= 2 * reach; ++i) {
            ivec2 q = p + axis * ((i + 1) / 2) * (1 - 2 * (i & 1));
            if (any(lessThan(q, ivec2(0))) || any(greaterThanEqual(q, gbuffer.extent))) {
                continue;
            }
            FRACTION value = value_at(q);
#ifdef COLOR
            bool receives = value.r >= 0.0;
#else
            bool receives = value >= 0.0;
#endif
            if (receives) {
                vec4 its = surface_at(q);
                // A pixel whose fraction is exact has no normal; its place is enough.
                vec3 its_normal = its.w < 0.0 ? own.xyz : its.xyz;
                float weight = filter_weight(position_at(q) - position, own.xyz, its_normal, width);
                sum += weight * value;
                weights += weight;
            }
        }
        v = sum / weights;
    }
#ifdef COLUMNS
    imageStore(visibility, p, stored_fraction(v));
#else
    imageStore(halfway, p, stored_fraction(v));
#endif
}
