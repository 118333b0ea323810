// Entry of the passes that draw depth alone, for meshes that textures cut out (src/stages/depth_layers/mod.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "cut_outs/image.glsl"

void main()
{
    if (lets_through()) {
        discard;
    }
}
