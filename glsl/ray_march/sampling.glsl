// Where on the light the rays of a pixel go.

#ifndef RAY_MARCH_SAMPLING_GLSL
#define RAY_MARCH_SAMPLING_GLSL

#include "ray_march/hash.glsl"

const int JITTERED = 0;
const int RANDOM = 1;
const int LOW_DISCREPANCY = 2;

// [0, 1): no more bits than a float holds, so that it never rounds up to 1.
vec2 unit(uvec2 word)
{
    return vec2(word >> 8u) / 16777216.0;
}

// The first two dimensions of Sobol's sequence, as fractions of 2^32: any 2^k points that follow a multiple
// of 2^k lie one each in 2^k boxes of one area, whatever their shape.
uvec2 sobol(uint n)
{
    uint x = bitfieldReverse(n);
    // The second dimension's matrix is Pascal's triangle modulo 2, applied in five steps.
    uint y = n;
    y ^= (y & 0xaaaaaaaau) >> 1u;
    y ^= (y & 0xccccccccu) >> 2u;
    y ^= (y & 0xf0f0f0f0u) >> 4u;
    y ^= (y & 0xff00ff00u) >> 8u;
    y ^= (y & 0xffff0000u) >> 16u;
    return uvec2(x, bitfieldReverse(y));
}

// The cell of [0, 1]^2 that is the nth of `count`, of one area each in as many rows: corner and size.
vec4 cell_of(int n, int count, int rows)
{
    int row = ((n + 1) * rows - 1) / count;
    int start = row * count / rows;
    int end = (row + 1) * count / rows;
    float across = 1.0 / float(end - start);
    return vec4(float(n - start) * across, float(start) / float(count), across,
                float(end - start) / float(count));
}

// A pixel's nth point of `count`, on a light that is [0, 1]^2. `rows` is for JITTERED: how many rows of
// cells make them square on the light.
vec2 light_sample(int sampling, bool modern, int n, int count, int rows, uvec2 pixel, uint seed)
{
    // A sequence is scrambled once a pixel, by an exclusive or of all its points' digits with the same.
    uint which = sampling == LOW_DISCREPANCY ? 0u : uint(n);
    uvec4 message = uvec4(pixel, which, 0u);
    uvec4 random = modern ? pcg(uvec4(pixel, which, seed)) : md5(message, seed);
    if (sampling == LOW_DISCREPANCY) {
        return unit(sobol(uint(n)) ^ random.xy);
    }
    if (sampling == RANDOM) {
        return unit(random.xy);
    }
    vec4 cell = cell_of(n, count, rows);
    return cell.xy + cell.zw * unit(random.xy);
}

#endif
