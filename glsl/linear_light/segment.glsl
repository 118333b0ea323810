// Two neighbouring samples of a line, the segment between them, and the maps' windows.

#ifndef LINEAR_LIGHT_SEGMENT_GLSL
#define LINEAR_LIGHT_SEGMENT_GLSL

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

#endif
