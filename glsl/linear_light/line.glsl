// Entered from start.comp, keep.comp, visibility.comp, view.glsl and others.
//
// A line of the light: its samples, its segments, and how images and buffers hold them.

#ifndef LINEAR_LIGHT_LINE_GLSL
#define LINEAR_LIGHT_LINE_GLSL

// ---------------------------------------------------------------------------------------------
// The image of a light's lines and their samples, a row a line, as pixels ask for them:
//   0     the line's x along the light's x and y; its middle, m
//   1     least and largest u at its first end, at its last
//   2     least and largest v; its length, m; its share of the light
//   3     the number of its samples
//   4...  of each: how far along it is, 0 to 1

const int SAMPLES_AT = 4;

// ---------------------------------------------------------------------------------------------
// Where the samples of a line are, in their order, 0 at its first end and 1 at its last.

const int MOST_SAMPLES = 16;

struct Samples {
    int count;
    float at[MOST_SAMPLES];
};

// ---------------------------------------------------------------------------------------------
// Two neighbouring samples of a line, the segment between them, and the maps' windows.

struct Segment {
    vec2 along; // of its two samples, 0 to 1
    int first;  // the first one's layer of what is seen
    int last;   // the last one's
};

// Least and largest tangent of the map of a sample, from those at the line's ends: what bounds boxes' tangents from
// below is a concave function of the sample's place, and from above a convex one, so a straight line holds them all.
vec2 window_at(vec4 u_window, float along)
{
    return mix(u_window.xy, u_window.zw, along);
}

// ---------------------------------------------------------------------------------------------
// The channels of a sample's two segments in one float.

// Steps of the part of a segment that is seen. Two channels are a whole number below 2^24, which a float holds.
const float STEPS = 2047.0;

// Where no skin was drawn.
const float CLEAR = 4095.0;

// Each from 0 to 1, 1 where no skin was drawn; they come back within half a step.
float packed(vec2 drawn)
{
    vec2 whole = mix(floor(drawn * STEPS + 0.5), vec2(CLEAR), equal(drawn, vec2(1.0)));
    return whole.x * (CLEAR + 1.0) + whole.y;
}

// What a skin says of either segment, 0 where there is none, and in z and w 1 where there is none.
vec4 unpacked(float both)
{
    float first = floor(both / (CLEAR + 1.0));
    vec2 whole = vec2(first, both - first * (CLEAR + 1.0));
    vec2 none = vec2(equal(whole, vec2(CLEAR)));
    return vec4(whole / STEPS * (1.0 - none), none);
}

// The part of a segment that a receiver sees, by what its first and its last sample tell of it (in x what skins say, in
// y how far there are none) and how far either sees the receiver, 0 to 1. A sample that sees past everything adds half
// of the segment (section 3.2), and all of it where the other one is hidden.
float part_of_segment(vec2 first, vec2 last, vec2 see)
{
    vec2 clear = vec2(first.y, last.y) * (1.0 - 0.5 * see.yx);
    return min(first.x + last.x + clear.x + clear.y, 1.0);
}

#endif
