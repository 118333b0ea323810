// Entry of the passes traced.cover and traced.cover_cut (src/techniques/traced/passes.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "traced/frame.glsl"
#include "traced/lists.glsl"
#include "traced/cover.glsl"

// Tests the triangles of a shaft's list against all of the light's samples at once, for each of its receivers. One
// workgroup handles one shaft, each invocation two of its tile's pixels.

layout(local_size_x = 8) in;

layout(set = 0, binding = 3, rgba32f) readonly uniform image2D triangles;
layout(set = 0, binding = 4, std430) readonly buffer Slots { Slot slots[]; };
layout(set = 0, binding = 5, std430) readonly buffer Entries { Head head; Entry entries[]; };
layout(set = 0, binding = 6, std430) readonly buffer Lists { uint lists[]; };
layout(set = 0, binding = 7, VISIBILITY_FORMAT) writeonly uniform image2D visibility;

#ifdef CUT
layout(set = 0, binding = 9) uniform texture2D cut_outs;
layout(set = 0, binding = 10) uniform utexture2D opacities;
#include "hierarchy/cut.glsl"
#endif

// How much a triangle's area, and its area times its size, allow a volume to be off by rounding.
vec2 sharp;

// A triangle in grid space, from the middle of the shaft's receivers.
struct Triangle {
    vec3 a;
    vec3 b;
    vec3 c;
    float sharp; // the volume that a receiver spans with it, below which the receiver is in its plane
};

// A volume that no receiver spans with a triangle.
const float NEVER = 3.0e38;

// The triangle of a number, which hides nothing unless a texture cuts it out as is said.
Triangle triangle_of(uint nth, vec3 middle, bool cut)
{
    vec4 a = imageLoad(triangles, texel(3u * nth));
    vec4 b = imageLoad(triangles, texel(3u * nth + 1u));
    vec4 c = imageLoad(triangles, texel(3u * nth + 2u));
    float least = b.w * sharp.x + c.w * sharp.y;
#ifdef CUT
    least = a.w > CUT_FROM == cut ? least : NEVER;
#endif
    return Triangle(in_light_space(a.xyz) - middle, in_light_space(b.xyz) - middle, in_light_space(c.xyz) - middle, least);
}

// The light's samples that a triangle hides from a receiver at `q`, as bounds for each of the rows of samples; `first` is
// where the first sample is, from the receiver, or for a sun along the light.
Bounds bounds_of(Triangle t, vec3 q, vec3 first)
{
    vec3 a = t.a - q;
    vec3 b = t.b - q;
    vec3 c = t.c - q;
    vec3 ab = cross(a, b);
    vec3 bc = cross(b, c);
    vec3 ca = cross(c, a);
    float volume = dot(ab, c);
    float side = volume < 0.0 ? -1.0 : 1.0;
    Line of_ab = line_of(ab, first, side);
    Line of_bc = line_of(bc, first, side);
    Line of_ca = line_of(ca, first, side);
    // A triangle wholly nearer to the light than the receiver is bounded on both sides; where rounding leaves a sliver
    // of it open, it has no samples.
    bool open = of_ab.least == of_bc.least && of_bc.least == of_ca.least && !(of_ab.along || of_bc.along || of_ca.along);
    float nearest = min(a.z, min(b.z, c.z));
    float furthest = max(a.z, max(b.z, c.z));
    bool none = abs(volume) <= t.sharp || nearest > 0.0 || (open && furthest < 0.0);
    return bounds_of(of_ab, of_bc, of_ca, none);
}

// Those samples as one mask, whose first word is the light's `word`.
Mask hidden_by(Triangle t, vec3 q, vec3 first, float word)
{
    return samples_between(bounds_of(t, q, first), word);
}

// The samples that a triangle hides which lies between receiver and light, and hides some in a few rows of samples alone.
Mask few_hidden_by(Triangle t, vec3 q, vec3 first, float word)
{
#if SIDE == 32
    return hidden_by(t, q, first, word);
#else
    vec3 a = t.a - q;
    vec3 b = t.b - q;
    vec3 c = t.c - q;
    vec3 rows = vec3(a.y, b.y, c.y) + TURN * vec3(a.x, b.x, c.x);
    rows *= (is_sun() ? -1.0 : first.z) / vec3(a.z, b.z, c.z);
    rows = (rows - (first.y + TURN * first.x)) / (1.0 + TURN * TURN);
    // Also the rows of samples that rounding moves away.
    return few_between(bounds_of(t, q, first), ceil(min(rows.x, min(rows.y, rows.z)) - 1.0 / 64.0));
#endif
}

