// Entry of the passes traced.rays and traced.rays_cut (src/techniques/traced/passes.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "traced/frame.glsl"
#include "traced/lists.glsl"

// Works off the shafts that hold too many triangles: each of their pixels sends rays to samples of the light. One
// workgroup handles one shaft, an invocation one of its pixels.

layout(local_size_x = 16) in;

layout(set = 0, binding = 3, rgba32ui) readonly uniform uimage2D nodes;
layout(set = 0, binding = 4, rgba32f) readonly uniform image2D triangles;
layout(set = 0, binding = 5, std430) readonly buffer Slots { Slot slots[]; };
layout(set = 0, binding = 6, std430) readonly buffer Entries { Head head; Entry entries[]; };
layout(set = 0, binding = 7, VISIBILITY_FORMAT) writeonly uniform image2D visibility;

#ifdef CUT
layout(set = 0, binding = 9) uniform texture2D cut_outs;
layout(set = 0, binding = 10) uniform utexture2D opacities;
#endif

#include "hierarchy/segment.glsl"

// The turns of all loops of an invocation: some drivers end loops without a word after 65,535 of them.
const int MOST_TURNS = 60000;

// The bits of a number below `side` in reverse.
int reversed(int n, int side)
{
    return int(bitfieldReverse(uint(n)) >> 32 - findMSB(side));
}

// The sample that the nth ray goes to: any first few are spread over the light.
int sample_number(int n, int side)
{
    int row = reversed(n % side, side);
    return row * side + (reversed(n / side, side) + reversed(row, side) & side - 1);
}

// Where a sample lies, each coordinate from -1 to 1: on the turned grid of traced/cover.glsl.
vec2 sample_at(int number, int side)
{
    vec2 cell = vec2(number % side, number / side);
    float n = float(side);
    return (cell + vec2(cell.y + 0.5, n - 0.5 - cell.x) / n) * 2.0 / n - 1.0;
}

void main()
{
    uint nth = nth_group(gl_WorkGroupID.xy);
    if (nth >= head.dense) {
        return;
    }
    // They are listed from the end backwards.
    ivec2 tiles = tiles_in(frame.extent);
    uint last = SHAFTS_A_TILE * uint(tiles.x * tiles.y) - 1u;
    uint slot = entries[last - evens_first(nth, head.dense)].slot;
    uint pixels = slots[slot].shaft.pixels;
    int lane = int(gl_LocalInvocationIndex);
    if ((pixels >> lane & 1u) == 0u) {
        return;
    }
    ivec2 corner = corner_of(slot);
    ivec2 pixel = corner + ivec2(lane % TILE_SIDE, lane / TILE_SIDE);
    face_light(pixels, corner);
    Receiver r = receiver_of(pixel);
    int turns = MOST_TURNS;
    int sent = 0;
    SUM sum = SUM(0.0);
    SUM seen = SUM(0.0);
    while (sent < int(frame.samples) && turns > 0) {
        int number = sample_number(sent, int(frame.side));
        vec2 at = sample_at(number, int(frame.side)) * half_light;
        SUM weight = weight_of(number, int(frame.side));
        vec3 in_light = is_sun() ? vec3(at, -1.0) : vec3(at, 0.0) - r.in_light;
        in_light *= is_sun() ? 1.0 : 1.0 - light_end / r.in_light.z;
        vec3 along = in_light.x * light_x.xyz + in_light.y * light_y.xyz + in_light.z * light_z.xyz;
        Segment s = segment_of(r.position, along, !is_sun());
#ifdef CUT
        ray_number = vec2(number % int(frame.side), number / int(frame.side));
#endif
        // A sample that is dark, or outside the light's shape, needs no ray.
        bool hit = weight != SUM(0.0) && blocked(s, frame.nodes, turns);
        sent += 1;
        sum += weight;
        seen += hit ? SUM(0.0) : weight;
    }
    imageStore(visibility, pixel, fraction_of(seen, sum));
}
