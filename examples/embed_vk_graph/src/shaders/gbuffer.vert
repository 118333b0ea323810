#version 450

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;

layout(push_constant) uniform Push {
    mat4 clip_from_mesh;
    mat3 world_from_normal;
} push;

layout(location = 0) out vec3 normal_ws;
layout(location = 1) out vec3 position_ms;

void main()
{
    normal_ws = push.world_from_normal * normal;
    position_ms = position;
    gl_Position = push.clip_from_mesh * vec4(position, 1.0);
}
