// Entry of the pass ray_march.start (src/techniques/ray_march/passes.rs).
#version 450

// Empties the list of pixels, and writes the matrix that the passes over the list need and have no push constants for.

layout(local_size_x = 1) in;

layout(set = 0, binding = 0, std430) buffer Arguments { uint groups[4]; };
layout(set = 0, binding = 1, std430) buffer Pixels {
    uint count;
    uint none[3];
    mat4 ndc_from_light;
    vec2 corners[16];
    uvec2 pieces[16];
    uint pixels[];
};

layout(push_constant) uniform Push {
    mat4 ndc_from_light;
} push;

void main()
{
    groups[0] = 0u;
    groups[1] = 0u;
    groups[2] = 1u;
    count = 0u;
    ndc_from_light = push.ndc_from_light;
}
