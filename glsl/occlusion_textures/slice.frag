// Entry of the passes occlusion_textures.slices, occlusion_textures.front_slices and others (src/techniques/occlusion_textures/slices.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// Counts faces in the channel of their slice, up to 255; blending adds. It needs no order of the faces and no optional
// feature: every device blends into four images of four times eight bits at once. `FIRST` is the slice of the first
// channel.

#include "occlusion_textures/slices.glsl"
#ifdef CUT
#include "cut_outs/image.glsl"
#endif

layout(set = 0, binding = 0) uniform texture2D placement;

layout(location = 0) out vec4 slices_0;
layout(location = 1) out vec4 slices_1;
layout(location = 2) out vec4 slices_2;
layout(location = 3) out vec4 slices_3;

// One step of an eight-bit channel.
const float ONE = 1.0 / 255.0;

void main()
{
#ifdef CUT
    if (lets_through()) {
        discard;
    }
#endif
    vec4 known = texelFetch(placement, ivec2(0, 0), 0);
    int bin = bin_of(gl_FragCoord.z, known.y, known.z);
    int slice = int(texelFetch(placement, ivec2(bin, 0), 0).x) - FIRST;
    ivec4 channel = ivec4(0, 1, 2, 3);
    slices_0 = ONE * vec4(equal(channel, ivec4(slice)));
    slices_1 = ONE * vec4(equal(channel + 4, ivec4(slice)));
    slices_2 = ONE * vec4(equal(channel + 8, ivec4(slice)));
    slices_3 = ONE * vec4(equal(channel + 12, ivec4(slice)));
}
