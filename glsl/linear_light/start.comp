// Entry of the pass linear_light.start (src/techniques/linear_light/segments.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "linear_light/line.glsl"

// Begins the nth sample of a line and the segment before it: writes the state that the following passes and the pixels
// read, the workgroups of those passes (0 where there is no such sample), and the arguments of two draws without skins.

layout(local_size_x = 1) in;

layout(set = 0, binding = 0, std430) readonly buffer Placed { Samples samples; };
layout(set = 0, binding = 1, std430) buffer SegmentState { Segment segment; };
layout(set = 0, binding = 2, std430) buffer Draws { uint draws[8]; };    // left, right
layout(set = 0, binding = 3, std430) buffer Groups { uint groups[12]; }; // for the sample, segment, sample before
layout(set = 0, binding = 4, rgba32f) writeonly uniform image2D places;

layout(push_constant) uniform Push {
    vec4 turn;     // the line's x along the light's x and y; its middle, m
    vec4 u_window; // least and largest u at the line's first end, at its last
    vec2 v_window; // least and largest v
    float line;    // the line's length, m
    float weight;  // the line's share of the light
    int nth;       // the sample's number
    int row;       // the line's row of `places`
    int groups;    // workgroups along a map's side
} push;

void main()
{
    int nth = push.nth;
    bool has_sample = nth < samples.count;
    bool has_previous = nth > 0 && nth - 1 < samples.count;
    for (int i = 0; i < 4; ++i) {
        draws[i] = i == 1 ? 1u : 0u;
        draws[4 + i] = i == 1 ? 1u : 0u;
        uint many = i < 2 ? uint(push.groups) : 1u;
        groups[i] = has_sample ? many : 0u;
        groups[4 + i] = has_sample && has_previous ? many : 0u;
        groups[8 + i] = has_previous ? many : 0u;
    }
    float at = has_sample ? samples.at[nth] : 0.0;
    float previous = has_previous ? samples.at[nth - 1] : 0.0;
    // Samples that lie side by side take turns in two layers.
    Segment s;
    s.along = vec2(previous, at);
    s.first = (nth - 1) & 1;
    s.last = nth & 1;
    segment = s;
    if (nth == 0) {
        imageStore(places, ivec2(0, push.row), push.turn);
        imageStore(places, ivec2(1, push.row), push.u_window);
        imageStore(places, ivec2(2, push.row), vec4(push.v_window, push.line, push.weight));
        imageStore(places, ivec2(3, push.row), vec4(float(samples.count), 0.0, 0.0, 0.0));
    }
    if (has_previous) {
        imageStore(places, ivec2(SAMPLES_AT + nth - 1, push.row), vec4(previous, 0.0, 0.0, 0.0));
    }
}