// The samples behind a triangle's own plane, as seen from a receiver on one side of it, where it crosses a lamp's plane.
Mask behind_plane(Triangle t, vec3 q, vec3 first, float word)
{
    vec3 normal = cross(t.b - t.a, t.c - t.a);
    float height = dot(normal, t.a - q);
    vec3 sample_from_corner = first + vec3(0.0, 0.0, light_end) - (t.a - q);
    Line own = line_of(normal, sample_from_corner, height < 0.0 ? -1.0 : 1.0);
    return samples_between(bounds_of(own, own, own, false), word);
}

#ifdef CUT
// The samples that are hidden with those that a triangle's texture stops on the way to the receiver at `q`, of those that the
// triangle covers; `first` is where the first sample is, from there, and `word` the number of the masks' first word.
Mask with_stopped(Mask hidden, Mask covered, uint nth, Triangle t, vec3 q, vec3 first, float word)
{
    Cut cut = cut_of(nth);
    vec3 a = t.a - q;
    vec3 b = t.b - q;
    vec3 c = t.c - q;
    vec3 ab = cross(a, b);
    vec3 bc = cross(b, c);
    vec3 ca = cross(c, a);
    for (int w = 0; w < MASK_WORDS; ++w) {
        uint open = word_of(covered, w) & ~word_of(hidden, w);
        uint stopped = 0u;
        while (open != 0u) {
            int bit = findLSB(int(open));
            open &= open - 1u;
            int number = (int(word) + w) * 32 + bit;
            vec2 at = vec2(number % SIDE, number / SIDE);
            vec3 ray = first + vec3(at + TURN * vec2(at.y, -at.x), 0.0);
            vec3 shares = vec3(dot(bc, ray), dot(ca, ray), dot(ab, ray));
            uint of_bit = 1u << bit;
            bool stop = stops(cut, shares, even_number(at, nth >> 1u));
            stopped |= stop ? of_bit : 0u;
        }
        hidden = with_word(hidden, w, stopped);
    }
    return hidden;
}
#endif

// What samples count for: those that either receiver sees, and all.
struct Sums {
    SUM seen0;
    SUM seen1;
    SUM all;
};

// The sums with those of the samples of two masks, of words from `first` on.
Sums with_masks(Sums sums, Mask hidden0, Mask hidden1, int first)
{
    Sums more = Sums(SUM(0.0), SUM(0.0), SUM(0.0));
    ivec2 counts = ivec2(0);
    for (int i = 0; i < MASK_WORDS; ++i) {
        uvec2 words = ~uvec2(word_of(hidden0, i), word_of(hidden1, i));
        counts += bitCount(ivec2(words));
        // Both receivers and the sum of all share a sample's texels.
        for (int bit = 0; bit < (WEIGHED ? 32 : 0); ++bit) {
            SUM weight = weight_of((first + i) * 32 + bit, SIDE);
            more.seen0 += (words.x >> bit & 1u) != 0u ? weight : SUM(0.0);
            more.seen1 += (words.y >> bit & 1u) != 0u ? weight : SUM(0.0);
            sums.all += weight;
        }
    }
    sums.seen0 += WEIGHED ? more.seen0 : SUM(counts.x);
    sums.seen1 += WEIGHED ? more.seen1 : SUM(counts.y);
    return sums;
}

