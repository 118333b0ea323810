#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "linear_light/skin.glsl"

// What a surface behind a skin sees of the segment, half of it as depth: of all skins the depth test keeps the one
// that hides most. 1 stays where there is none.

layout(set = 0, binding = 1) uniform texture2D occluders_0;
layout(set = 0, binding = 2) uniform texture2D receivers_0;
layout(set = 0, binding = 3) uniform texture2D occluders_1;
layout(set = 0, binding = 4) uniform texture2D receivers_1;

#include "linear_light/slots.glsl"
#include "linear_light/skin_push.glsl"

layout(location = 0) flat in vec4 skin;

void main()
{
    ivec2 p = ivec2(gl_FragCoord.xy);
    Skin s = Skin(skin.x, skin.y, skin.z, skin.w);
    float u = (float(p.x) + 0.5 - push.first) / push.texels_per_u;
    float w_crossing = crossing_of(s, u, push.apart);
    float w_receiver = surface_at(push.slot, p) * push.inv_near;
    // What lies in front of the skin sees past it.
    if (w_receiver >= w_crossing) {
        discard;
    }
    float seen = transition(s.w_edge, w_crossing, push.rational != 0 ? w_receiver : w_beside(s, push.w_far));
    gl_FragDepth = 0.5 * seen;
}
