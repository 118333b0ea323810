// Entered from depth_layers/depth.vert, linear_light/middle.vert and linear_light/sample.vert where CUT is defined.
//
// Hands the place in a mesh's opacity texture, and what the texture's alpha means, from vertices to fragments. The number of
// the instance is that of the mesh among those that textures cut out.

#ifndef CUT_OUTS_VERTEX_GLSL
#define CUT_OUTS_VERTEX_GLSL

#include "cut_outs/cut_out.glsl"

layout(set = 0, binding = 15, std430) readonly buffer CutOuts { CutOut cut_outs[]; };
layout(set = 1, binding = 0, std430) readonly buffer Coordinates { float coordinates[]; };

layout(location = 0) out vec2 place;
layout(location = 1) flat out vec2 factor_and_cutoff;
layout(location = 2) flat out uvec2 bits_and_triangle;

void hand_over_place()
{
    CutOut c = cut_outs[gl_InstanceIndex];
    uint at = c.first + (c.bits & STRIDE_BITS) * uint(gl_VertexIndex);
    bool there = at + 1u < uint(coordinates.length());
    vec3 given = there ? vec3(coordinates[at], coordinates[at + 1u], 1.0) : vec3(0.0, 0.0, 1.0);
    place = vec2(dot(c.u.xyz, given), dot(c.v.xyz, given));
    factor_and_cutoff = vec2(c.v.w, c.u.w);
    // A triangle has the number of its first vertex, and so have both halves of most quads. Five is prime to the kinds of
    // triangle, and to the four vertices of a quad.
    bits_and_triangle = uvec2(c.bits, uint(gl_VertexIndex) + 5u * uint(gl_InstanceIndex));
}

#endif
