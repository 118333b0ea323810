// Entry of the pass hard.visibility (src/techniques/hard/mod.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "common/one_map.glsl"

// A hard shadow map with a 3x3 percentage-closer filter (Reeves 1987): the mean of nine comparisons, each of them
// bilinear. Together they weigh 4x4 texels by (1 - f, 1, 1, f)/3 along each axis.
//
// Where the result stands for a soft shadow whose penumbra is narrower than a pixel, one bilinear comparison is used,
// which blurs less.

void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    if (p.x >= gbuffer.extent.x || p.y >= gbuffer.extent.y) {
        return;
    }
    Receiver r = pixel_receiver(p);
    if (!is_served(r.position)) {
        return;
    }
    float v = 1.0;
    if (r.receives) {
        MapPlane m = pixel_plane(r);
        vec2 corner = floor(m.t - 0.5);
        vec2 f = m.t - 0.5 - corner;
        bool one = push.count == 1;
        vec4 x = one ? vec4(0.0, 1.0 - f.x, f.x, 0.0) : vec4(1.0 - f.x, 1.0, 1.0, f.x) / 3.0;
        vec4 y = one ? vec4(0.0, 1.0 - f.y, f.y, 0.0) : vec4(1.0 - f.y, 1.0, 1.0, f.y) / 3.0;
        float hidden = 0.0;
        for (int j = 0; j < 4; ++j) {
            for (int i = 0; i < 4; ++i) {
                hidden += x[i] * y[j] * hides(m, ivec2(corner) + ivec2(i - 1, j - 1));
            }
        }
        // The light's centre lies below the pixel's own surface.
        v = m.c >= 0.0 && r.blocks ? 0.0 : 1.0 - min(hidden, 1.0);
    }
    imageStore(visibility, p, vec4(v));
}
