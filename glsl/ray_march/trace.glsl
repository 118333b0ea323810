// See trace.comp.

layout(local_size_x = 64) in;

layout(set = 0, binding = 4, std430) readonly buffer Pixels {
    uint count;
    uint none[3];
    mat4 ndc_from_light;
    uint pixels[];
};

#define SEEN
bool seen(vec2 t, float w);

#include "ray_march/pixel.glsl"
#include "ray_march/sampling.glsl"
#include "ray_march/filter.glsl"

#define NOISY_BINDING 5
#define SURFACE_BINDING 6
#include "ray_march/noisy.glsl"

#ifdef TEXTURED
layout(set = 0, binding = 7) uniform texture2D light_texture;

// What the light sends out at a point of [0, 1]^2. Light space has y against the light's second half-axis,
// so that the texture's first row is where that points.
FRACTION emitted_at(vec2 s)
{
    ivec2 size = textureSize(light_texture, 0);
    ivec2 texel = clamp(ivec2(s * vec2(size)), ivec2(0), size - 1);
    vec3 color = max(texelFetch(light_texture, texel, 0).rgb, vec3(0.0));
#ifdef COLOR
    return color;
#else
    // Luminance of linear sRGB.
    return dot(color, vec3(0.2126, 0.7152, 0.0722));
#endif
}
#endif

// The eye layer (Curtis 2009 section 3.4): what the eye sees through is empty.
bool seen(vec2 t, float w)
{
    if (!looks_from_eye()) {
        return false;
    }
    vec2 across = (t - push.first) / push.texels_per_unit;
    vec3 position = is_orthographic() ? vec3(across, push.eye - w) : vec3(across / w, 1.0 / w - push.eye);
    vec4 clip = ndc_from_light * vec4(position, 1.0);
    vec3 ndc = clip.xyz / clip.w;
    ivec2 p = ivec2(floor((ndc.xy * 0.5 + 0.5) * vec2(push.extent)));
    if (clip.w <= 0.0 || any(lessThan(p, ivec2(0))) || any(greaterThanEqual(p, push.extent))) {
        return false;
    }
    float depth = depth_at(p);
    return push.background == 0.0 ? ndc.z > depth : ndc.z < depth;
}

void main()
{
    uint at = gl_GlobalInvocationID.x;
    if (at >= count) {
        return;
    }
    uint word = pixels[3u * at];
    ivec2 p = ivec2(word & 0xffffu, word >> 16u);
    float start = uintBitsToFloat(pixels[3u * at + 1u]);
    float end = uintBitsToFloat(pixels[3u * at + 2u]);
    Receiver r = receiver_without_normal(gbuffer(), p);
    r.normal = pixel_normal(p, r);
    Place place = place_of(r);
    float above = part_above(r);
    int hidden = 0;
    float heights = 0.0; // where rays are stopped
#ifdef TEXTURED
    FRACTION emitted = FRACTION(0.0);
    FRACTION arrived = FRACTION(0.0);
#endif
    for (int i = 0; i < rays(); ++i) {
        vec2 s = light_sample(sampling(), is_modern(), i, rays(), cell_rows(), uvec2(p), push.seed);
        vec2 point = (2.0 * s - 1.0) * push.half_light;
#ifdef TEXTURED
        FRACTION weight = emitted_at(s);
        emitted += weight;
#endif
        // What the pixel's own surface hides is known without a ray.
        if (r.blocks && dot(r.normal, vec3(point, 0.0) - r.position) <= 0.0) {
            continue;
        }
        Ray ray = over_map(place, Ray(slope_to(place, r.position.z, point), start, end), push.map);
        bool hit = false;
        if (ray.start <= ray.end) {
            float height;
            hit = is_linear() ? search_linear(place, ray, levels(), height)
                              : search_hierarchical(place, ray, levels(), looks_from_eye(), height);
            hidden += int(hit);
            heights += hit ? height : 0.0;
        }
#ifdef TEXTURED
        arrived += hit ? FRACTION(0.0) : weight;
#endif
    }
#ifdef TEXTURED
    // Of what the rays' points send out; all of it where that is nothing.
    FRACTION nothing = FRACTION(1.0e-30);
    FRACTION v = (arrived + nothing) / (emitted + nothing);
#else
    float v = max(above - float(hidden) / float(rays()), 0.0);
#endif
    if (!filters()) {
        imageStore(visibility, p, stored_fraction(v));
        return;
    }
    // The penumbra of an occluder at the mean of the heights where rays are stopped.
    float s = hidden > 0 ? heights / float(hidden) : 0.5 * (start + end);
    float z = distance_of(place.w + s);
    float side = 2.0 * min(push.half_light.x, push.half_light.y);
    float penumbra = side * max(r.position.z - z, 0.0) / max(z, 1.0e-30);
    float pixel = pixel_width(push.light_from_ndc, vec2(p), push.extent, depth_at(p));
    float width = filter_width(penumbra, pixel, noise_of(rays(), sampling() == RANDOM));
    put_noisy(p, v, width, r.normal);
}
