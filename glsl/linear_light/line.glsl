// Entered from start.comp, keep.comp, visibility.comp, view.glsl and others.
//
// A line of the light: its samples, its segments, and how images and buffers hold them.

#ifndef LINEAR_LIGHT_LINE_GLSL
#define LINEAR_LIGHT_LINE_GLSL

// ---------------------------------------------------------------------------------------------
// The image of a light's lines and their samples that pixels read. Each row of texels holds one line:
//   0     the line's x along the light's x and y; its middle, m
//   1     least and largest u at its first end, at its last
//   2     least and largest v; its length, m; its share of the light
//   3     the number of its samples
//   4...  each sample's place along the line, 0 to 1

const int SAMPLES_AT = 4;

// ---------------------------------------------------------------------------------------------
// The places of a line's samples, in ascending order: 0 is its first end, 1 its last.

const int MOST_SAMPLES = 16;

struct Samples {
    int count;
    float at[MOST_SAMPLES];
};

// ---------------------------------------------------------------------------------------------
// Two neighbouring samples of a line, the segment between them, and the maps' windows.

struct Segment {
    vec2 along; // the places of its two samples, 0 to 1
    int first;  // the first sample's layer of the image `seen`
    int last;   // the last sample's layer
};

// The least and largest tangent of a sample's map, interpolated between those at the line's ends. The least tangent of
// a box is a concave function of the sample's place, the largest a convex one, so that the interpolated window holds
// every box.
vec2 window_at(vec4 u_window, float along)
{
    return mix(u_window.xy, u_window.zw, along);
}

// ---------------------------------------------------------------------------------------------
// The channels of a sample's two segments in one float.

// Steps of the part of a segment that is seen. Two channels are a whole number below 2^24, which a float holds.
const float STEPS = 2047.0;

// The value of a channel in which no skin was drawn.
const float CLEAR = 4095.0;

// Packs two channels from 0 to 1, where 1 is no skin; they come back within half a step.
float packed(vec2 drawn)
{
    vec2 whole = mix(floor(drawn * STEPS + 0.5), vec2(CLEAR), equal(drawn, vec2(1.0)));
    return whole.x * (CLEAR + 1.0) + whole.y;
}

// Unpacks two channels: in x and y the visible part of either segment by its skin, 0 where there is no skin; in z and w
// 1 where there is no skin, else 0.
vec4 unpacked(float both)
{
    float first = floor(both / (CLEAR + 1.0));
    vec2 whole = vec2(first, both - first * (CLEAR + 1.0));
    vec2 none = vec2(equal(whole, vec2(CLEAR)));
    return vec4(whole / STEPS * (1.0 - none), none);
}

// The part of a segment that a receiver sees. `first` and `last` are its samples' channels: in x the part by skins, in
// y the weight of texels without one. `see` is how far either sample sees the receiver, 0 to 1. A sample without skins
// adds half of the segment (section 3.2), and all of it where the other sample does not see the receiver.
float part_of_segment(vec2 first, vec2 last, vec2 see)
{
    vec2 clear = vec2(first.y, last.y) * (1.0 - 0.5 * see.yx);
    return min(first.x + last.x + clear.x + clear.y, 1.0);
}

#endif
