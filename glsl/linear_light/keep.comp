#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// A segment's maps as pixels ask for them: of either sample the nearest occluder's w and the channel, the part of
// the segment that what it sees there sees.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform texture2D occluders_0;
layout(set = 0, binding = 1) uniform texture2D occluders_1;
layout(set = 0, binding = 2) uniform texture2D left_skins;
layout(set = 0, binding = 3) uniform texture2D right_skins;
layout(set = 0, binding = 4, rgba32f) writeonly uniform image2DArray maps;

layout(push_constant) uniform Push {
    float inv_near; // 1 over the maps' near plane, 1/m
    int map;        // their side in texels
    int slot;       // of the segment's first sample
    int segment;
} push;

// Lit by both samples is half by each (section 3.2).
float channel(float drawn)
{
    return drawn == 1.0 ? 0.5 : 2.0 * drawn;
}

void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    if (p.x >= push.map || p.y >= push.map) {
        return;
    }
    vec2 stored = vec2(texelFetch(occluders_0, p, 0).x, texelFetch(occluders_1, p, 0).x);
    vec2 w = (push.slot == 0 ? stored : stored.yx) * push.inv_near;
    float left = channel(texelFetch(left_skins, p, 0).x);
    float right = channel(texelFetch(right_skins, p, 0).x);
    imageStore(maps, ivec3(p, push.segment), vec4(w.x, left, w.y, right));
}
