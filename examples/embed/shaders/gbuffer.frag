#version 450

layout(location = 0) in vec3 normal_ws;
layout(location = 1) in vec3 position_ms;

layout(location = 0) out vec4 albedo;
layout(location = 1) out vec4 normal;
layout(location = 2) out float role;
layout(location = 3) out vec4 plane;

layout(push_constant) uniform Push {
    layout(offset = 64) mat3 world_from_normal;
    layout(offset = 112) uint albedo_role; // bytes r, g, b; the fourth as antumbra reads a mask
} push;

void main()
{
    vec4 material = unpackUnorm4x8(push.albedo_role);
    albedo = vec4(material.rgb, 1.0);
    normal = vec4(normalize(normal_ws), 0.0);
    role = material.a;
    // The triangle's own normal; the node takes either side.
    vec3 across = cross(normalize(dFdx(position_ms)), normalize(dFdy(position_ms)));
    plane = vec4(normalize(push.world_from_normal * across), 0.0);
}
