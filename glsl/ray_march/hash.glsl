// Random numbers as hashes of where and which they are (Tzeng and Wei 2008): the same each time, in any
// order.

#ifndef RAY_MARCH_HASH_GLSL
#define RAY_MARCH_HASH_GLSL

// One of the rounds of `md5`: `chosen` is the round's function of the digest, `added` its word and its
// constant. As published the turned word is added in two parts, and every round is added to the digest.
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

// MD5 reduced to 16 rounds of 64, of a message of four words (Curtis 2009, appendix A). The words that the
// rounds would take from beyond the message are 0.
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

// Four words to four (Jarzynski and Olano 2020, pcg4d).
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

#endif
