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

// Part of a rectangle of texels, from the sums at its corners.
uvec4 inside(uvec4 upper_left, uvec4 upper_right, uvec4 lower_left, uvec4 lower_right)
{
    return lower_right - lower_left - upper_right + upper_left;
}

// Whether a tile has nothing in a part of the map.
bool is_empty(int tile, int map, vec2 lo, vec2 hi)
{
    ivec2 a = ivec2(floor(lo));
    ivec2 b = ivec2(ceil(hi));
    uvec4 all_of_it = inside(sum_at(tile, map, a), sum_at(tile, map, ivec2(b.x, a.y)),
                             sum_at(tile, map, ivec2(a.x, b.y)), sum_at(tile, map, b));
    return all_of_it == uvec4(0u);
}

// The mean over a part of the map, `lo` to `hi` in texels; all of a tile's channels, where that of the slice
// is not nothing or everything. Of the texels at its rim it has a part, so the
// columns a, a + 1, b, b + 1 and as many rows cut it into nine pieces, of which each counts in proportion.
// Sums are taken apart before they become real numbers, so that small rectangles far from the map's first
// texel are exact as well.
vec4 mean_of(int tile, int channel, int map, vec2 lo, vec2 hi)
{
    ivec2 a = ivec2(floor(lo));
    ivec2 b = ivec2(ceil(hi)) - 1;
    // The outermost corners hold all: where that is nothing or everything of the slice, as it mostly is, the
    // rest is not asked for.
    uvec4 s00 = sum_at(tile, map, a);
    uvec4 s30 = sum_at(tile, map, ivec2(b.x + 1, a.y));
    uvec4 s03 = sum_at(tile, map, ivec2(a.x, b.y + 1));
    uvec4 s33 = sum_at(tile, map, b + 1);
    uvec4 all_of_it = inside(s00, s30, s03, s33);
    ivec2 texels = b + 1 - a;
    if (all_of_it[channel] == 0u || all_of_it[channel] == uint(texels.x * texels.y)) {
        return vec4(all_of_it[channel] == 0u ? 0.0 : 1.0);
    }
    uvec4 s10 = sum_at(tile, map, ivec2(a.x + 1, a.y));
    uvec4 s20 = sum_at(tile, map, ivec2(b.x, a.y));
    uvec4 s01 = sum_at(tile, map, ivec2(a.x, a.y + 1));
    uvec4 s11 = sum_at(tile, map, a + 1);
    uvec4 s21 = sum_at(tile, map, ivec2(b.x, a.y + 1));
    uvec4 s31 = sum_at(tile, map, ivec2(b.x + 1, a.y + 1));
    uvec4 s02 = sum_at(tile, map, ivec2(a.x, b.y));
    uvec4 s12 = sum_at(tile, map, ivec2(a.x + 1, b.y));
    uvec4 s22 = sum_at(tile, map, b);
    uvec4 s32 = sum_at(tile, map, ivec2(b.x + 1, b.y));
    uvec4 s13 = sum_at(tile, map, ivec2(a.x + 1, b.y + 1));
    uvec4 s23 = sum_at(tile, map, ivec2(b.x, b.y + 1));
    // What is left out of the first and of the last row and column.
    vec2 before = lo - vec2(a);
    vec2 after = vec2(b + 1) - hi;
    vec4 left = vec4(inside(s00, s10, s03, s13));
    vec4 right = vec4(inside(s20, s30, s23, s33));
    vec4 upper = vec4(inside(s00, s30, s01, s31));
    vec4 lower = vec4(inside(s02, s32, s03, s33));
    vec4 corners = before.y * (before.x * vec4(inside(s00, s10, s01, s11)) +
                               after.x * vec4(inside(s20, s30, s21, s31))) +
                   after.y * (before.x * vec4(inside(s02, s12, s03, s13)) +
                              after.x * vec4(inside(s22, s32, s23, s33)));
    vec4 sum = vec4(all_of_it) - before.x * left - after.x * right - before.y * upper - after.y * lower +
               corners;
    vec2 size = hi - lo;
    return clamp(sum / (size.x * size.y), 0.0, 1.0);
}

#endif
