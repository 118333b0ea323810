// Entered from scan.glsl, first_level.comp, visibility.comp and tiles.comp.
//
// The numbers that are prefiltered: tiles of values that are 0 or 1 at a texel, made from the mask.
//
// Independent slices are packed by four (section 3.6). Correlated slices come in pairs, 2t and 2t + 1, with three more
// numbers: whether any slice blocks above the pair, above its second, and above the slice that follows the pair.
//
// With `#define SUMMED` it also declares means of any rectangle from summed-area tables.

#ifndef OCCLUSION_TEXTURES_TILE_GLSL
#define OCCLUSION_TEXTURES_TILE_GLSL

// A texel of a summed-area table. 4096 x 4096 ones are 2^24, so a sum takes 25 bits, and a fifth sum fits into what the
// other four leave of 128.
struct Sums {
    uvec4 four;
    uint fifth;
};

const uint SUM_BITS = 25u;

uvec4 packed(Sums s)
{
    return s.four | uvec4(s.fifth, s.fifth >> 7, s.fifth >> 14, s.fifth >> 21) << SUM_BITS;
}

Sums unpacked(uvec4 words)
{
    uvec4 high = words >> SUM_BITS;
    return Sums(words & ((1u << SUM_BITS) - 1u), high.x | high.y << 7 | high.z << 14 | high.w << 21);
}

// The mask's bits below bit `slice`.
uint above(uint mask, int slice)
{
    return mask & ((1u << uint(slice)) - 1u);
}

Sums tile_sums(uint mask, int tile, bool correlated)
{
    if (!correlated) {
        return Sums(uvec4(mask >> uint(4 * tile)) >> uvec4(0u, 1u, 2u, 3u) & 1u, 0u);
    }
    int first = 2 * tile;
    uvec2 own = uvec2(mask >> uint(first)) >> uvec2(0u, 1u) & 1u;
    uint covered = uint(above(mask, first) != 0u);
    return Sums(uvec4(own, covered, covered | own.x), covered | own.x | own.y);
}

// The four numbers of a texel for levels of means; for a correlated slice whether it blocks, whether any slice nearer
// to the light does, and whether both do.
uvec4 tile_means(uint mask, int tile, bool correlated)
{
    if (!correlated) {
        return tile_sums(mask, tile, false).four;
    }
    uint own = mask >> uint(tile) & 1u;
    uint covered = uint(above(mask, tile) != 0u);
    return uvec4(own, covered, own & covered, 0u);
}

// Summed-area tables lie in one image, their texels row after row as in memory: its width is the largest that every
// device has, and tiles of any side fill it.
const int IMAGE_WIDTH = 4096;

ivec2 place_in_image(int index)
{
    return ivec2(index & (IMAGE_WIDTH - 1), index >> 12);
}

#ifdef SUMMED
// Means of any rectangle from summed-area tables (Crow 1984), exact for every part of a texel.
// The including shader declares `filtered` and `push`.

// The packed sums over the texels before (x, y) in both directions.
uvec4 words_at(int tile, ivec2 p)
{
    bool none = p.x <= 0 || p.y <= 0;
    ivec2 q = clamp(p, ivec2(1), ivec2(push.map)) - 1;
    uvec4 words = texelFetch(filtered, place_in_image((tile * push.map + q.y) * push.map + q.x), 0);
    return none ? uvec4(0u) : words;
}

// The sums of a slice; for correlated slices also those of all slices above it, and of all above the next one.
uvec3 sum_at(int slice, ivec2 p)
{
#ifdef CORRELATED
    Sums s = unpacked(words_at(slice >> 1, p));
    return (slice & 1) == 0 ? s.four.xzw : uvec3(s.four.yw, s.fifth);
#else
    return uvec3(words_at(slice >> 2, p)[slice & 3], 0u, 0u);
#endif
}

// The sums over a rectangle of texels, from those at its corners.
uvec3 inside(uvec3 upper_left, uvec3 upper_right, uvec3 lower_left, uvec3 lower_right)
{
    return lower_right - lower_left - upper_right + upper_left;
}

// What lies above a row of corners in a rectangle's first column of texels (bits 0 to 15) and in its last, from the sums at
// these columns' sides: 4096 at most, and never less for a lower row, so that such pairs are subtracted as one number.
uvec3 ends(uvec3 first, uvec3 second, uvec3 last_but_one, uvec3 last)
{
    return second - first + (last - last_but_one << 16u);
}

