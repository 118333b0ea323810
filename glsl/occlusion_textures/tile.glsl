// What is filtered: tiles of numbers that are 0 or 1 at a texel, made from its mask.
//
// Independent slices are packed by four (section 3.6). Correlated ones come in pairs, 2t and 2t + 1, with three
// numbers more: whether any slice above the pair blocks; any above its second; any above what follows it.

#ifndef OCCLUSION_TEXTURES_TILE_GLSL
#define OCCLUSION_TEXTURES_TILE_GLSL

// A texel of a summed-area table. 4096 x 4096 ones are 2^24: a sum takes 25 bits, and so there is room for a
// fifth one in what the other four leave of 128.
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

// Bits of slices up to `slice`, without it.
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

// The same for levels of means, whose texels hold four numbers: of a correlated slice whether it blocks,
// whether any slice nearer the light does, and whether both do.
uvec4 tile_means(uint mask, int tile, bool correlated)
{
    if (!correlated) {
        return tile_sums(mask, tile, false).four;
    }
    uint own = mask >> uint(tile) & 1u;
    uint covered = uint(above(mask, tile) != 0u);
    return uvec4(own, covered, own & covered, 0u);
}

// Summed-area tables lie in one image, row behind row, as in memory: its width is the largest that every
// device has, and tiles of any side fill it.
const int IMAGE_WIDTH = 4096;

ivec2 place_in_image(int index)
{
    return ivec2(index & (IMAGE_WIDTH - 1), index >> 12);
}

#endif
