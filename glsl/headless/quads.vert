#version 450

// Penumbra rectangles that the CPU made, for patch.frag (Atty 2006, section 4.1).

layout(location = 0) in vec2 at;       // a corner, in clip space
layout(location = 1) in vec3 of_patch; // the patch: its texel and w

layout(location = 0) flat out vec2 texel;
layout(location = 1) flat out float w_o;
layout(location = 2) flat out float threshold;

void main()
{
    texel = of_patch.xy;
    w_o = of_patch.z;
    // This patch's contributions are rounded with patch.vert's thresholds.
    uint spread = uint(texel.x) * 3242174889u + uint(texel.y) * 2447445414u;
    threshold = float(spread >> 16) / 65536.0;
    gl_Position = vec4(at, 0.0, 1.0);
}
