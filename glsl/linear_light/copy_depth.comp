// Entry of the passes linear_light.middle_copy and linear_light.copy (src/techniques/linear_light/samples.rs).
#version 450
#extension GL_EXT_samplerless_texture_functions : require

// Copies the depths that a sample sees into its layer of `seen`: the w of the nearest occluder and of the nearest
// receiver, 0 where there is none.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform texture2D occluders;
layout(set = 0, binding = 1) uniform texture2D receivers;
layout(set = 0, binding = 2, rgba32f) writeonly uniform image2DArray seen;

layout(push_constant) uniform Push {
    float inv_near; // 1 over the map's near plane, 1/m: the depth stored is near times w
    int map;        // the map's side in texels
    int layer;      // the layer of `seen` to write
} push;

void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    if (p.x >= push.map || p.y >= push.map) {
        return;
    }
    vec2 w = push.inv_near * vec2(texelFetch(occluders, p, 0).x, texelFetch(receivers, p, 0).x);
    imageStore(seen, ivec3(p, push.layer), vec4(w, 0.0, 0.0));
}
