// Entered from traced/cover.comp.
//
// The samples of the light that a triangle hides from a receiver, as a bit mask.
//
// The samples lie in rows along the light's x: in row j of n the i-th is at (i + offset(j)) / n of the width. A triangle
// and a receiver make three planes, each through the receiver and an edge, and a segment to the light meets the triangle
// where it is inside of all three and ends beyond the triangle's own plane. In a row each of the four is a bound on i, so
// that the hidden samples of a row are an interval of bits.

#ifndef TRACED_COVER_GLSL
#define TRACED_COVER_GLSL

// Samples along a side of the light.
const int SIDE = 8;
const int ROWS_A_WORD = 32 / SIDE;
const int WORDS = SIDE * SIDE / 32;

// The offset of the samples of a row, in 0 to 1: the eight rows have all eighths, far from those of rows nearby, so that
// no two samples of the light lie in one column.
float row_offset(int row)
{
    const int order[8] = int[8](0, 4, 2, 6, 1, 5, 3, 7);
    return (float(order[row & 7]) + 0.5) / 8.0;
}

const float FAR = 1.0e9;

// The bound of a plane on i in row j: x + y j at least where `lower`, else at most.
struct Bound {
    vec2 least;
    vec2 most;
};

// The bound on the samples inside of the plane n of light space: those s with dot(n.xy, s.xy) + c >= 0.
Bound bound_of(vec2 n, float c, vec2 half_light)
{
    float x = n.x * 2.0 * half_light.x / float(SIDE);
    float y = n.y * 2.0 * half_light.y / float(SIDE);
    float k = c - dot(n, half_light) + 0.5 * y;
    // A plane along the rows bounds none of the samples of a row, or all.
    float least = 1.0e-7 * (abs(y) * float(SIDE) + abs(k)) + 1.0e-37;
    x = abs(x) < least ? (x < 0.0 ? -least : least) : x;
    vec2 line = vec2(-k, -y) / x;
    return Bound(x > 0.0 ? line : vec2(-FAR, 0.0), x > 0.0 ? vec2(FAR, 0.0) : line);
}

// The mask of a row whose bits from `first` to `last` are hidden.
uint interval(float first, float last)
{
    int from = int(clamp(ceil(first), 0.0, float(SIDE)));
    int to = int(clamp(floor(last) + 1.0, 0.0, float(SIDE)));
    return (1u << to) - 1u & 0xffffffffu << from;
}

#endif
