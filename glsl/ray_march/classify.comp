// Entry of the pass ray_march.classify (src/techniques/ray_march/passes.rs); at first skip noise.glsl and column.glsl.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// Finds the pixels that are surely lit or in umbra, and lists the others: the former take no ray and no invocation.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 5, std430) buffer Pixels {
    uint count;
    uint none[3];
    mat4 ndc_from_light;
    vec2 corners[16];
    uvec2 pieces[16];
    uint pixels[];
};

#define NOISY_BINDING 7
#define SURFACE_BINDING 8
#include "ray_march/pixel.glsl"
#include "common/lists.glsl"

layout(set = 0, binding = 4, std430) buffer Arguments { uint groups[4]; };

layout(set = 0, binding = 6, FRACTION_FORMAT) writeonly uniform image2D halfway;

void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    if (p.x >= gbuffer.extent.x || p.y >= gbuffer.extent.y) {
        return;
    }
    Receiver r = receiver_without_normal(p);
    if (!is_served(r.position)) {
        // The filter of the widest view finds no neighbours there, that of a finer one those of the wider ones.
        if (filters() && is_widest_view()) {
            put_known(p, NO_RECEIVER);
            imageStore(halfway, p, vec4(NO_RECEIVER));
        }
        return;
    }
    float v;
    Reach reach;
    bool open = is_open(p, r, v, reach);
    if (open) {
        uint at = atomicAdd(count, 1u);
        if (at % PIXELS_A_GROUP == 0u) {
            uvec2 reach = groups_up_to(at);
            atomicMax(groups[0], reach.x);
            atomicMax(groups[1], reach.y);
        }
        pixels[3u * at] = uint(p.x) | uint(p.y) << 16u;
        pixels[3u * at + 1u] = floatBitsToUint(reach.start);
        pixels[3u * at + 2u] = floatBitsToUint(reach.end);
    } else {
        imageStore(visibility, p, stored_fraction(FRACTION(v)));
        if (filters()) {
            // An exact fraction is not filtered, but its neighbours are filtered with it.
            float known = r.receives && is_before_light(r.position) ? v : NO_RECEIVER;
            put_known(p, known);
            imageStore(halfway, p, vec4(known));
        }
    }
}
