// What a draw of skins knows of the map that they are drawn into.

#ifndef LINEAR_LIGHT_SKIN_PUSH_GLSL
#define LINEAR_LIGHT_SKIN_PUSH_GLSL

layout(push_constant) uniform Push {
    float texels_per_u;
    float first;    // texel coordinate of u = 0
    float apart;    // from its sample to the one that saw the skins, m along x
    float w_far;    // no receiver is further than 1/w_far
    float inv_near; // 1 over the map's near plane, 1/m
    int map;        // its side in texels
    int slot;       // where it is
    int rational;   // 1: by the w of what is behind; 0: by that of what lies beside the edge
} push;

#endif
