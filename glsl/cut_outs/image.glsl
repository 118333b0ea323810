// Entered from cut_outs/depth.frag, and where CUT is defined from depth_layers/beyond.frag, depth_layers/not_before.frag and
// occlusion_textures/slice.frag.
//
// Leaves out the fragments that an opacity texture lets the light through at.

#ifndef CUT_OUTS_IMAGE_GLSL
#define CUT_OUTS_IMAGE_GLSL

#include "cut_outs/cut_out.glsl"

layout(set = 1, binding = 1) uniform texture2D opacities;

layout(location = 0) in vec2 place;
layout(location = 1) flat in vec2 factor_and_cutoff;
layout(location = 2) flat in uvec2 bits_and_triangle;

bool lets_through()
{
    Texels t = texels_at(place, textureSize(opacities, 0), bits_and_triangle.x);
    vec4 found = vec4(texelFetch(opacities, t.low, 0).w, texelFetch(opacities, ivec2(t.high.x, t.low.y), 0).w,
                      texelFetch(opacities, ivec2(t.low.x, t.high.y), 0).w, texelFetch(opacities, t.high, 0).w);
    float even = even_number(floor(gl_FragCoord.xy), bits_and_triangle.y);
    return !stops(between(t, found) * factor_and_cutoff.x, factor_and_cutoff.y, bits_and_triangle.x, even);
}

#endif
