// Entry of the passes linear_light.left_skins and linear_light.right_skins (src/techniques/linear_light/segments.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "linear_light/skin.glsl"
#include "linear_light/line.glsl"

// Expands a skin to a strip of one row of texels in the neighbouring sample's map, from the occluder to the receiver.
// The skin is read from a buffer: six vertices a skin, no instancing.

layout(set = 0, binding = 0, std430) readonly buffer Skins { vec4 skins[]; };
layout(set = 0, binding = 1, std430) readonly buffer SegmentState { Segment segment; };

#include "linear_light/skin_push.glsl"

layout(location = 0) flat out vec4 skin;
layout(location = 1) flat out int layer;

void main()
{
    vec4 pulled = skins[gl_VertexIndex / 6];
    Skin s = Skin(pulled.x, pulled.y, pulled.z, pulled.w);
    bool into_first = push.side < 0;
    vec2 window = window_at(push.u_window, into_first ? segment.along.x : segment.along.y);
    float texels_per_u = float(push.map) / (window.y - window.x);
    // The distance from the sample that the skin is drawn for to the one that saw the edge.
    float apart = float(-push.side) * (segment.along.y - segment.along.x) * push.line;
    float ray = (s.u_edge - window.x) * texels_per_u;
    float step = apart * texels_per_u;
    float w_end = push.rational != 0 ? push.w_far : w_beside(s, push.w_far);
    int corner = gl_VertexIndex % 6;
    bool right = corner == 1 || corner == 2 || corner == 4;
    bool lower = corner == 2 || corner == 4 || corner == 5;
    vec2 at = vec2(ray + step * (right ? w_end : s.w_edge), s.row + (lower ? 1.0 : 0.0));
    gl_Position = vec4(2.0 * at / float(push.map) - 1.0, 0.0, 1.0);
    skin = vec4(ray, step, s.w_edge, w_beside(s, push.w_far));
    layer = into_first ? segment.first : segment.last;
}
