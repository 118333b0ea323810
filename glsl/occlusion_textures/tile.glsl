// What is filtered: tiles of four numbers a texel, each 0 or 1, made from a texel's mask.
//
// Packed, tile t holds slices 4t to 4t + 3 (section 3.6). Correlated, tile t holds slice t: what blocks in
// it; what any slice nearer the light blocks; what both do; and what goes on into it from the slice above.

#ifndef OCCLUSION_TEXTURES_TILE_GLSL
#define OCCLUSION_TEXTURES_TILE_GLSL

uvec4 tile_bits(uint mask, int tile, bool correlated)
{
    if (!correlated) {
        return uvec4(mask >> uint(4 * tile)) >> uvec4(0u, 1u, 2u, 3u) & 1u;
    }
    uint own = mask >> uint(tile) & 1u;
    uint above = mask & ((1u << uint(tile)) - 1u);
    uint covered = uint(above != 0u);
    return uvec4(own, covered, own & covered, own & above >> uint(max(tile - 1, 0)));
}

// Summed-area tables lie in one image, row behind row, as in memory: its width is the largest that every
// device has, and tiles of any side fill it.
const int IMAGE_WIDTH = 4096;

ivec2 place_in_image(int index)
{
    return ivec2(index & (IMAGE_WIDTH - 1), index >> 12);
}

#endif
