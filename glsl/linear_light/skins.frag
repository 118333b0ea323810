// Entry of the passes linear_light.left_skins and linear_light.right_skins (src/techniques/linear_light/segments.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "linear_light/skin.glsl"

// Writes the part of the segment that a surface behind a skin sees, as depth: the depth test keeps the skin that hides
// most. Texels without a skin keep 1.

layout(set = 0, binding = 2) uniform texture2DArray seen;

#include "linear_light/skin_push.glsl"

layout(location = 0) flat in vec4 skin;
layout(location = 1) flat in int layer;

void main()
{
    ivec2 p = ivec2(gl_FragCoord.xy);
    float w_crossing = crossing_of(skin.x, float(p.x) + 0.5, skin.y);
    vec2 w = texelFetch(seen, ivec3(p, layer), 0).xy;
    float w_receiver = max(w.x, w.y);
    // A surface in front of the skin is not shadowed by it.
    if (w_receiver >= w_crossing) {
        discard;
    }
    gl_FragDepth = transition(skin.z, w_crossing, push.rational != 0 ? w_receiver : skin.w);
}
