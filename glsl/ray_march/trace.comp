// Entry of the pass ray_march.trace (src/techniques/ray_march/passes.rs); at first skip noise.glsl and column.glsl.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// Traces the rays of the listed pixels; with `#define TEXTURED` each ray is weighed by the light's emission at its end.

layout(local_size_x = 64) in;

layout(set = 0, binding = 4, std430) readonly buffer Pixels {
    uint count;
    uint none[3];
    mat4 ndc_from_light;
    vec2 corners[16];
    uvec2 pieces[16];
    uint pixels[];
};

#define SEEN
#define NOISY_BINDING 5
#define SURFACE_BINDING 6
#include "ray_march/pixel.glsl"
#include "common/lists.glsl"

// The eye layer (Curtis 2009 section 3.4): a point in front of the nearest surface that the eye sees is empty.
bool seen(vec2 t, float w)
{
    if (!looks_from_eye()) {
        return false;
    }
    vec2 across = (t - push.first) / push.texels_per_unit;
    vec3 position = is_orthographic() ? vec3(across, push.eye - w) : vec3(across / w, 1.0 / w - push.eye);
    vec4 clip = ndc_from_light * vec4(position, 1.0);
    vec3 ndc = clip.xyz / clip.w;
    ivec2 p = ivec2(floor((ndc.xy * 0.5 + 0.5) * vec2(gbuffer.extent)));
    if (clip.w <= 0.0 || any(lessThan(p, ivec2(0))) || any(greaterThanEqual(p, gbuffer.extent))) {
        return false;
    }
    float depth = depth_at(p);
    return gbuffer.background == 0.0 ? ndc.z > depth : ndc.z < depth;
}

void main()
{
    uint at = place_in_list(gl_WorkGroupID.xy, gl_LocalInvocationIndex);
    if (at >= count) {
        return;
    }
    uint word = pixels[3u * at];
    ivec2 p = ivec2(word & 0xffffu, word >> 16u);
    float start = uintBitsToFloat(pixels[3u * at + 1u]);
    float end = uintBitsToFloat(pixels[3u * at + 2u]);
    Receiver r = receiver_without_normal(p);
    r.normal = pixel_normal(p, r);
    Found found = found_by_rays(p, r, start, end);
    if (!filters()) {
        imageStore(visibility, p, stored_fraction(found.visible));
        return;
    }
    // The width of the penumbra of an occluder at the mean height at which rays are stopped.
    float s = found.hidden > 0 ? found.heights / float(found.hidden) : 0.5 * (start + end);
    float z = distance_of(place_of(r).w + s);
    float side = 2.0 * min(push.half_light.x, push.half_light.y);
    float penumbra = side * (is_parallel() ? s : max(r.position.z - z, 0.0) / max(z, 1.0e-30));
    float pixel = pixel_width(gbuffer.light_from_ndc, vec2(p), gbuffer.extent, depth_at(p));
    float width = filter_width(penumbra, pixel, noise_of(rays(), sampling() == RANDOM));
    put_noisy(p, found.visible, width, r.normal);
}
