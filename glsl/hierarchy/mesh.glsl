// Entered from hierarchy/keys.comp and hierarchy/triangles.comp.
//
// The triangles of one of the host's meshes. Set 1 has the host's own buffers, which may be larger than what the mesh
// uses; an index beyond their end makes a triangle invalid and is never read.

#ifndef HIERARCHY_MESH_GLSL
#define HIERARCHY_MESH_GLSL

#include "common/lists.glsl"

layout(local_size_x = 64) in;

layout(push_constant) uniform Push {
    vec4 row_x;      // mesh space, from the origin below on, to the hierarchy's space: a plane each
    vec4 row_y;
    vec4 row_z;
    vec4 low;        // the least corner of the mesh's box, in mesh space; 1, or 2 where a texture cuts the mesh out
    vec4 cells;      // Morton cells a unit of mesh space
    uint first;      // the place of the mesh's first triangle among those of all meshes
    uint count;      // how many triangles it has
    uint padded;     // how many places it has: its triangles, and empty ones to fill the last leaf
    uint positions;  // where its positions begin, in floats
    uint stride;     // floats from one position to the next
    uint indices;    // where its indices begin, in indices
    uint index_bits; // 16 or 32; 0 without indices
    uint key;        // the bits of a key that are the mesh's
    uint key_bits;   // how many bits of a key are its triangles'
    float origin_x;  // see origin_of (src/lent.rs)
    float origin_y;
    float origin_z;
} push;

layout(set = 1, binding = 0, std430) readonly buffer Positions { float positions[]; };
layout(set = 1, binding = 1, std430) readonly buffer Indices { uint indices[]; };

// A vertex number that no buffer holds.
const uint NO_VERTEX = 0xffffffffu;

// The number of the vertex at a corner.
uint vertex_at(uint corner)
{
    if (push.index_bits == 0u) {
        return corner;
    }
    uint at = push.indices + corner;
    uint word = push.index_bits == 16u ? at >> 1u : at;
    if (word >= uint(indices.length())) {
        return NO_VERTEX;
    }
    uint value = indices[word];
    return push.index_bits == 16u ? value >> 16u * (at & 1u) & 0xffffu : value;
}

// Whether a number is neither infinite nor NaN; comparisons alone may be optimized away.
bool is_number(float x)
{
    return (floatBitsToUint(x) & 0x7f800000u) != 0x7f800000u;
}

// The positions of a triangle's corners in mesh space; false where it has none, or one that is not a number.
bool triangle_at(uint triangle, out vec3 corners[3])
{
    corners = vec3[3](vec3(0.0), vec3(0.0), vec3(0.0));
    if (triangle >= push.count) {
        return false;
    }
    uint most = (uint(positions.length()) - min(push.positions, uint(positions.length()))) / push.stride;
    // The last position may end before its stride does.
    uint rest = uint(positions.length()) - min(push.positions + most * push.stride, uint(positions.length()));
    most += rest >= 3u ? 1u : 0u;
    for (int i = 0; i < 3; ++i) {
        uint vertex = vertex_at(3u * triangle + uint(i));
        if (vertex >= most) {
            return false;
        }
        uint at = push.positions + vertex * push.stride;
        for (int axis = 0; axis < 3; ++axis) {
            float x = positions[at + uint(axis)];
            if (!is_number(x)) {
                return false;
            }
            corners[i][axis] = x;
        }
    }
    return true;
}

#endif
