#version 450
#extension GL_GOOGLE_include_directive : require
#include "linear_light/tree.glsl"

// As depth_layers/depth.vert, and nothing where the node is not open.

layout(set = 0, binding = 0, std430) readonly buffer Tree {
    float left;
    Node nodes[NODES];
};

layout(location = 0) in vec3 position;

layout(push_constant) uniform Push {
    mat4 clip_from_mesh;
    int node;
} push;

void main()
{
    vec4 clip = push.clip_from_mesh * vec4(position, 1.0);
    gl_Position = nodes[push.node].open != 0u ? clip : vec4(2.0, 2.0, 2.0, 1.0);
}
