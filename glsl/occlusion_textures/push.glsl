// The numbers of the passes over the pixels.

#ifndef OCCLUSION_TEXTURES_PUSH_GLSL
#define OCCLUSION_TEXTURES_PUSH_GLSL

layout(push_constant) uniform Push {
    mat4 light_from_ndc;
    vec2 texels_per_uv; // map texels a unit of u and v
    vec2 first;         // texel coordinates of u = v = 0
    vec2 half_light;    // half the light's width and height, m
    ivec2 extent;       // of the G-buffer
    float background;
    float eye;          // how far behind the light the projection point is, m
    int map;            // the map's side in texels
    int flags;          // slices; bit 8: masked; from bit 9 on how slices are combined; bit 12: mip
} push;

int slices() { return push.flags & 255; }
uint all_slices() { return 0xffffffffu >> (32 - slices()); } // a bit each
bool is_masked() { return (push.flags & 256) != 0; }
int combination() { return push.flags >> 9 & 7; }
int level_kind() { return (push.flags & 1 << 12) != 0 ? 2 : 0; } // MIP, N_BUFFER

GBuffer gbuffer()
{
    return GBuffer(push.light_from_ndc, push.extent, push.background, is_masked());
}

MapWindow map_window()
{
    return MapWindow(push.texels_per_uv, push.first, push.eye);
}

#endif
