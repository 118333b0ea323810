// Entry of the pass occlusion_textures.mask (src/techniques/occlusion_textures/slices.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "occlusion_textures/solid.glsl"

// Converts counted faces to one number a texel; its bit k means that slice k blocks there.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0, r32ui) writeonly uniform uimage2D mask;
layout(set = 0, binding = 1) uniform texture2D fronts_0;
layout(set = 0, binding = 2) uniform texture2D fronts_1;
layout(set = 0, binding = 3) uniform texture2D fronts_2;
layout(set = 0, binding = 4) uniform texture2D fronts_3;
layout(set = 0, binding = 5) uniform texture2D fronts_4;
layout(set = 0, binding = 6) uniform texture2D fronts_5;
layout(set = 0, binding = 7) uniform texture2D fronts_6;
layout(set = 0, binding = 8) uniform texture2D fronts_7;
layout(set = 0, binding = 9) uniform texture2D backs_0;
layout(set = 0, binding = 10) uniform texture2D backs_1;
layout(set = 0, binding = 11) uniform texture2D backs_2;
layout(set = 0, binding = 12) uniform texture2D backs_3;
layout(set = 0, binding = 13) uniform texture2D backs_4;
layout(set = 0, binding = 14) uniform texture2D backs_5;
layout(set = 0, binding = 15) uniform texture2D backs_6;
layout(set = 0, binding = 16) uniform texture2D backs_7;

layout(push_constant) uniform Push {
    int map;    // the map's side in texels
    int slices;
    int solid;  // 1: fronts and backs are counted apart, and what lies between them blocks
    int fill;   // 1: a slice blocks in the next one too
} push;

// The counted faces of four slices at a texel.
ivec4 counts(texture2D faces, ivec2 p)
{
    return ivec4(texelFetch(faces, p, 0) * 255.0 + 0.5);
}

Column four(Column c, int first, texture2D fronts, texture2D backs, ivec2 p)
{
    if (first < push.slices) {
        ivec4 f = counts(fronts, p);
        ivec4 b = push.solid != 0 ? counts(backs, p) : f;
        for (int i = 0; i < 4; ++i) {
            c = walk(c, first + i, f[i], b[i]);
        }
    }
    return c;
}

void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    if (p.x >= push.map || p.y >= push.map) {
        return;
    }
    Column c = Column(0u, 0u, 0);
    c = four(c, 0, fronts_0, backs_0, p);
    c = four(c, 4, fronts_1, backs_1, p);
    c = four(c, 8, fronts_2, backs_2, p);
    c = four(c, 12, fronts_3, backs_3, p);
    c = four(c, 16, fronts_4, backs_4, p);
    c = four(c, 20, fronts_5, backs_5, p);
    c = four(c, 24, fronts_6, backs_6, p);
    c = four(c, 28, fronts_7, backs_7, p);
    uint solid = solid_of(c);
    // Filling (section 3.4) closes the leaks of thin occluders that go on from slice to slice.
    solid |= push.fill != 0 ? solid << 1 : 0u;
    // The last slice has none below it.
    uint all = push.slices == 32 ? 0xffffffffu : (1u << uint(push.slices)) - 1u;
    imageStore(mask, p, uvec4(solid & all));
}
