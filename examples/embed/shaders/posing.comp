#version 450

// Poses one mesh, a vertex an invocation: morph targets first, then the mean of the joints' matrices by the vertex's
// weights, as glTF 2.0 has it (sections 3.7.2.2 and 3.7.3).

layout(local_size_x = 64) in;

struct Influence {
    uint joint;
    float weight; // those of one vertex add up to 1
};

// A vertex is six floats, here and in the vertex buffers that are drawn: its position, then its normal. Behind all vertices
// at rest follows what each morph target adds to them. (Every device has the four storage buffers of this pass.)
layout(std430, set = 0, binding = 0) readonly buffer Rest { float rest[]; };
layout(std430, set = 0, binding = 1) readonly buffer Influences { Influence influences[]; };
// Three rows of each joint's matrix, from the rest pose to this frame's, then the targets' weights, four a vector.
layout(std430, set = 0, binding = 2) readonly buffer Pose { vec4 pose[]; };
layout(std430, set = 0, binding = 3) writeonly buffer Posed { float posed[]; };

layout(push_constant) uniform Push {
    uint vertices;
    uint influences; // of a vertex
    uint joints;
    uint targets;
} push;

void main()
{
    uint vertex = gl_GlobalInvocationID.x;
    if (vertex >= push.vertices) {
        return;
    }
    uint at = 6 * vertex;
    vec3 position = vec3(rest[at], rest[at + 1], rest[at + 2]);
    vec3 normal = vec3(rest[at + 3], rest[at + 4], rest[at + 5]);
    for (uint target = 0; target < push.targets; ++target) {
        float weight = pose[3 * push.joints + target / 4][target % 4];
        uint added = 6 * push.vertices * (target + 1) + at;
        position += weight * vec3(rest[added], rest[added + 1], rest[added + 2]);
        normal += weight * vec3(rest[added + 3], rest[added + 4], rest[added + 5]);
    }

    vec4 rows[3] = vec4[3](vec4(0.0), vec4(0.0), vec4(0.0));
    for (uint i = 0; i < push.influences; ++i) {
        Influence influence = influences[push.influences * vertex + i];
        for (uint row = 0; row < 3; ++row) {
            rows[row] += influence.weight * pose[3 * influence.joint + row];
        }
    }
    vec4 from = vec4(position, 1.0);
    position = vec3(dot(rows[0], from), dot(rows[1], from), dot(rows[2], from));

    // The cofactors are the inverse's transpose but for a factor, whose sign is the determinant's.
    vec3 x = cross(rows[1].xyz, rows[2].xyz);
    vec3 y = cross(rows[2].xyz, rows[0].xyz);
    vec3 z = cross(rows[0].xyz, rows[1].xyz);
    normal = vec3(dot(x, normal), dot(y, normal), dot(z, normal)) * sign(dot(rows[0].xyz, x));
    float size = length(normal);
    normal = size > 0.0 ? normal / size : vec3(0.0);

    posed[at] = position.x;
    posed[at + 1] = position.y;
    posed[at + 2] = position.z;
    posed[at + 3] = normal.x;
    posed[at + 4] = normal.y;
    posed[at + 5] = normal.z;
}
