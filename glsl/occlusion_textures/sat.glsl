// Means of any rectangle from summed-area tables (Crow 1984), exact for every part of a texel.

#ifndef OCCLUSION_TEXTURES_SAT_GLSL
#define OCCLUSION_TEXTURES_SAT_GLSL

// Texels before (x, y) in both directions, summed.
uvec4 sum_at(int tile, int map, ivec2 p)
{
    bool none = p.x <= 0 || p.y <= 0;
    ivec2 q = clamp(p, ivec2(1), ivec2(map)) - 1;
    uvec4 sum = texelFetch(filtered, place_in_image((tile * map + q.y) * map + q.x), 0);
    return none ? uvec4(0u) : sum;
}

// Sums over the texels of a row and of all rows before it: from the first whole texel to the last, and of
// the texels at both ends, of which the rectangle has a part.
struct Row {
    uvec4 whole;
    uvec4 first;
    uvec4 last;
};

Row row_at(int tile, int map, int y, int a, int b)
{
    uvec4 from = sum_at(tile, map, ivec2(a, y));
    uvec4 to = sum_at(tile, map, ivec2(b, y));
    return Row(to - from, sum_at(tile, map, ivec2(a + 1, y)) - from,
               sum_at(tile, map, ivec2(b + 1, y)) - to);
}

// Sums are taken apart before they become real numbers, so that small rectangles far from the map's first
// texel are exact as well.
vec4 between(Row upper, Row lower, float before, float after)
{
    return vec4(lower.whole - upper.whole) - before * vec4(lower.first - upper.first) +
           after * vec4(lower.last - upper.last);
}

// The sum over a part of the map, `lo` to `hi` in texels.
vec4 rectangle_sum(int tile, int map, vec2 lo, vec2 hi)
{
    ivec2 a = ivec2(floor(lo));
    ivec2 b = ivec2(floor(hi));
    vec2 before = lo - vec2(a);
    vec2 after = hi - vec2(b);
    Row first = row_at(tile, map, a.y, a.x, b.x);
    Row last = row_at(tile, map, b.y, a.x, b.x);
    return between(first, last, before.x, after.x) -
           before.y * between(first, row_at(tile, map, a.y + 1, a.x, b.x), before.x, after.x) +
           after.y * between(last, row_at(tile, map, b.y + 1, a.x, b.x), before.x, after.x);
}

vec4 mean_of(int tile, int map, vec2 lo, vec2 hi)
{
    ivec2 a = ivec2(floor(lo));
    ivec2 b = ivec2(ceil(hi));
    uvec4 around = sum_at(tile, map, b) - sum_at(tile, map, ivec2(a.x, b.y)) -
                sum_at(tile, map, ivec2(b.x, a.y)) + sum_at(tile, map, a);
    // Most windows hold nothing.
    if (around == uvec4(0u)) {
        return vec4(0.0);
    }
    vec2 size = hi - lo;
    return clamp(rectangle_sum(tile, map, lo, hi) / (size.x * size.y), 0.0, 1.0);
}

#endif
