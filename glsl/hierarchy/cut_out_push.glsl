// Entered from hierarchy/opacities.comp and hierarchy/cut_outs.comp.
//
// A mesh that a texture cuts out. Set 1 has the host's own texture coordinates, texture and indices.

#ifndef HIERARCHY_CUT_OUT_PUSH_GLSL
#define HIERARCHY_CUT_OUT_PUSH_GLSL

#include "common/lists.glsl"
#include "cut_outs/cut_out.glsl"

layout(local_size_x = 64) in;

layout(push_constant) uniform Push {
    CutOut cut_out;
    uint first;      // the place of the mesh's first triangle among those of all meshes
    uint count;      // how many triangles it has
    uint indices;    // where its indices begin, in indices
    uint index_bits; // 16 or 32; 0 without indices
    uint halved;     // how many times textures are halved
} push;

#endif
