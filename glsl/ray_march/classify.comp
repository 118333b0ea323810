#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// Which pixels are lit or in umbra for sure, and a list of the others: no ray is spent on the first, and no
// invocation.

layout(local_size_x = 8, local_size_y = 8) in;

#include "ray_march/pixel.glsl"

layout(set = 0, binding = 5, std430) buffer Arguments { uint groups[4]; };
layout(set = 0, binding = 6, std430) buffer Pixels { uint count; uint none[3]; mat4 ndc_from_light; uint pixels[]; };

#define NOISY_BINDING 7
#include "ray_march/noisy.glsl"
layout(set = 0, binding = 8, r32f) writeonly uniform image2D halfway;
const float NO_RECEIVER = -1.0;

// Pixels a group of the passes over the list.
const uint GROUP = 64u;

void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    if (p.x >= push.extent.x || p.y >= push.extent.y) {
        return;
    }
    Receiver r = pixel_receiver(p);
    float v = 1.0;
    bool open = false;
    if (r.receives) {
        Place place = place_of(r);
        // The part of the light under the pixel's own surface, where that blocks.
        float above = r.blocks ? fraction_above(r.normal.xy * push.half_light, dot(r.normal, r.position)) : 1.0;
        Reach reach = reach_of(place, r.position.z);
        open = above > 0.0 && reach.start <= reach.end;
        v = above;
        if (open && reach.umbra && above == 1.0 && !looks_from_eye()) {
            open = false;
            v = 0.0;
        }
    }
    if (open) {
        uint at = atomicAdd(count, 1u);
        if (at % GROUP == 0u) {
            atomicAdd(groups[0], 1u);
        }
        pixels[at] = uint(p.x) | uint(p.y) << 16u;
    } else {
        imageStore(visibility, p, vec4(v));
    }
    if (filters()) {
        put_noisy(p, r.receives ? v : NO_RECEIVER, 0.0, r.normal);
        imageStore(halfway, p, vec4(r.receives ? v : NO_RECEIVER));
    }
}
