#version 450
#extension GL_GOOGLE_include_directive : require
#include "linear_light/tree.glsl"
#include "linear_light/segment.glsl"

// The nth sample of a line and the segment behind it: what the passes that follow and the pixels must know of them.
// No skins yet: the arguments of two draws.

layout(local_size_x = 1) in;

layout(set = 0, binding = 0, std430) readonly buffer Tree {
    float left;
    Node nodes[NODES];
};
layout(set = 0, binding = 1, std430) buffer Here { Segment here; };
layout(set = 0, binding = 2, std430) buffer Left { uint left_draw[4]; };
layout(set = 0, binding = 3, std430) buffer Right { uint right_draw[4]; };
layout(set = 0, binding = 4, rgba32f) writeonly uniform image2D places;

#include "linear_light/places.glsl"

layout(push_constant) uniform Push {
    vec4 turn;     // the line's x along the light's x and y; its middle, m
    vec4 u_window; // least and largest u at the line's first end, at its last
    vec2 v_window; // least and largest v
    float line;    // its length, m
    float weight;  // its share of the light
    int nth;       // sample
    int row;       // of places
    int even;      // so many samples evenly; 0: as the tree has them
    int rounds;
} push;

// The layer of the nth sample, its place and how many there are.
int find(int nth, out float along, out int count)
{
    along = 0.0;
    if (push.even > 0) {
        count = push.even;
        along = float(nth) / float(count - 1);
        // Samples that lie side by side take turns in two layers.
        return nth >= 0 && nth < count ? nth & 1 : -1;
    }
    int found = -1;
    count = 0;
    for (int i = 0; i <= 1 << push.rounds; ++i) {
        int node = node_at(i, push.rounds);
        if (nodes[node].taken != 0u) {
            if (count == nth) {
                found = node;
                along = along_of(node);
            }
            count += 1;
        }
    }
    return found;
}

void main()
{
    left_draw[0] = 0u;
    left_draw[1] = 1u;
    left_draw[2] = 0u;
    left_draw[3] = 0u;
    right_draw[0] = 0u;
    right_draw[1] = 1u;
    right_draw[2] = 0u;
    right_draw[3] = 0u;
    int count;
    float at;
    float next;
    float previous;
    int first = find(push.nth, at, count);
    int last = find(push.nth + 1, next, count);
    int before = find(push.nth - 1, previous, count);
    Segment s;
    s.along = vec2(at, next);
    s.first = first;
    s.last = last;
    s.before = before < 0 || first < 0 ? 0.0 : at - previous;
    s.pad_0 = 0.0;
    s.pad_1 = 0.0;
    s.pad_2 = 0.0;
    here = s;
    if (push.nth == 0) {
        imageStore(places, ivec2(0, push.row), push.turn);
        imageStore(places, ivec2(1, push.row), push.u_window);
        imageStore(places, ivec2(2, push.row), vec4(push.v_window, push.line, push.weight));
        imageStore(places, ivec2(3, push.row), vec4(float(count), 0.0, 0.0, 0.0));
    }
    // Where nothing blocks, both ends of a segment see half of it.
    float free = 0.5 * (s.before + (last < 0 ? 0.0 : next - at));
    imageStore(places, ivec2(SAMPLES_AT + push.nth, push.row), vec4(at, free, 0.0, 0.0));
}
