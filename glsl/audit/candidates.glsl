// Entered from audit/choose.comp, audit/sums.comp, audit/list.comp and others.
//
// A candidate is a pixel (x and y in 16 bits each), the visible fraction that the technique wrote, flags, and a random
// number. A list of candidates begins with (how many it holds, how many could have been in it, 0, 0).

#ifndef AUDIT_CANDIDATES_GLSL
#define AUDIT_CANDIDATES_GLSL

// The flags: whether the technique or the truth may put it into shadow, and whether only rays can say what the truth is.
const uint LISTED = 1u;
const uint TRACED = 2u;

// Candidates and pixels a block (src/audit/passes.rs), and pixels a workgroup (audit/trace.comp).
const uint CANDIDATES_A_BLOCK = 256u;
const uint PIXELS_A_BLOCK = 64u;
const uint PIXELS_A_GROUP = 16u;

// What is written of a pixel whose walk was cut off; else the hidden samples, and in the upper half all samples.
const uint CUT_OFF = 0xffffffffu;

// A visible fraction below this is of shadow or penumbra (src/truth/metrics.rs).
const float FULL = 1.0 - 1.0e-3;

// A hash whose bits all depend on all of the number's (Jarzynski and Olano 2020, PCG).
uint hashed(uint x)
{
    uint state = x * 747796405u + 2891336453u;
    uint word = (state >> (state >> 28) + 4u ^ state) * 277803737u;
    return word >> 22 ^ word;
}

// A number from 0 to below 1.
float unit(uint x)
{
    return float(x >> 8) / 16777216.0;
}

// Whether a number is neither infinite nor NaN; comparisons alone may be optimized away.
bool is_finite(float x)
{
    return (floatBitsToUint(x) & 0x7f800000u) != 0x7f800000u;
}

#endif
