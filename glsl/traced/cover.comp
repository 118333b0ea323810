// Entry of the pass traced.cover (src/techniques/traced/passes.rs).
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
layout(set = 0, binding = 5, std430) readonly buffer Entries { uint shaft_count; uint dense_count; Entry entries[]; };
layout(set = 0, binding = 6, std430) readonly buffer Lists { uint lists[]; };
layout(set = 0, binding = 7, r32f) writeonly uniform image2D visibility;

// A triangle in light space, relative to a point near the shaft's receivers, as all of them need it. The plane through a
// receiver at q and an edge from a to b has the normal (a - q) x (b - q) = a x b + (b - a) x q.
struct Triangle {
    vec3 moment[3]; // a x b of each edge
    vec3 edge[3];   // b - a
    vec3 normal;
    float offset;   // the triangle's own plane: dot(normal, p) = offset
    float sharp;    // the height above its plane, times the normal's length, below which a receiver is in that plane
    float nearest;  // the least and largest z of its corners
    float furthest;
};

Triangle triangle_of(uint nth, vec3 about)
{
    vec3 a = in_light_space(imageLoad(triangles, texel(3u * nth)).xyz);
    vec3 b = in_light_space(imageLoad(triangles, texel(3u * nth + 1u)).xyz);
    vec3 c = in_light_space(imageLoad(triangles, texel(3u * nth + 2u)).xyz);
    vec3 size = max(max(abs(a), abs(b)), abs(c));
    a -= about;
    b -= about;
    c -= about;
    Triangle t;
    t.moment = vec3[3](cross(a, b), cross(b, c), cross(c, a));
    t.edge = vec3[3](b - a, c - b, a - c);
    t.normal = cross(t.edge[0], c - a);
    t.offset = dot(t.normal, a);
    t.sharp = 0.5 * ROUNDING * length(t.normal) * (size.x + size.y + size.z);
    t.nearest = min(a.z, min(b.z, c.z));
    t.furthest = max(a.z, max(b.z, c.z));
    return t;
}

// A receiver, from which the planes through a triangle's edges go to the light.
struct Eye {
    vec3 q;      // the receiver, relative to the same point as the triangle
    vec3 beyond; // that once more; nothing for a sun
};

// Where a plane through the receiver and an edge meets the light.
Line edge_line(vec3 moment, vec3 edge, Eye eye, vec3 about, float side)
{
    vec3 n = moment + cross(edge, eye.q);
    return line_of(n.xy, -(dot(n, about) + dot(moment, eye.beyond)), side);
}

// The light's samples that a triangle hides from a receiver, of one mask, whose first word is the light's `first`.
Mask hidden_by(Triangle t, Eye eye, vec3 about, float first)
{
    float volume = t.offset - dot(t.normal, eye.q);
    float side = volume < 0.0 ? -1.0 : 1.0;
    Line a = edge_line(t.moment[0], t.edge[0], eye, about, side);
    Line b = edge_line(t.moment[1], t.edge[1], eye, about, side);
    Line c = edge_line(t.moment[2], t.edge[2], eye, about, side);
    // A triangle wholly nearer to the light than the receiver is bounded on both sides; where rounding leaves a sliver
    // of it open, it has no samples.
    bool open = a.least == b.least && b.least == c.least && !(a.along || b.along || c.along);
    bool none = abs(volume) <= t.sharp || t.nearest > eye.q.z || (open && t.furthest < eye.q.z);
    return samples_between(bounds_of(a, b, c, none), first);
}

// The samples behind a triangle's own plane, as seen from a receiver on one side of it, where it crosses a lamp's plane.
Mask behind_plane(Triangle t, Eye eye, vec3 about, float first)
{
    float side = t.offset - dot(t.normal, eye.q) < 0.0 ? -1.0 : 1.0;
    Line own = line_of(t.normal.xy, t.normal.z * light_end() - (t.offset + dot(t.normal, about)), side);
    return samples_between(bounds_of(own, own, own, false), first);
}

// The sum of the weights of the samples that a mask of words from `first` on does not hide.
float seen_of(Mask hidden, int first)
{
    float seen = 0.0;
    int count = 0;
    for (int i = 0; i < MASK_WORDS; ++i) {
        uint word = ~word_of(hidden, i);
        count += bitCount(int(word));
        for (int bit = 0; bit < (frame.weight > 0.0 ? 32 : 0); ++bit) {
            seen += (word >> bit & 1u) != 0u ? weight_of((first + i) * 32 + bit, SIDE) : 0.0;
        }
    }
    return frame.weight > 0.0 ? seen : float(count);
}

void main()
{
    uint nth = nth_group(gl_WorkGroupID.xy);
    if (nth >= shaft_count) {
        return;
    }
    Entry entry = entries[evens_first(nth, shaft_count)];
    if (entry.plain + entry.crossing == 0u) {
        return;
    }
    ivec2 first = corner_of(entry.slot);
    uint pixels = slots[entry.slot].shaft.pixels;
    face_light(pixels, first);
    int lane = int(gl_LocalInvocationIndex);
    ivec2 pixel0 = first + ivec2(lane % TILE_SIDE, lane / TILE_SIDE);
    ivec2 pixel1 = pixel0 + ivec2(0, 8 / TILE_SIDE);
    Receiver r0 = receiver_of(pixel0);
    Receiver r1 = receiver_of(pixel1);
    bool mine0 = (pixels >> lane & 1u) != 0u;
    bool mine1 = (pixels >> lane + 8 & 1u) != 0u;
    vec3 middle = 0.5 * (slots[entry.slot].shaft.least + slots[entry.slot].shaft.most);
    vec3 q0 = r0.in_light - middle;
    vec3 q1 = r1.in_light - middle;
    bool sun = is_sun();
    Eye eye0 = Eye(q0, sun ? vec3(0.0) : q0);
    Eye eye1 = Eye(q1, sun ? vec3(0.0) : q1);
    vec3 about = sun ? vec3(0.0, 0.0, 1.0) : middle;
    vec2 seen = vec2(0.0);
    for (int m = 0; m < MASKS; ++m) {
        float word = float(m * MASK_WORDS);
        Mask hidden0 = whole_mask(mine0 ? 0u : 0xffffffffu);
        Mask hidden1 = whole_mask(mine1 ? 0u : 0xffffffffu);
        for (uint i = 0u; i < entry.plain && !(is_full(hidden0) && is_full(hidden1)); ++i) {
            Triangle t = triangle_of(lists[entry.plain_first + i], middle);
            hidden0 = either(hidden0, hidden_by(t, eye0, about, word));
            hidden1 = either(hidden1, hidden_by(t, eye1, about, word));
        }
        for (uint i = 0u; i < entry.crossing && !(is_full(hidden0) && is_full(hidden1)); ++i) {
            Triangle t = triangle_of(lists[entry.crossing_first + i], middle);
            Mask by0 = both(hidden_by(t, eye0, about, word), behind_plane(t, eye0, about, word));
            Mask by1 = both(hidden_by(t, eye1, about, word), behind_plane(t, eye1, about, word));
            hidden0 = either(hidden0, by0);
            hidden1 = either(hidden1, by1);
        }
        seen += vec2(seen_of(hidden0, m * MASK_WORDS), seen_of(hidden1, m * MASK_WORDS));
    }
    seen /= frame.weight > 0.0 ? frame.weight : float(SIDE * SIDE);
    if (mine0) {
        imageStore(visibility, pixel0, vec4(seen.x));
    }
    if (mine1) {
        imageStore(visibility, pixel1, vec4(seen.y));
    }
}
