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

// How much the samples' i and j are turned against x and y.
const float TURN = 1.0 / float(SIDE);

// The sample (0, 0) in grid space.
vec2 first_sample()
{
    return vec2(0.5 * TURN, 1.0 - 0.5 * TURN) - 0.5 * float(SIDE);
}

const float FAR = 1.0e9;

// A line across the samples: those of a j meet it at i = at.x + at.y j.
struct Line {
    vec2 at;
    bool least; // whether the samples behind it are hidden, not those before it
    bool along; // whether it bounds none of the samples of a j, or all
};

// The line where a plane of grid space meets the light; `first` is where the first sample is, from a point of the plane. The
// samples with `side` times their product with its normal above 0 are inside.
Line line_of(vec3 normal, vec3 first, float side)
{
    float i = normal.x - normal.y * TURN;
    float j = normal.y + normal.x * TURN;
    float k = dot(normal, first);
    float least = 1.0e-7 * (abs(j) * float(SIDE) + abs(k)) + 1.0e-37;
    bool along = abs(i) < least;
    i = along ? (i < 0.0 ? -least : least) : i;
    float share = -1.0 / i;
    return Line(vec2(k, j) * share, i * side > 0.0, along);
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

// The hidden samples of a j as a mask; a sample at the very edge of two triangles belongs to one of them. The floats' bits are
// compared as whole numbers, whose least and most are one instruction: so numbers above 0 are in order, and all below it are
// less.
uint samples_of(Bounds b, float j)
{
    ivec3 least = floatBitsToInt(b.least + b.least_step * j);
    ivec3 most = floatBitsToInt(b.most + b.most_step * j);
    const int LAST = floatBitsToInt(float(SIDE));
    int from = int(intBitsToFloat(min(max(max(least.x, least.y), max(least.z, 0)), LAST)));
    int to = int(intBitsToFloat(max(min(min(most.x, most.y), min(most.z, LAST)), 0)));
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
    return mix(m.words.x, m.words.y, nth != 0);
}

// The mask with more samples in its nth word.
Mask with_word(Mask m, int nth, uint bits)
{
    m.words |= mix(uvec2(0u), uvec2(bits), equal(ivec2(0, 1), ivec2(nth)));
    return m;
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

// The samples of the two j from `first` on, or of the last two of the light.
Mask few_between(Bounds b, float first)
{
    float j = clamp(first, 0.0, 6.0);
    uint bits = samples_of(b, j) | samples_of(b, j + 1.0) << 8;
    uint by = uint(j) * 8u;
    return Mask(uvec2(by < 32u ? bits << by : 0u, by < 32u ? bits >> 1 >> 31u - by : bits << by - 32u));
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

// The mask with more samples in its nth word.
Mask with_word(Mask m, int nth, uint bits)
{
    uvec4 words = mix(uvec4(0u), uvec4(bits), equal(ivec4(0, 1, 2, 3), ivec4(nth & 3)));
    m.low |= nth < 4 ? words : uvec4(0u);
    m.high |= nth < 4 ? uvec4(0u) : words;
    return m;
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

#if SIDE == 16
// The samples of the four j from `first` or the one before it on, or of the last four of the light.
Mask few_between(Bounds b, float first)
{
    int word = clamp(int(first) >> 1, 0, 6);
    uint bits = word_between(b, float(word));
    uint more = word_between(b, float(word + 1));
    ivec4 low = ivec4(0, 1, 2, 3) - word;
    ivec4 high = low + 4;
    return Mask(mix(uvec4(0u), uvec4(bits), equal(low, ivec4(0))) | mix(uvec4(0u), uvec4(more), equal(low, ivec4(1))),
                mix(uvec4(0u), uvec4(bits), equal(high, ivec4(0))) | mix(uvec4(0u), uvec4(more), equal(high, ivec4(1))));
}
#endif

#define MASK_WORDS 8

#endif

#endif
