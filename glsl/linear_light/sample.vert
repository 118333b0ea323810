// Entry of the passes linear_light.occluders and linear_light.receivers (src/techniques/linear_light/samples.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "linear_light/line.glsl"
#include "linear_light/view.glsl"
#ifdef CUT
#include "cut_outs/vertex.glsl"
#endif

// Converts the meshes' vertices to the clip space of a sample's map; nothing is drawn where there is no such sample.

layout(set = 0, binding = 0, std430) readonly buffer Placed { Samples samples; };

void main()
{
    vec4 p = seen_from(samples.at[push.nth]);
    gl_Position = push.nth < samples.count ? p : vec4(2.0, 2.0, 2.0, 1.0);
#ifdef CUT
    hand_over_place();
#endif
}
