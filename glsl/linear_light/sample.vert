// Entry of the passes linear_light.occluders and linear_light.receivers (src/techniques/linear_light/samples.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "linear_light/line.glsl"
#include "linear_light/view.glsl"

// The meshes as a sample sees them; nothing where there is no such sample.

layout(set = 0, binding = 0, std430) readonly buffer Of { Samples of; };

void main()
{
    vec4 p = seen_from(of.at[push.nth]);
    gl_Position = push.nth < of.count ? p : vec4(2.0, 2.0, 2.0, 1.0);
}
