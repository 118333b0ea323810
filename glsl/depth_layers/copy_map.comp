// Entry of the passes depth_layers.copy_back and depth_layers.copy_front (src/stages/depth_layers/mod.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// Copies an occluder map that the host drew into a depth layer: near * w, u to the right and v down.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform texture2D map;
layout(set = 0, binding = 1, r32f) uniform writeonly image2D layer;

layout(push_constant) uniform Push {
    ivec2 flip;    // 1: u or v run against the map's x or y
    int side;      // the side of map and layer, texels
    float scale;   // near * w = scale * stored + offset
    float offset;
    float empty;   // the map's value where it was cleared
    float nothing; // a layer's value there
    float most;    // the largest value that a surface may have in the layer
} push;

void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    if (p.x >= push.side || p.y >= push.side) {
        return;
    }
    float stored = texelFetch(map, mix(p, push.side - 1 - p, equal(push.flip, ivec2(1))), 0).x;
    float near_w = clamp(push.scale * stored + push.offset, 0.0, push.most);
    imageStore(layer, p, vec4(stored == push.empty ? push.nothing : near_w));
}
