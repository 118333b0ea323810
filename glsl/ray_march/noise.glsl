// Entered from filter.comp and pixel.glsl; at first skip md5, pcg and sobol.
//
// The points of the light that a pixel's rays go to, the noise of the visible fraction that results, and how it is
// stored and filtered.

#ifndef RAY_MARCH_NOISE_GLSL
#define RAY_MARCH_NOISE_GLSL

#include "common/light_space.glsl"

// ---------------------------------------------------------------------------------------------
// The type of a visible fraction: one number for all of the light, or with `#define COLOR` one each for red, green,
// blue.

#ifdef COLOR
#define FRACTION vec3
#define FRACTION_FORMAT rgba32f
#else
#define FRACTION float
#define FRACTION_FORMAT r32f
#endif

// The texel of a fraction in an image: alpha is 1, and so are green and blue where there is no color.
vec4 stored_fraction(FRACTION v)
{
#ifdef COLOR
    return vec4(v, 1.0);
#else
    return vec4(v);
#endif
}

// ---------------------------------------------------------------------------------------------
// Random numbers are hashes of the pixel and the number's index (Tzeng and Wei 2008): the same each time, in any order.

// One round of `md5`: `chosen` is the round's function of the digest, `added` its word and its constant. In the
// published form the turned word is added in two parts, and every round is added to the digest.
void md5_round(inout uvec4 turned, inout uvec4 digest, uint chosen, uint added, uint by)
{
    uint sum = turned.x + chosen + added;
    turned.x = turned.y + (sum << by) + (sum >> (32u - by));
    turned = turned.yzwx;
    digest += turned;
}

uint md5_choose(uint if_set, uint b, uint c)
{
    return (if_set & b) | (~if_set & c);
}

// MD5 reduced to 16 rounds of 64, for a message of four words (Curtis 2009, appendix A). The words that the rounds
// would read beyond the message are 0.
uvec4 md5(uvec4 message, uint key)
{
    uvec4 m = message ^ key;
    uvec4 digest = uvec4(0x01234567u, 0x89abcdefu, 0xfedcba98u, 0x76543210u);
    uvec4 t = digest;
    md5_round(t, digest, md5_choose(t.x, t.y, t.z), m.x + 0xd76aa478u, 7u);
    md5_round(t, digest, md5_choose(t.x, t.y, t.z), m.y + 0xe8c7b757u, 12u);
    md5_round(t, digest, md5_choose(t.x, t.y, t.z), m.z + 0x242070dbu, 17u);
    md5_round(t, digest, md5_choose(t.x, t.y, t.z), m.w + 0xc1bdceefu, 22u);
    md5_round(t, digest, md5_choose(t.z, t.x, t.y), m.y + 0xf61e2562u, 5u);
    md5_round(t, digest, md5_choose(t.z, t.x, t.y), 0xc040b341u, 9u);
    md5_round(t, digest, md5_choose(t.z, t.x, t.y), 0x265e5a52u, 14u);
    md5_round(t, digest, md5_choose(t.z, t.x, t.y), m.x + 0xe9b6c7abu, 20u);
    md5_round(t, digest, t.x ^ t.y ^ t.z, 0xfffa3942u, 4u);
    md5_round(t, digest, t.x ^ t.y ^ t.z, 0x8771f681u, 11u);
    md5_round(t, digest, t.x ^ t.y ^ t.z, 0x6d9d6122u, 16u);
    md5_round(t, digest, t.x ^ t.y ^ t.z, 0xfde5380cu, 23u);
    md5_round(t, digest, t.y ^ (t.x | ~t.z), m.x + 0xf4292244u, 6u);
    md5_round(t, digest, t.y ^ (t.x | ~t.z), 0x432aff98u, 10u); // MD5 has ...97
    md5_round(t, digest, t.y ^ (t.x | ~t.z), 0xab9423a7u, 15u);
    md5_round(t, digest, t.y ^ (t.x | ~t.z), 0xfc93a039u, 21u);
    return digest;
}

// Hashes four words to four (Jarzynski and Olano 2020, pcg4d).
uvec4 pcg(uvec4 v)
{
    v = v * 1664525u + 1013904223u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    v ^= v >> 16u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    return v;
}

// ---------------------------------------------------------------------------------------------
// The points of the light that a pixel's rays go to.

const int JITTERED = 0;
const int RANDOM = 1;
const int LOW_DISCREPANCY = 2;

// Maps a word to [0, 1) with no more bits than a float holds, so that it never rounds up to 1.
vec2 unit(uvec2 word)
{
    return vec2(word >> 8u) / 16777216.0;
}

// The first two dimensions of Sobol's sequence, as fractions of 2^32: among any 2^k points that follow a multiple of
// 2^k, one lies in each of 2^k boxes of one area, whatever the boxes' shape.
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

// The nth of `count` cells that divide [0, 1]^2 into equal areas in the given number of rows: corner and size.
vec4 cell_of(int n, int count, int rows)
{
    int row = ((n + 1) * rows - 1) / count;
    int start = row * count / rows;
    int end = (row + 1) * count / rows;
    float across = 1.0 / float(end - start);
    return vec4(float(n - start) * across, float(start) / float(count), across,
                float(end - start) / float(count));
}

