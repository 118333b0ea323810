// Entry of the pass half.visibility (src/techniques/half/mod.rs).
#version 450

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0, r32f) writeonly uniform image2D visibility;

layout(push_constant) uniform Push {
    ivec2 extent;
} push;

void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    if (p.x < push.extent.x && p.y < push.extent.y) {
        imageStore(visibility, p, vec4(0.5));
    }
}
