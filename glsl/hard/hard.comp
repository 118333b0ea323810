// Entry of the pass hard.visibility (src/techniques/hard/mod.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "common/one_map.glsl"

// A hard shadow map, 3x3 percentage-closer filtered (Reeves 1987): the mean of nine comparisons that are
// each bilinear. Together they weigh 4x4 texels by (1 - f, 1, 1, f)/3 along each axis.
//
// Where it stands for a soft shadow whose penumbra no pixel shows, one bilinear comparison blurs less.

void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    if (p.x >= push.extent.x || p.y >= push.extent.y) {
        return;
    }
    Receiver r = pixel_receiver(p);
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
        // From below the pixel's own surface nothing is seen of the light's centre.
        v = m.c >= 0.0 && r.blocks ? 0.0 : 1.0 - min(hidden, 1.0);
    }
    imageStore(visibility, p, vec4(v));
}
