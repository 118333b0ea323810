// Entry of the pass linear_light.spread (src/techniques/linear_light/samples.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "linear_light/line.glsl"

// Places samples evenly along a line, ends included.

layout(local_size_x = 16) in;

layout(set = 0, binding = 0, std430) buffer Placed { Samples samples; };

layout(push_constant) uniform Push {
    int count;
} push;

void main()
{
    int nth = int(gl_GlobalInvocationID.x);
    if (nth < push.count) {
        samples.at[nth] = float(nth) / float(push.count - 1);
    }
    if (nth == 0) {
        samples.count = push.count;
    }
}
