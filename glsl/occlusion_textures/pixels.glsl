// What the passes over the pixels have in common: their inputs.

#ifndef OCCLUSION_TEXTURES_PIXELS_GLSL
#define OCCLUSION_TEXTURES_PIXELS_GLSL

#ifdef CORRELATED
const bool IS_CORRELATED = true;
#else
const bool IS_CORRELATED = false;
#endif

#include "occlusion_textures/tile.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform texture2D gbuffer_depth;
layout(set = 0, binding = 1) uniform texture2D gbuffer_mask;
layout(set = 0, binding = 2) uniform texture2D placement;
layout(set = 0, binding = 4, r32f) writeonly uniform image2D visibility;

#include "common/gbuffer.glsl"
#include "common/light.glsl"
#include "occlusion_textures/placement.glsl"
#include "occlusion_textures/kernel.glsl"
#include "occlusion_textures/combine.glsl"

layout(push_constant) uniform Push {
    mat4 light_from_ndc;
    vec2 texels_per_uv; // map texels a unit of u and v
    vec2 first;         // texel coordinates of u = v = 0
    vec2 half_light;    // half the light's width and height, m
    ivec2 extent;       // of the G-buffer
    float background;
    float eye;          // how far behind the light the projection point is, m
    int map;            // the map's side in texels
    int flags;          // slices; bit 8: masked; from bit 9 on how slices are combined; bit 12: mip
} push;

int slices() { return push.flags & 255; }
bool is_masked() { return (push.flags & 256) != 0; }
int combination() { return push.flags >> 9 & 7; }
int level_kind() { return (push.flags & 1 << 12) != 0 ? 2 : 0; } // MIP, N_BUFFER

#endif
