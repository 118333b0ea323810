// Entered from visibility.comp alone.
//
// What hides the light near a surface that blocks. Its own slice does not count for it and the slice above only in part
// (slices.glsl), or it would shadow itself. So the nearest faces are compared with the surface's plane, and those that lie
// before it count for the share that their slice does not.

#ifndef OCCLUSION_TEXTURES_NEAR_GLSL
#define OCCLUSION_TEXTURES_NEAR_GLSL

#include "common/compare.glsl"

// Taps a side of the kernel, which is a texel or two wide so close to the point that it is cast from.
const int TAPS = 4;

// The slice of a face or point, from the depth that the map's projection stores for it.
int slice_of(float stored)
{
    vec4 known = texelFetch(placement, ivec2(0, 0), 0);
    return int(texelFetch(placement, ivec2(bin_of(stored, known.y, known.z), 0), 0).x);
}

vec4 planes_of(int slice)
{
    return texelFetch(placement, ivec2(BINS + slice, 0), 0);
}

// The part of the light that faces near a receiver hide. The kernel lies halfway to where the slice above its own begins.
float hidden_near(Receiver r, MapWindow m)
{
    vec3 from_eye = r.position + vec3(0.0, 0.0, is_parallel() ? 0.0 : push.eye);
    float w = w_of(from_eye);
    MapPlane plane = map_plane_at(uv_of(from_eye, w), w, r.normal.xy, n_0_of(r.normal, from_eye),
                                  c_of(r.normal, from_eye), true, push.texels_per_uv, push.first, push.snap, 0.0);
    float above = planes_of(max(slice_of(w / push.top) - 1, 0)).x;
    vec4 kernel = kernel_of(m, r.position, mix(r.position.z, above, 0.5), push.half_light);
    float hidden = 0.0;
    for (int i = 0; i < TAPS * TAPS; ++i) {
        vec2 share = (vec2(i % TAPS, i / TAPS) + 0.5) / float(TAPS);
        ivec2 texel = ivec2(floor(mix(kernel.xy, kernel.zw, share)));
        if (any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, ivec2(push.map)))) {
            continue;
        }
        float stored = texelFetch(front_depth, texel, 0).x;
        if (in_front_of_filter(plane, vec2(texel) + 0.5, stored * push.top)) {
            vec4 planes = planes_of(slice_of(stored));
            hidden += 1.0 - slice_weight(r.position.z, planes.x, planes.y, true);
        }
    }
    return hidden / float(TAPS * TAPS);
}

#endif
