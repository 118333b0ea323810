// Entered from cut_outs/vertex.glsl, cut_outs/image.glsl, hierarchy/cut_outs.comp and others.
//
// Where a mesh stops light, by the alpha of a texture (OpacityTexture, src/lent/opacity.rs). The texture's first mip level
// alone is looked up: a texel of a map stands for one ray.
//
// A choice is between variables here: one between sums is a branch, and one driver takes minutes to compile those in loops.

#ifndef CUT_OUTS_CUT_OUT_GLSL
#define CUT_OUTS_CUT_OUT_GLSL

// A mesh's cut-out (CutOutRecord, src/frame/cut_outs.rs).
struct CutOut {
    vec4 u;      // (u, v, 1) in the buffer to u in the image; the cutoff
    vec4 v;      // and to v; the factor
    uint first;  // where the coordinates begin, in floats
    uint bits;   // floats from one to the next, then the bits below
    uint texels; // where the opacities begin among those of all textures
    uint extent; // their width and height, 16 bits each
};

const uint STRIDE_BITS = 0xffffu;
// How u and v go on, two bits each: 0 for anew, 1 for mirrored, 2 for the edge.
const int WRAP_U = 16;
const int WRAP_V = 18;
// Whether opacities are interpolated, and whether there is a cutoff.
const uint LINEAR = 1u << 20;
const uint HAS_CUTOFF = 1u << 21;

// A coordinate brought to where whole numbers of texels hold it.
float brought_near(float x, uint wrap)
{
    float again = x - floor(x);
    float mirrored = x - 2.0 * floor(0.5 * x);
    float clamped = clamp(x, -1.0, 2.0);
    float repeated = wrap == 1u ? mirrored : again;
    return wrap == 2u ? clamped : repeated;
}

// The coordinate of a texel, of a place at most one texture beyond the edges, or two for mirrored ones.
int wrapped(int at, int side, uint wrap)
{
    int back = -1 - at;
    int mirrored = at < 0 ? back : at;
    back = 2 * side - 1 - mirrored;
    mirrored = mirrored < side ? mirrored : back;
    back = -1 - mirrored;
    mirrored = mirrored < 0 ? back : mirrored;
    int less = at - side;
    int more = at + side;
    int again = at >= side ? less : at;
    again = at < 0 ? more : again;
    int bounded = wrap == 1u ? mirrored : at;
    bounded = wrap == 0u ? again : bounded;
    return clamp(bounded, 0, side - 1);
}

// The four texels about a place of a texture, and the shares of the right and of the lower ones.
struct Texels {
    ivec2 low;
    ivec2 high;
    vec2 shares;
};

Texels texels_at(vec2 place, ivec2 size, uint bits)
{
    uvec2 wrap = uvec2(bits >> WRAP_U & 3u, bits >> WRAP_V & 3u);
    vec2 near = vec2(brought_near(place.x, wrap.x), brought_near(place.y, wrap.y));
    bool linear = (bits & LINEAR) != 0u;
    vec2 at = near * vec2(size) - (linear ? 0.5 : 0.0);
    ivec2 low = ivec2(floor(at));
    vec2 shares = at - vec2(low);
    return Texels(ivec2(wrapped(low.x, size.x, wrap.x), wrapped(low.y, size.y, wrap.y)),
                  ivec2(wrapped(low.x + 1, size.x, wrap.x), wrapped(low.y + 1, size.y, wrap.y)),
                  linear ? shares : vec2(0.0));
}

// The opacity between four texels, row by row.
float between(Texels t, vec4 texels)
{
    vec2 rows = mix(texels.xz, texels.yw, t.shares.x);
    return mix(rows.x, rows.y, t.shares.y);
}

// Whether an opacity stops a ray: against the cutoff, or without one against `even`, which is spread evenly over 0..1 among
// the rays. What is no number stops it.
bool stops(float opacity, float cutoff, uint bits, float even)
{
    bool above = !(opacity < cutoff);
    bool chosen = !(opacity <= even);
    return (bits & HAS_CUTOFF) != 0u ? above : chosen;
}

// Numbers that are spread evenly over 0..1 among neighbours: multiples of two irrational numbers (Weyl 1916). Each of sixteen
// kinds of triangle has two others, so that pairs and triples of numbers of one place are spread evenly, too: what lets
// light through behind each other does so independently. The number of a triangle tells its kind.
float even_number(vec2 at, uint triangle)
{
    uint pair = triangle >> 2u & 3u;
    vec2 by = vec2(0.31662479, 0.60555128);
    by = pair == 0u ? vec2(0.75487767, 0.56984029) : by;
    by = pair == 1u ? vec2(0.41421356, 0.73205081) : by;
    by = pair == 2u ? vec2(0.23606798, 0.64575131) : by;
    vec2 other = by.yx;
    by = (triangle & 1u) != 0u ? other : by;
    other = vec2(by.x, -by.y);
    by = (triangle & 2u) != 0u ? other : by;
    return fract(dot(fract(at * by), vec2(1.0)) + float(triangle * 0x9e3779b9u >> 20u) / 4096.0);
}

#endif
