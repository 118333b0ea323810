// See classify.comp.

layout(local_size_x = 8, local_size_y = 8) in;

#include "ray_march/pixel.glsl"

layout(set = 0, binding = 4, std430) buffer Arguments { uint groups[4]; };
layout(set = 0, binding = 5, std430) buffer Pixels { uint count; uint none[3]; mat4 ndc_from_light; uint pixels[]; };

layout(set = 0, binding = 6, FRACTION_FORMAT) writeonly uniform image2D halfway;
#define NOISY_BINDING 7
#define SURFACE_BINDING 8
#include "ray_march/noisy.glsl"

// Pixels a group of the passes over the list.
const uint GROUP = 64u;

void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    if (p.x >= push.extent.x || p.y >= push.extent.y) {
        return;
    }
    Receiver r = receiver_without_normal(gbuffer(), p);
    // Behind the light's plane there is nothing to hide.
    bool receives = r.receives && r.position.z > 0.0;
    float v = 1.0;
    bool open = false;
    Reach reach;
    if (receives) {
        reach = reach_of(place_of(r), r.position.z);
        open = reach.start <= reach.end;
        // Most pixels do without a normal.
        if (open || r.blocks) {
            r.normal = pixel_normal(p, r);
            v = part_above(r);
            // Which part of a texture is above the plane only rays tell.
            open = v > 0.0 && (open || (is_textured() && v < 1.0));
        }
        if (open && v == 1.0 && reach.whole && !looks_from_eye()) {
            Place place = place_of(r);
            if (stops_all(place, reach.from, reach.side, reach.bounds, place.w + reach.start,
                          place.w + reach.end)) {
                open = false;
                v = 0.0;
            }
        }
    }
    if (open) {
        uint at = atomicAdd(count, 1u);
        if (at % GROUP == 0u) {
            atomicAdd(groups[0], 1u);
        }
        pixels[3u * at] = uint(p.x) | uint(p.y) << 16u;
        pixels[3u * at + 1u] = floatBitsToUint(reach.start);
        pixels[3u * at + 2u] = floatBitsToUint(reach.end);
    } else {
        imageStore(visibility, p, stored_fraction(FRACTION(v)));
        if (filters()) {
            // What is known for sure is not filtered, but neighbours are with it.
            put_known(p, receives ? v : NO_RECEIVER);
            imageStore(halfway, p, vec4(receives ? v : NO_RECEIVER));
        }
    }
}
