#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#ifdef CUT
#include "cut_outs/cut_out.glsl"
#endif

// A pixel of the G-buffer. The back of a single-sided face is not seen; that of a double-sided one has the normal
// of its front turned round (glTF 2.0 section 3.9.6, doubleSided).

layout(location = 0) in vec3 from_origin; // in the world's axes, from where the mesh's origin is
layout(location = 1) in vec3 normal_ws;

layout(location = 0) out vec4 position;
layout(location = 1) out vec4 normal;
layout(location = 2) out float role;
layout(location = 3) out vec4 plane;

#ifdef CUT
layout(set = 0, binding = 1) uniform texture2D opacities;
layout(set = 0, binding = 2, std430) readonly buffer CutOuts { CutOut cut_out; };

layout(location = 2) in vec2 place;

// A pixel shows one surface: one that stops half of the light or more.
bool is_seen()
{
    Texels t = texels_at(place, textureSize(opacities, 0), cut_out.bits);
    vec4 found = vec4(texelFetch(opacities, t.low, 0).w, texelFetch(opacities, ivec2(t.high.x, t.low.y), 0).w,
                      texelFetch(opacities, ivec2(t.low.x, t.high.y), 0).w, texelFetch(opacities, t.high, 0).w);
    return stops(between(t, found), cut_out.u.w, cut_out.bits, 0.5);
}
#endif

layout(push_constant) uniform Push {
    layout(offset = 112) vec3 origin_ws;
    layout(offset = 124) uint mesh; // see gbuffer.vert
} push;

void main()
{
    // The triangle's own normal, towards the viewer. Differences of world positions would not do far from the world's
    // origin, where neighbouring pixels have the same.
    plane = vec4(normalize(cross(normalize(dFdy(from_origin)), normalize(dFdx(from_origin)))), 0.0);
    uint hidden = push.mesh >> 8u & 3u;
    if (hidden == (gl_FrontFacing ? 1u : 2u)) {
        discard;
    }
#ifdef CUT
    if (!is_seen()) {
        discard;
    }
#endif
    position = vec4(push.origin_ws + from_origin, 1.0);
    float length2 = dot(normal_ws, normal_ws);
    normal = vec4(length2 > 0.0 ? normal_ws * inversesqrt(length2) : vec3(0.0), 0.0);
    normal *= gl_FrontFacing ? 1.0 : -1.0;
    role = float(push.mesh & 255u) / 255.0;
}
