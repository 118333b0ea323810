// Entry of the pass depth_layers.middle_back (src/stages/depth_layers/mod.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// Leaves out the faces that lie before those of another layer, as the projection point sees them. A face that is both
// layers' has no matter behind it: it is a sheet.

#ifdef CUT
#include "cut_outs/image.glsl"
#endif

layout(set = 0, binding = 0) uniform texture2D nearer;

void main()
{
    if (gl_FragCoord.z > texelFetch(nearer, ivec2(gl_FragCoord.xy), 0).x) {
        discard;
    }
#ifdef CUT
    if (lets_through()) {
        discard;
    }
#endif
}
