// Entry of the pass linear_light.visibility (src/techniques/linear_light/passes.rs); at first skip common/light_space.glsl.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// Writes the visible fraction: the parts of all segments that a pixel sees, summed over the lines (Heidrich, Brabec and
// Seidel 2000, sections 3 and 3.3).

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 2) uniform texture2DArray maps;
layout(set = 0, binding = 3) uniform texture2D places;
layout(set = 0, binding = 4, r32f) writeonly uniform image2D visibility;

#define GBUFFER
#include "common/compare.glsl"
#include "linear_light/line.glsl"

layout(push_constant) uniform Push {
    float snap;   // how far a raster moves a vertex, in texels
    int map;      // the maps' side in texels
    int most;     // the most samples of a line: its layers of `maps`
    int lines;
} push;

// A line of the light: the windows of its maps, its length in metres, and its row of `places`.
struct Line {
    vec4 u_window;
    vec2 v_window;
    float span;
    int row;
};

// A sample's channels for the segments before and after it, filtered over the four texels around the receiver: in x and
// y the part by skins, in z and w the weight of texels without a skin. `sees` is how far the sample sees the receiver.
// Texels that hide the receiver have no weight. `position` and `normal` are in the line's space, from its middle.
vec4 seen_from_sample(Line line, int nth, float at, vec3 position, vec3 normal, bool blocks, out float sees)
{
    sees = 0.0;
    vec3 p = position - vec3((at - 0.5) * line.span, 0.0, 0.0);
    // The sample lies below the pixel's own surface.
    if (dot(normal, p) >= 0.0) {
        return vec4(0.0);
    }
    vec2 u = window_at(line.u_window, at);
    vec2 v = line.v_window;
    vec2 per_uv = float(push.map) / vec2(u.y - u.x, v.y - v.x);
    MapPlane m = map_plane(p, normal, blocks, per_uv, -vec2(u.x, v.x) * per_uv, push.snap, 0.0);
    vec2 corner = floor(m.t - 0.5);
    // Nothing is in the outermost texels of a map, nor beyond.
    if (any(lessThan(corner, vec2(0.0))) || any(greaterThanEqual(corner, vec2(push.map - 1)))) {
        sees = 1.0;
        return vec4(0.0, 0.0, 1.0, 1.0);
    }
    vec2 f = m.t - 0.5 - corner;
    vec4 sum = vec4(0.0);
    bool clear = true;
    for (int row = 0; row < 2; ++row) {
        ivec2 texel = ivec2(corner) + ivec2(0, row);
        vec4 texels = texelFetch(maps, ivec3(texel, line.row * push.most + nth), 0);
        float weight = row == 1 ? f.y : 1.0 - f.y;
        vec2 at_centre = vec2(texel) + 0.5;
        bool hides = in_front_of_filter(m, at_centre, texels.x);
        float part = hides ? 0.0 : weight * (1.0 - f.x);
        vec4 by = unpacked(texels.y);
        sum += part * by;
        sees += part;
        clear = clear && !hides && by.z * by.w == 1.0;
        hides = in_front_of_filter(m, at_centre + vec2(1.0, 0.0), texels.z);
        part = hides ? 0.0 : weight * f.x;
        by = unpacked(texels.w);
        sum += part * by;
        sees += part;
        clear = clear && !hides && by.z * by.w == 1.0;
    }
    // Weights add up to 1 but for rounding, and where nothing hides a receiver it is lit to the last bit.
    sees = clear ? 1.0 : sees;
    return clear ? vec4(0.0, 0.0, 1.0, 1.0) : sum;
}

// The part of a line that a receiver sees.
float part_of(Line line, int count, vec3 position, vec3 normal, bool blocks)
{
    float sum = 0.0;
    float least = 1.0;
    float before = 0.0;
    vec2 first = vec2(0.0);
    float saw = 0.0;
    for (int nth = 0; nth < count; ++nth) {
        float at = texelFetch(places, ivec2(SAMPLES_AT + nth, line.row), 0).x;
        float sees;
        vec4 by = seen_from_sample(line, nth, at, position, normal, blocks, sees);
        float part = nth > 0 ? part_of_segment(first, by.xz, vec2(saw, sees)) : 1.0;
        sum += nth > 0 ? (at - before) * part : 0.0;
        least = min(least, part);
        before = at;
        first = by.yw;
        saw = sees;
    }
    // Segments add up to the line but for rounding, as lines do to the light.
    return least == 1.0 ? 1.0 : sum;
}

void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    if (p.x >= gbuffer.extent.x || p.y >= gbuffer.extent.y) {
        return;
    }
    Receiver r = receiver_at(p);
    float v = 1.0;
    // Behind the light's plane there is nothing to hide.
    if (r.receives && r.position.z > 0.0) {
        v = 0.0;
        float least = 1.0;
        for (int row = 0; row < push.lines; ++row) {
            vec4 turn = texelFetch(places, ivec2(0, row), 0);
            vec4 bounds = texelFetch(places, ivec2(2, row), 0);
            int count = int(texelFetch(places, ivec2(3, row), 0).x);
            Line line = Line(texelFetch(places, ivec2(1, row), 0), bounds.xy, bounds.z, row);
            // The line's own x and y.
            mat2 turned = mat2(turn.x, -turn.y, turn.y, turn.x);
            vec3 position = vec3(turned * (r.position.xy - turn.zw), r.position.z);
            vec3 normal = vec3(turned * r.normal.xy, r.normal.z);
            float sum = part_of(line, count, position, normal, r.blocks);
            if (r.blocks) {
                // The part of the line above the pixel's own plane.
                vec2 slope = vec2(normal.x * 0.5 * line.span, 0.0);
                sum = min(sum, fraction_above(slope, dot(normal, position)));
            }
            v += bounds.w * sum;
            least = min(least, sum);
        }
        v = least == 1.0 ? 1.0 : min(v, 1.0);
    }
    imageStore(visibility, p, vec4(v));
}
