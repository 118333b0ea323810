// The numbers of the techniques with one occluder map.

#ifndef COMMON_PUSH_GLSL
#define COMMON_PUSH_GLSL

layout(push_constant) uniform Push {
    mat4 light_from_ndc;
    vec2 texels_per_uv; // map texels a unit of u and v
    vec2 first;         // texel coordinates of u = v = 0
    vec2 half_light;    // half the light's width and height, m
    ivec2 extent;       // of the G-buffer
    float background;
    float inv_near;     // 1 over the map's near plane, 1/m; no occluder is nearer
    float snap;         // how far a raster moves a vertex, in texels
    float depth_error;  // how far off an occluder's w may be beyond its rounding, 1/m
    int map;            // the map's side in texels
    int masked;
    int count;          // of taps or levels
} push;

GBuffer gbuffer()
{
    return GBuffer(push.light_from_ndc, push.extent, push.background, push.masked != 0);
}

#endif
