#version 450

layout(location = 0) in vec3 normal_ws;

layout(location = 0) out vec4 normal;
layout(location = 1) out float role;

layout(push_constant) uniform Push {
    layout(offset = 112) float role; // as antumbra reads a mask
} push;

void main()
{
    float length2 = dot(normal_ws, normal_ws);
    normal = vec4(length2 > 0.0 ? normal_ws * inversesqrt(length2) : vec3(0.0), 0.0);
    role = push.role;
}
