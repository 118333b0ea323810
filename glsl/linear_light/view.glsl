// Entered from middle.vert and sample.vert.
//
// Converts a mesh's vertices to the clip space of a map on a line, whose eye moves along x alone.

#ifndef LINEAR_LIGHT_VIEW_GLSL
#define LINEAR_LIGHT_VIEW_GLSL

#include "linear_light/line.glsl"

layout(location = 0) in vec3 position;

layout(push_constant) uniform Push {
    mat4 line_from_mesh; // x in metres from the line's middle; y, z and w of clip space; from `origin` on
    vec4 origin;         // see origin_of (src/lent.rs)
    vec4 u_window;       // least and largest u at the line's first end, at its last
    float line;          // the line's length, m
    int nth;             // the sample's number; unused for the middle
} push;

// The clip-space position seen from the place `at`, 0 at the first end and 1 at the last. Depth is near / d.
vec4 seen_from(float at)
{
    vec4 p = push.line_from_mesh * vec4(position - push.origin.xyz, 1.0);
    vec2 window = window_at(push.u_window, at);
    p.x = (2.0 * (p.x - (at - 0.5) * push.line) - (window.x + window.y) * p.w) / (window.y - window.x);
    return p;
}

#endif
