// The rays of a pixel, whoever asks: trace.glsl for those on a list, headless/forward.frag for a fragment.

#ifndef RAY_MARCH_RAYS_GLSL
#define RAY_MARCH_RAYS_GLSL

#include "ray_march/sampling.glsl"

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

struct Found {
    FRACTION visible;
    int hidden;    // how many rays are stopped
    float heights; // the sum of where
};

// All rays of a receiver with its normal, between two heights above it.
Found found_by_rays(ivec2 p, Receiver r, float start, float end)
{
    Place place = place_of(r);
    float above = part_above(r);
    Found found = Found(FRACTION(0.0), 0, 0.0);
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
            found.hidden += int(hit);
            found.heights += hit ? height : 0.0;
        }
#ifdef TEXTURED
        arrived += hit ? FRACTION(0.0) : weight;
#endif
    }
#ifdef TEXTURED
    // Of what the rays' points send out; all of it where that is nothing.
    FRACTION nothing = FRACTION(1.0e-30);
    found.visible = (arrived + nothing) / (emitted + nothing);
#else
    found.visible = max(above - float(found.hidden) / float(rays()), 0.0);
#endif
    return found;
}

#endif
