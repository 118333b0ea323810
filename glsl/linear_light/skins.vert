#version 450
#extension GL_GOOGLE_include_directive : require
#include "linear_light/skin.glsl"

// A skin as the sample's neighbour sees it: a row of texels from the occluder to the receiver, by pulling it from a
// buffer: six vertices a skin, no instancing.

layout(set = 0, binding = 0, std430) readonly buffer Skins { vec4 skins[]; };

#include "linear_light/skin_push.glsl"

layout(location = 0) flat out vec4 skin;

void main()
{
    skin = skins[gl_VertexIndex / 6];
    Skin s = Skin(skin.x, skin.y, skin.z, skin.w);
    float w_end = push.rational != 0 ? push.w_far : w_beside(s, push.w_far);
    float at_edge = (s.u_edge + push.apart * s.w_edge) * push.texels_per_u + push.first;
    float at_end = (s.u_edge + push.apart * w_end) * push.texels_per_u + push.first;
    int corner = gl_VertexIndex % 6;
    bool right = corner == 1 || corner == 2 || corner == 4;
    bool lower = corner == 2 || corner == 4 || corner == 5;
    vec2 at = vec2(right ? at_end : at_edge, s.row + (lower ? 1.0 : 0.0));
    gl_Position = vec4(2.0 * at / float(push.map) - 1.0, 0.0, 1.0);
}