// A pixel's nth point of `count` on a light that is [0, 1]^2. `rows` is for JITTERED: the number of rows for which the
// cells are square on the light.
vec2 light_sample(int sampling, bool modern, int n, int count, int rows, uvec2 pixel, uint seed)
{
    // A sequence is scrambled once a pixel: all of its points are combined with one word by exclusive or.
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

// ---------------------------------------------------------------------------------------------
// The filter of noisy pixels: a Gaussian over their own surface, along rows and then along columns (Curtis 2009
// section 3, with normals as proposed there).
//
// The width minimizes the sum of blur and noise. The visible fraction goes from 0 to 1 over the penumbra's width W; a
// Gaussian of standard deviation a spoils the two ends of the ramp, by (a/W)^2 in the mean over the penumbra, and
// leaves 1/(2 a sqrt(pi)) of independent noise N a pixel, a in pixels. Their sum is least at a^3 = N W^2 / (4
// sqrt(pi)).

// The most pixels that the filter reads to either side.
const int REACH = 12;

// The mean noise of this many rays over a penumbra. One ray has 2v(1 - v), whose mean is 1/3 where v rises evenly. It
// falls with the root of the number of rays where each goes anywhere, and with its 3/4th power where each has a part of
// the light of its own and shadows have edges. (Measured on spheres: 0.30 for one ray, exponents -0.51 for random,
// -0.73 for jittered and -0.77 for low-discrepancy points.)
float noise_of(int rays, bool random)
{
    return 0.33 * pow(float(rays), random ? -0.5 : -0.75);
}

// The Gaussian's standard deviation in metres, from the widths in metres of the penumbra and of a pixel; 0 where it is
// too narrow to change anything.
float filter_width(float penumbra, float pixel, float noise)
{
    float w = penumbra / pixel;
    float a = pow(noise * w * w / 7.09, 1.0 / 3.0);
    return a < 0.4 ? 0.0 : min(a, 0.5 * float(REACH)) * pixel;
}

vec3 position_of(mat4 light_from_ndc, vec2 pixel, ivec2 extent, float depth)
{
    return dehomogenize(unproject(light_from_ndc, pixel, vec2(extent), depth));
}

// A pixel's width at its own depth, m.
float pixel_width(mat4 light_from_ndc, vec2 pixel, ivec2 extent, float depth)
{
    return distance(position_of(light_from_ndc, pixel + vec2(1.0, 0.0), extent, depth),
                    position_of(light_from_ndc, pixel, extent, depth));
}

// A neighbour's weight in the filter: by its distance, its distance from the pixel's plane, and the angle between the
// normals. `width` is the Gaussian's standard deviation.
float filter_weight(vec3 apart, vec3 normal, vec3 its_normal, float width)
{
    float off_plane = dot(apart, normal);
    float turned = max(dot(normal, its_normal), 0.0);
    // A distance from the plane counts four times as much.
    float squares = dot(apart, apart) + 15.0 * off_plane * off_plane;
    return exp(-0.5 * squares / (width * width)) * pow(turned, 16.0);
}

// ---------------------------------------------------------------------------------------------
#ifdef NOISY_BINDING
// The image of visible fractions by rays alone, with each pixel's filter width and normal. The including shader defines
// the images' bindings: NOISY_BINDING, and SURFACE_BINDING with COLOR.

// The fraction (NO_RECEIVER where there is nothing to filter), the filter's width in metres, the normal. Where the
// fraction is exact the width is below 0, and there is no normal.
layout(set = 0, binding = NOISY_BINDING, rgba32f) writeonly uniform image2D noisy;
#ifdef COLOR
layout(set = 0, binding = SURFACE_BINDING, rgba32f) writeonly uniform image2D surfaces;
#endif

const float NO_RECEIVER = -1.0;

void put_noisy(ivec2 p, FRACTION v, float width, vec3 normal)
{
#ifdef COLOR
    imageStore(noisy, p, vec4(v, width));
    imageStore(surfaces, p, vec4(folded(normal), 0.0, 0.0));
#else
    imageStore(noisy, p, vec4(v, width, folded(normal)));
#endif
}

void put_known(ivec2 p, float v)
{
    put_noisy(p, FRACTION(v), -1.0, vec3(0.0, 0.0, 1.0));
}
#endif

// ---------------------------------------------------------------------------------------------
// Lights that are discs or polygons: the part of them above a plane, and their points.

// The fraction of the unit disc above a plane, which is a segment of it; a disc's half-extents are its radius.
float fraction_of_disc_above(vec2 slope, float c)
{
    float steep = length(slope);
    if (c >= steep) {
        return 0.0;
    }
    if (c <= -steep) {
        return 1.0;
    }
    float d = c / steep;
    return (acos(d) - d * sqrt(max(1.0 - d * d, 0.0))) / 3.14159265;
}

// The area between an edge of a polygon and a line, of what of the edge lies above the line: x of its ends runs along the
// line, y is the height. Over the edges of a polygon that runs counter-clockwise they add up to less the area above.
float area_above(vec2 a, vec2 b)
{
    float high = max(a.y, b.y);
    float low = min(a.y, b.y);
    if (high <= 0.0) {
        return 0.0;
    }
    float share = low >= 0.0 ? 1.0 : high / (high - low);
    return (b.x - a.x) * share * 0.5 * (high + max(low, 0.0));
}

// The point of a triangle for one of [0, 1]^2: equal areas go to equal areas (Turk 1990).
vec2 in_triangle(vec2 a, vec2 b, vec2 c, vec2 s)
{
    return a + sqrt(s.x) * ((b - a) + s.y * (c - b));
}

// The point of the unit disc for one of [-1, 1]^2: equal areas go to equal areas (Shirley and Chiu 1997).
vec2 on_disc(vec2 q)
{
    vec2 a = abs(q);
    float far = a.x > a.y ? q.x : q.y;
    float near = a.x > a.y ? q.y : q.x;
    float angle = far == 0.0 ? 0.0 : 0.785398163 * near / far;
    vec2 p = far * vec2(cos(angle), sin(angle));
    return a.x > a.y ? p : p.yx;
}

#endif
