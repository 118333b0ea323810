#version 450

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;

layout(push_constant) uniform Push {
    mat4 clip_from_mesh;
    mat4x3 world_from_mesh; // four columns of three, 16 bytes apart
} push;

layout(location = 0) out vec3 position_ws;
layout(location = 1) out vec3 normal_ws;

void main()
{
    mat3 m = mat3(push.world_from_mesh);
    position_ws = m * position + push.world_from_mesh[3];
    // The cofactors turn normals right under any scale, mirrored ones included.
    normal_ws = mat3(cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1])) * normal;
    gl_Position = push.clip_from_mesh * vec4(position, 1.0);
}
