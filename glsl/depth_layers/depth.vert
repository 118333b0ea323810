// Entry of the passes depth_layers.front, depth_layers.back, occlusion_textures.slices and others (src/stages/depth_layers/mod.rs).
#version 450
#extension GL_GOOGLE_include_directive : require

// Converts positions to a light-space map's clip space; the depth that results is near / d.

#ifdef CUT
#include "cut_outs/vertex.glsl"
#endif

layout(location = 0) in vec3 position;

layout(push_constant) uniform Push {
    mat4 clip_from_mesh; // from `origin` on
    vec4 origin;         // see origin_of (src/lent.rs)
} push;

void main()
{
    gl_Position = push.clip_from_mesh * vec4(position - push.origin.xyz, 1.0);
#ifdef CUT
    hand_over_place();
#endif
}
