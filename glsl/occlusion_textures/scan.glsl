// Entered from sum_rows.comp and sum_columns.comp.
//
// Running sums of a line of texels, a row or a column of a tile. A workgroup has LINES of them side by side, each of which
// an invocation goes through. With `#define PARTED` a line is cut into PARTS: an invocation sums up its part, adds what
// the parts before it come to, and goes through it again. The sums are whole numbers, so no order of additions changes
// them.

#ifndef OCCLUSION_TEXTURES_SCAN_GLSL
#define OCCLUSION_TEXTURES_SCAN_GLSL

#include "occlusion_textures/tile.glsl"

#ifdef PARTED
const int LINES = 8;
const int PARTS = 16;

// The sums of each part, part by part with the lines within.
shared uvec4 fours[LINES * PARTS];
shared uint fifths[LINES * PARTS];
#else
const int LINES = 64;
#endif

Sums plus(Sums a, Sums b)
{
    return Sums(a.four + b.four, a.fifth + b.fifth);
}

#ifdef PARTED
// The texels of a part of a line of `map` texels: the first, and the one behind the last.
ivec2 texels_of(int part, int map)
{
    int each = (map + PARTS - 1) / PARTS;
    return min(ivec2(part * each, (part + 1) * each), ivec2(map));
}

// The sums of a line's parts before this invocation's, of which `mine` are the sums. `at` is the invocation's number; every
// one of the workgroup must call it.
Sums sums_before(int at, Sums mine)
{
    fours[at] = mine.four;
    fifths[at] = mine.fifth;
    barrier();
    Sums sum = Sums(uvec4(0u), 0u);
    for (int i = at % LINES; i < at; i += LINES) {
        sum = plus(sum, Sums(fours[i], fifths[i]));
    }
    return sum;
}
#endif

#endif