void main()
{
    uint nth = nth_group(gl_WorkGroupID.xy);
    if (nth >= head.shadowed) {
        return;
    }
    Entry entry = entries[slots_in(frame.extent) + evens_first(nth, head.shadowed)];
    ivec2 corner = corner_of(entry.slot);
    uint pixels = slots[entry.slot].shaft.pixels;
    vec3 middle = slots[entry.slot].shaft.middle;
    face_light(pixels, corner);
    float offset = abs(light_x.w) + abs(light_y.w) + abs(light_z.w);
    enter_grid(SIDE);
    sharp = 0.5 * ROUNDING * length(light_x.xyz) * length(light_y.xyz) * vec2(offset, 1.0);
    int lane = int(gl_LocalInvocationIndex);
    ivec2 pixel0 = corner + ivec2(lane % TILE_SIDE, lane / TILE_SIDE);
    ivec2 pixel1 = pixel0 + ivec2(0, 8 / TILE_SIDE);
    vec3 q0 = in_light_space(receiver_of(pixel0).position) - middle;
    vec3 q1 = in_light_space(receiver_of(pixel1).position) - middle;
    bool mine0 = (pixels >> lane & 1u) != 0u;
    bool mine1 = (pixels >> lane + 8 & 1u) != 0u;
    vec3 sample0 = is_sun() ? vec3(first_sample(), -1.0) : vec3(first_sample(), 0.0) - middle;
    vec3 first0 = is_sun() ? sample0 : sample0 - q0;
    vec3 first1 = is_sun() ? sample0 : sample0 - q1;
    bool crossing = entry.crossing != 0u;
    Sums sums = Sums(SUM(0.0), SUM(0.0), SUM(0.0));
    for (int m = 0; m < MASKS; ++m) {
        float word = float(m * MASK_WORDS);
        Mask hidden0 = whole_mask(mine0 ? 0u : 0xffffffffu);
        Mask hidden1 = whole_mask(mine1 ? 0u : 0xffffffffu);
        for (uint i = 0u; i < entry.few && !(is_full(hidden0) && is_full(hidden1)); ++i) {
            Triangle t = triangle_of(lists[entry.first + i], middle, false);
            hidden0 = either(hidden0, few_hidden_by(t, q0, first0, word));
            hidden1 = either(hidden1, few_hidden_by(t, q1, first1, word));
        }
        for (uint i = crossing ? entry.many : 0u; i < entry.many && !(is_full(hidden0) && is_full(hidden1)); ++i) {
            Triangle t = triangle_of(lists[entry.others + i], middle, false);
            hidden0 = either(hidden0, hidden_by(t, q0, first0, word));
            hidden1 = either(hidden1, hidden_by(t, q1, first1, word));
        }
        for (uint i = crossing ? 0u : entry.many; i < entry.many && !(is_full(hidden0) && is_full(hidden1)); ++i) {
            Triangle t = triangle_of(lists[entry.others + i], middle, false);
            hidden0 = either(hidden0, both(hidden_by(t, q0, first0, word), behind_plane(t, q0, first0, word)));
            hidden1 = either(hidden1, both(hidden_by(t, q1, first1, word), behind_plane(t, q1, first1, word)));
        }
#ifdef CUT
        // Those that textures cut out come last, and to one place: some drivers compile each call anew, and for long.
        for (uint i = 0u; i < entry.few + entry.many; ++i) {
            bool few = i < entry.few;
            uint number = lists[few ? entry.first + i : entry.others + i - entry.few];
            Triangle t = triangle_of(number, middle, true);
            for (int r = t.sharp == NEVER ? 2 : 0; r < 2; ++r) {
                vec3 q = r == 0 ? q0 : q1;
                vec3 first = r == 0 ? first0 : first1;
                Mask covered = few ? few_hidden_by(t, q, first, word) : hidden_by(t, q, first, word);
                covered = few || crossing ? covered : both(covered, behind_plane(t, q, first, word));
                Mask hidden = with_stopped(r == 0 ? hidden0 : hidden1, covered, number, t, q, first, word);
                hidden0 = r == 0 ? hidden : hidden0;
                hidden1 = r == 0 ? hidden1 : hidden;
            }
        }
#endif
        sums = with_masks(sums, hidden0, hidden1, m * MASK_WORDS);
    }
#ifndef TEXTURED
    sums.all = WEIGHED ? frame.weight : float(SIDE * SIDE);
#endif
    if (mine0) {
        imageStore(visibility, pixel0, fraction_of(sums.seen0, sums.all));
    }
    if (mine1) {
        imageStore(visibility, pixel1, fraction_of(sums.seen1, sums.all));
    }
}
