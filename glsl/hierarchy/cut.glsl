// Entered from traced/cover.comp, traced/rays.comp and audit/trace.comp where CUT is defined.
//
// Which rays a triangle stops that an opacity texture cuts out. The including shader declares `cut_outs` and `opacities`.

#ifndef HIERARCHY_CUT_GLSL
#define HIERARCHY_CUT_GLSL

#include "cut_outs/cut_out.glsl"

// A triangle's places in its texture, and the texture.
struct Cut {
    vec2 a;
    vec2 b;
    vec2 c;
    uint bits;
    float cutoff;
    uint first; // the first texel's word in the image of all opacities
    ivec2 size;
};

Cut cut_of(uint triangle)
{
    vec4 p = texelFetch(cut_outs, texel(3u * triangle), 0);
    vec4 q = texelFetch(cut_outs, texel(3u * triangle + 1u), 0);
    vec4 r = texelFetch(cut_outs, texel(3u * triangle + 2u), 0);
    return Cut(p.xy, p.zw, q.xy, uint(q.z) << 16u, q.w, uint(r.x) << 12u | uint(r.y), ivec2(r.zw));
}

float opacity_of(Cut cut, ivec2 at)
{
    uint nth = uint(at.y * cut.size.x + at.x);
    uint word = texelFetch(opacities, texel(cut.first + (nth >> 2u)), 0).x;
    return float(word >> 8u * (nth & 3u) & 0xffu) / 255.0;
}

// Whether a ray is stopped that meets the triangle at these shares of its corners; `even` is spread evenly over 0..1 among
// the rays, and the same for both triangles of a leaf, which mostly are the halves of a quad.
bool stops(Cut cut, vec3 shares, float even)
{
    float sum = shares.x + shares.y + shares.z;
    vec2 place = (cut.a * shares.x + cut.b * shares.y + cut.c * shares.z) / sum;
    Texels t = texels_at(place, cut.size, cut.bits);
    vec4 found = vec4(opacity_of(cut, t.low), opacity_of(cut, ivec2(t.high.x, t.low.y)),
                      opacity_of(cut, ivec2(t.low.x, t.high.y)), opacity_of(cut, t.high));
    return stops(between(t, found), cut.cutoff, cut.bits, even);
}

#endif
