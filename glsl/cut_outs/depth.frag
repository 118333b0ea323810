// Entry of the passes depth_layers.front, many_lights.point_depth, linear_light.occluders and others (src/stages/depth_layers/mod.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "cut_outs/image.glsl"

// Draws the depth of meshes that textures cut out.

void main()
{
    if (lets_through()) {
        discard;
    }
}
