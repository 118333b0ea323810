// Entered from skins.vert and skins.frag.
//
// What a draw of skins knows of the maps.

#ifndef LINEAR_LIGHT_SKIN_PUSH_GLSL
#define LINEAR_LIGHT_SKIN_PUSH_GLSL

layout(push_constant) uniform Push {
    vec4 u_window; // least and largest u at the line's first end, at its last
    float line;    // its length, m
    float w_far;   // no receiver is further than 1/w_far
    int map;       // the maps' side in texels
    int side;      // -1: skins that the last sample saw, as the first one sees them; 1: the other way round
    int rational;  // 1: by the w of what is behind; 0: by that of what lies beside the edge
} push;

#endif
