#version 450

layout(location = 0) in vec3 position_ws;
layout(location = 1) in vec3 normal_ws;

layout(location = 0) out vec4 position;
layout(location = 1) out vec4 normal;
layout(location = 2) out float role;
layout(location = 3) out vec4 plane;

layout(push_constant) uniform Push {
    layout(offset = 124) float role; // 1 blocks and receives, 1/2 receives only, 0 only blocks
} push;

void main()
{
    position = vec4(position_ws, 1.0);
    float length2 = dot(normal_ws, normal_ws);
    normal = vec4(length2 > 0.0 ? normal_ws * inversesqrt(length2) : vec3(0.0), 0.0);
    role = push.role;
    // The triangle's own normal.
    plane = vec4(normalize(cross(normalize(dFdx(position_ws)), normalize(dFdy(position_ws)))), 0.0);
}
