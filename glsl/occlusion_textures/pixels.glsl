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
#include "occlusion_textures/push.glsl"

#ifdef LISTED
#define TILES_A_GROUP 1u
#include "visibility/tile_list.glsl"
layout(set = 0, binding = 6, std430) readonly buffer Tiles { uint count; uint tiles[]; };
layout(set = 0, binding = 7, std430) readonly buffer Met { uint met[]; }; // slices, a bit each, tile by tile
#endif

#endif
