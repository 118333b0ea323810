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

const float FAR = 1.0e9;

// A line of samples: row j crosses it at x + y j.
struct Line {
    vec2 at;
    bool least; // whether the samples behind it are hidden, not those before it
};

// The line where the plane n of light space, dot(n.xy, s.xy) + c = 0, meets the light.
Line line_of(vec2 n, float c)
{
    vec2 step = n * 2.0 * frame.half_light / float(SIDE);
    float k = c - dot(n, frame.half_light) + 0.5 * step.y;
    // A plane along the rows bounds none of the samples of a row, or all.
    float least = 1.0e-7 * (abs(step.y) * float(SIDE) + abs(k)) + 1.0e-37;
    float x = abs(step.x) < least ? (step.x < 0.0 ? -least : least) : step.x;
    return Line(vec2(-k, -step.y) / x, x > 0.0);
}

vec2 least_of(Line line)
{
    return line.least ? line.at : vec2(-FAR, 0.0);
}

vec2 most_of(Line line)
{
    return line.least ? vec2(FAR, 0.0) : line.at;
}

// The mask of a row whose samples between two places are hidden; a sample at the very edge of two triangles belongs to
// one of them. The samples of a row begin at 1 - `shift`.
uint interval(float least, float most, float shift)
{
    int from = int(clamp(least + shift, 0.0, float(SIDE)));
    int to = int(clamp(most + shift, 0.0, float(SIDE)));
    return (1u << to) - 1u & 0xffffffffu << from;
}

#endif
