// Entered from skins.vert and skins.frag.
//
// The push constants of a draw of skins.

#ifndef LINEAR_LIGHT_SKIN_PUSH_GLSL
#define LINEAR_LIGHT_SKIN_PUSH_GLSL

layout(push_constant) uniform Push {
    vec4 u_window; // least and largest u at the line's first end, at its last
    float line;    // the line's length, m
    float w_far;   // no receiver is further than 1/w_far
    int map;       // the maps' side in texels
    int side;      // -1: skins of the last sample, drawn into the first one's channel; 1: the other way round
    int rational;  // 1: transition by the w of the surface behind the skin; 0: by that of the surface beside the edge
} push;

#endif