// The weighed sum of what lies in the first column and in the last.
vec3 both_ends(uvec3 pair, float first, float last)
{
    return first * vec3(pair & 0xffffu) + last * vec3(pair >> 16u);
}

// Whether no slice blocks in any texel that the rectangle from `lo` to `hi` touches.
bool is_empty(vec2 lo, vec2 hi)
{
    ivec2 a = ivec2(floor(lo));
    ivec2 b = ivec2(ceil(hi));
#ifdef CORRELATED
    // The last slice and those above it are all slices.
    int last = slices() - 1;
    return inside(sum_at(last, a), sum_at(last, ivec2(b.x, a.y)), sum_at(last, ivec2(a.x, b.y)),
                  sum_at(last, b)).z == 0u;
#else
    bool empty = true;
    for (int tile = 0; empty && 4 * tile < slices(); ++tile) {
        empty = words_at(tile, b) - words_at(tile, ivec2(a.x, b.y)) - words_at(tile, ivec2(b.x, a.y)) +
                    words_at(tile, a) == uvec4(0u);
    }
    return empty;
#endif
}

// The shares of a rectangle, `lo` to `hi` in texels, that a slice blocks, that those above it block, and that both
// block; only the first is valid where it is 0 or 1. The rectangle holds parts of the texels at its rim, so the
// columns a, a + 1, b, b + 1 and as many rows of texels cut it into nine pieces, each of which counts in proportion.
// Sums are subtracted before they become real numbers, so that small rectangles far from the map's first texel are
// exact too.
vec3 mean_of(int slice, vec2 lo, vec2 hi)
{
    ivec2 a = ivec2(floor(lo));
    ivec2 b = ivec2(ceil(hi)) - 1;
    // The outermost corners give the whole rectangle. The rest is not needed where the slice blocks none or all of it,
    // which is the usual case.
    uvec3 s00 = sum_at(slice, a);
    uvec3 s30 = sum_at(slice, ivec2(b.x + 1, a.y));
    uvec3 s03 = sum_at(slice, ivec2(a.x, b.y + 1));
    uvec3 s33 = sum_at(slice, b + 1);
    uvec3 all_of_it = inside(s00, s30, s03, s33);
    ivec2 texels = b + 1 - a;
    if (all_of_it.x == 0u || all_of_it.x == uint(texels.x * texels.y)) {
        return vec3(all_of_it.x == 0u ? 0.0 : 1.0);
    }
    // The shares of the first and last row and column of texels that lie outside the rectangle.
    vec2 before = lo - vec2(a);
    vec2 after = vec2(b + 1) - hi;
    // The counts above a row of corners: those of all columns from the first to the last, and of the first and the last.
    uvec3 all_0 = s30 - s00;
    uvec3 all_3 = s33 - s03;
    uvec3 ends_0 = ends(s00, sum_at(slice, ivec2(a.x + 1, a.y)), sum_at(slice, ivec2(b.x, a.y)), s30);
    uvec3 ends_3 = ends(s03, sum_at(slice, ivec2(a.x + 1, b.y + 1)), sum_at(slice, ivec2(b.x, b.y + 1)), s33);
    uvec3 whole = ends_3 - ends_0;
    vec3 sum = vec3(all_of_it) - before.x * vec3(whole & 0xffffu) - after.x * vec3(whole >> 16u);
    uvec3 s01 = sum_at(slice, ivec2(a.x, a.y + 1));
    uvec3 s31 = sum_at(slice, ivec2(b.x + 1, a.y + 1));
    uvec3 ends_1 = ends(s01, sum_at(slice, a + 1), sum_at(slice, ivec2(b.x, a.y + 1)), s31);
    sum -= before.y * vec3(s31 - s01 - all_0);
    vec3 corners = before.y * both_ends(ends_1 - ends_0, before.x, after.x);
    uvec3 s02 = sum_at(slice, ivec2(a.x, b.y));
    uvec3 s32 = sum_at(slice, ivec2(b.x + 1, b.y));
    uvec3 ends_2 = ends(s02, sum_at(slice, ivec2(a.x + 1, b.y)), sum_at(slice, b), s32);
    sum -= after.y * vec3(all_3 - (s32 - s02));
    sum += corners + after.y * both_ends(ends_3 - ends_2, before.x, after.x);
    vec2 size = hi - lo;
    vec3 mean = clamp(sum / (size.x * size.y), 0.0, 1.0);
    // The share blocked above the next slice: this slice and those above it, with their overlap counted once.
    return vec3(mean.xy, max(mean.x + mean.y - mean.z, 0.0));
}
#endif

#endif
