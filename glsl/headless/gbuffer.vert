#version 450

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;

layout(push_constant) uniform Push {
    mat4 clip_from_mesh;
    mat4x3 world_from_mesh; // four columns of three, 16 bytes apart
    // Behind them for the fragment stage: in bits 0 to 7 the role (255 blocks and receives, 128 receives only, 0 only
    // blocks), in bits 8 and 9 which faces are not seen (0 none, 1 those whose corners run counter-clockwise in the image,
    // 2 the others).
} push;

layout(location = 0) out vec3 from_origin;
layout(location = 1) out vec3 normal_ws;

#ifdef CUT
layout(set = 0, binding = 0, std430) readonly buffer Coordinates { vec2 coordinates[]; };

layout(location = 2) out vec2 place;
#endif

void main()
{
    mat3 m = mat3(push.world_from_mesh);
    from_origin = m * position;
    // The cofactors turn normals right under any scale. Those of a mirroring transform point the other way, as do the
    // fronts of its triangles (harness/src/painter.rs), and the fragment stage turns both towards the viewer.
    normal_ws = mat3(cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1])) * normal;
    gl_Position = push.clip_from_mesh * vec4(position, 1.0);
#ifdef CUT
    place = coordinates[gl_VertexIndex];
#endif
}
