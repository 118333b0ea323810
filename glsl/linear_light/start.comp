// Entry of the pass linear_light.start (src/techniques/linear_light/segments.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "linear_light/line.glsl"

// The nth sample of a line and the segment before it: what the passes that follow and the pixels must know of them,
// and which of those passes there are. No skins yet: the arguments of two draws.

layout(local_size_x = 1) in;

layout(set = 0, binding = 0, std430) readonly buffer Of { Samples of; };
layout(set = 0, binding = 1, std430) buffer Here { Segment here; };
layout(set = 0, binding = 2, std430) buffer Draws { uint draws[8]; };    // left, right
layout(set = 0, binding = 3, std430) buffer Groups { uint groups[12]; }; // of the sample, segment, sample before
layout(set = 0, binding = 4, rgba32f) writeonly uniform image2D places;

layout(push_constant) uniform Push {
    vec4 turn;     // the line's x along the light's x and y; its middle, m
    vec4 u_window; // least and largest u at the line's first end, at its last
    vec2 v_window; // least and largest v
    float line;    // its length, m
    float weight;  // its share of the light
    int nth;       // sample
    int row;       // of places
    int groups;    // along a side of a map
} push;

void main()
{
    int nth = push.nth;
    bool here_is = nth < of.count;
    bool before_is = nth > 0 && nth - 1 < of.count;
    for (int i = 0; i < 4; ++i) {
        draws[i] = i == 1 ? 1u : 0u;
        draws[4 + i] = i == 1 ? 1u : 0u;
        uint many = i < 2 ? uint(push.groups) : 1u;
        groups[i] = here_is ? many : 0u;
        groups[4 + i] = here_is && before_is ? many : 0u;
        groups[8 + i] = before_is ? many : 0u;
    }
    float at = here_is ? of.at[nth] : 0.0;
    float previous = before_is ? of.at[nth - 1] : 0.0;
    // Samples that lie side by side take turns in two layers.
    Segment s;
    s.along = vec2(previous, at);
    s.first = (nth - 1) & 1;
    s.last = nth & 1;
    here = s;
    if (nth == 0) {
        imageStore(places, ivec2(0, push.row), push.turn);
        imageStore(places, ivec2(1, push.row), push.u_window);
        imageStore(places, ivec2(2, push.row), vec4(push.v_window, push.line, push.weight));
        imageStore(places, ivec2(3, push.row), vec4(float(of.count), 0.0, 0.0, 0.0));
    }
    if (before_is) {
        imageStore(places, ivec2(SAMPLES_AT + nth - 1, push.row), vec4(previous, 0.0, 0.0, 0.0));
    }
}
