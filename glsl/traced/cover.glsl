// Entered from traced/cover.comp.
//
// The samples of the light that a triangle hides from a receiver, as a bit mask.
//
// The samples lie on a grid that is turned a little, so that no two of them share a row or a column of the light: the one
// numbered (i, j) of n by n is at (i + (j + 0.5) / n, j + (n - 0.5 - i) / n) / n of width and height. A triangle and a
// receiver make three planes, each through the receiver and an edge, and a segment to the light meets the triangle where
// it is inside of all three and ends beyond the triangle's own plane. Each of the four is linear in i and j, and so a
// bound on i for each j: the hidden samples of a j are an interval of bits.

#ifndef TRACED_COVER_GLSL
#define TRACED_COVER_GLSL

// Samples along a side of the light: 8, 16 or 32.
#ifndef SIDE
#define SIDE 8
#endif
// How many j a mask holds, and how many masks the light takes.
#define MASK_ROWS (SIDE == 8 ? 8 : 256 / SIDE)
#define MASKS (SIDE / MASK_ROWS)

const float FAR = 1.0e9;

// A line across the samples: those of a j meet it at i = at.x + at.y j.
struct Line {
    vec2 at;
    bool least; // whether the samples behind it are hidden, not those before it
    bool along; // whether it bounds none of the samples of a j, or all
};

// The line where the plane n of light space, dot(n, s.xy) + c = 0, meets the light; the samples with `side` times that
// above 0 are inside.
Line line_of(vec2 n, float c, float side)
{
    const float TURN = 1.0 / float(SIDE);
    vec2 cell = n * half_light * (2.0 * TURN);
    float k = c - dot(n, half_light) + dot(cell, vec2(0.5 * TURN, 1.0 - 0.5 * TURN));
    float i = cell.x - cell.y * TURN;
    float j = cell.y + cell.x * TURN;
    float least = 1.0e-7 * (abs(j) * float(SIDE) + abs(k)) + 1.0e-37;
    bool along = abs(i) < least;
    i = along ? (i < 0.0 ? -least : least) : i;
    return Line(vec2(-k, -j) / i, i * side > 0.0, along);
}

// Three lines, as bounds of i + 1 from below and from above for each j; a line that is no bound is far away.
struct Bounds {
    vec3 least;
    vec3 least_step;
    vec3 most;
    vec3 most_step;
};

Bounds bounds_of(Line a, Line b, Line c, bool none)
{
    bvec3 least = bvec3(a.least, b.least, c.least);
    vec3 at = vec3(a.at.x, b.at.x, c.at.x) + 1.0;
    vec3 step = vec3(a.at.y, b.at.y, c.at.y);
    return Bounds(mix(mix(vec3(-FAR), at, least), vec3(FAR), bvec3(none)), mix(vec3(0.0), step, least),
                  mix(at, vec3(FAR), least), mix(step, vec3(0.0), least));
}

// The hidden samples of a j as a mask; a sample at the very edge of two triangles belongs to one of them. Whole numbers
// have least and most in one instruction, which floats do not have everywhere.
uint samples_of(Bounds b, float j)
{
    ivec3 least = ivec3(b.least + b.least_step * j);
    ivec3 most = ivec3(b.most + b.most_step * j);
    int from = min(max(max(least.x, least.y), max(least.z, 0)), SIDE);
    int to = max(min(min(most.x, most.y), min(most.z, SIDE)), 0);
#if SIDE == 32
    // Shifts by 32 are undefined: two by a half each.
    uint before = (1u << (to >> 1) << to - (to >> 1)) - 1u;
    return before & 0xffffffffu << (from >> 1) << from - (from >> 1);
#else
    return (1u << to) - 1u & 0xffffffffu << from;
#endif
}

// A mask of samples: those of four j in a word, of two, or of one.
#if SIDE == 8

struct Mask {
    uvec2 words;
};

Mask whole_mask(uint bits)
{
    return Mask(uvec2(bits));
}

bool is_full(Mask m)
{
    return (m.words.x & m.words.y) == 0xffffffffu;
}

uint word_of(Mask m, int nth)
{
    return nth == 0 ? m.words.x : m.words.y;
}

Mask samples_between(Bounds b, float j)
{
    return Mask(uvec2(
        samples_of(b, 0.0) | samples_of(b, 1.0) << 8 | samples_of(b, 2.0) << 16 | samples_of(b, 3.0) << 24,
        samples_of(b, 4.0) | samples_of(b, 5.0) << 8 | samples_of(b, 6.0) << 16 | samples_of(b, 7.0) << 24));
}

Mask either(Mask a, Mask b)
{
    return Mask(a.words | b.words);
}

Mask both(Mask a, Mask b)
{
    return Mask(a.words & b.words);
}

#define MASK_WORDS 2

#else

struct Mask {
    uvec4 low;
    uvec4 high;
};

Mask whole_mask(uint bits)
{
    return Mask(uvec4(bits), uvec4(bits));
}

bool is_full(Mask m)
{
    uvec4 both = m.low & m.high;
    return (both.x & both.y & both.z & both.w) == 0xffffffffu;
}

uint word_of(Mask m, int nth)
{
    uvec4 half_of = nth < 4 ? m.low : m.high;
    uvec2 pair = (nth & 2) == 0 ? half_of.xy : half_of.zw;
    return (nth & 1) == 0 ? pair.x : pair.y;
}

uint word_between(Bounds b, float j)
{
#if SIDE == 16
    return samples_of(b, 2.0 * j) | samples_of(b, 2.0 * j + 1.0) << 16;
#else
    return samples_of(b, j);
#endif
}

// The samples of the j from `first` on, counted in words.
Mask samples_between(Bounds b, float first)
{
    return Mask(uvec4(word_between(b, first), word_between(b, first + 1.0),
                      word_between(b, first + 2.0), word_between(b, first + 3.0)),
                uvec4(word_between(b, first + 4.0), word_between(b, first + 5.0),
                      word_between(b, first + 6.0), word_between(b, first + 7.0)));
}

Mask either(Mask a, Mask b)
{
    return Mask(a.low | b.low, a.high | b.high);
}

Mask both(Mask a, Mask b)
{
    return Mask(a.low & b.low, a.high & b.high);
}

#define MASK_WORDS 8

#endif

#endif
