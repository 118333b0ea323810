// Entry of the pass visibility.lit (src/stages/visibility/mod.rs).
#version 450

// Writes 1 to every pixel, for a frame in which no occluder can shadow anything.

layout(local_size_x = 8, local_size_y = 8) in;

#ifdef COLOR
#define FORMAT rgba32f
#else
#define FORMAT r32f
#endif
layout(set = 0, binding = 0, FORMAT) writeonly uniform image2D visibility;

layout(push_constant) uniform Push {
    ivec2 extent;
} push;

void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    if (p.x < push.extent.x && p.y < push.extent.y) {
        imageStore(visibility, p, vec4(1.0));
    }
}
