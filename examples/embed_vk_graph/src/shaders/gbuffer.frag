#version 450

layout(location = 0) in vec3 normal_ws;
layout(location = 1) in vec3 position_ms;

layout(location = 0) out vec4 normal;
layout(location = 1) out float role;
layout(location = 2) out vec4 plane;

layout(push_constant) uniform Push {
    layout(offset = 64) mat3 world_from_normal;
    layout(offset = 112) float role; // as antumbra reads a mask
} push;

void main()
{
    float length2 = dot(normal_ws, normal_ws);
    normal = vec4(length2 > 0.0 ? normal_ws * inversesqrt(length2) : vec3(0.0), 0.0);
    role = push.role;
    // The triangle's own normal; the node takes either side.
    vec3 across = cross(normalize(dFdx(position_ms)), normalize(dFdy(position_ms)));
    plane = vec4(normalize(push.world_from_normal * across), 0.0);
}
