#version 450

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;

layout(push_constant) uniform Push {
    mat4 clip_from_mesh;
    mat3 world_from_normal;
    layout(offset = 116) float swell; // of a jelly, in metres
    layout(offset = 120) float phase; // and where it is in its swing
} push;

layout(location = 0) out vec3 normal_ws;
layout(location = 1) out vec3 position_ms;

void main()
{
    normal_ws = push.world_from_normal * normal;
    vec3 moved = position + normal * (push.swell * sin(push.phase + 9.0 * position.y));
    position_ms = moved;
    gl_Position = push.clip_from_mesh * vec4(moved, 1.0);
}
