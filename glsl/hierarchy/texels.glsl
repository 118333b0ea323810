// Entered from hierarchy/triangles.comp, hierarchy/boxes.comp, hierarchy/nodes.comp and hierarchy/tree.glsl.
//
// Where the hierarchy's lists lie in images. A node is one texel, behind two that hold the least corner of the root's box
// and the step of all boxes, as the bits of floats. A triangle is three texels: its corners, or four zeros for a place
// without a triangle. Beside the first corner is 1, or 2 where a texture cuts the triangle out.

#ifndef HIERARCHY_TEXELS_GLSL
#define HIERARCHY_TEXELS_GLSL

// The width of the images is 1 << TEXELS_BITS (src/stages/hierarchy/mod.rs).
const uint TEXELS_BITS = 12u;

ivec2 texel(uint nth)
{
    return ivec2(nth & (1u << TEXELS_BITS) - 1u, nth >> TEXELS_BITS);
}

// The texels before the first node.
const uint HEAD = 2u;

// More than what stands beside the first corner of a triangle that blocks whole.
const float CUT_FROM = 1.5;

// The triangles of a leaf (src/stages/hierarchy/mod.rs).
const uint LEAF = 2u;

#endif
