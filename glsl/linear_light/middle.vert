// Entry of the passes linear_light.middle_occluders and linear_light.middle_receivers (src/techniques/linear_light/samples.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "linear_light/view.glsl"
#ifdef CUT
#include "cut_outs/vertex.glsl"
#endif

// Converts the meshes' vertices to the clip space of the map at the line's middle.

void main()
{
    gl_Position = seen_from(0.5);
#ifdef CUT
    hand_over_place();
#endif
}
