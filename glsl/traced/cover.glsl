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

// Samples along a side of the light.
const int SIDE = 8;
const int ROWS_A_WORD = 32 / SIDE;
const int WORDS = SIDE * SIDE / 32;

const float FAR = 1.0e9;

// A line across the samples: those of a j meet it at i = x + y j.
struct Line {
    vec2 at;
    bool least; // whether the samples behind it are hidden, not those before it
};

// The line where the plane n of light space, dot(n.xy, s.xy) + c = 0, meets the light.
Line line_of(vec2 n, float c)
{
    const float TURN = 1.0 / float(SIDE);
    vec2 cell = n * frame.half_light * (2.0 * TURN);
    float k = c - dot(n, frame.half_light) + dot(cell, vec2(0.5 * TURN, 1.0 - 0.5 * TURN));
    float i = cell.x - cell.y * TURN;
    float j = cell.y + cell.x * TURN;
    // A plane along the samples of a j bounds none of them, or all.
    float least = 1.0e-7 * (abs(j) * float(SIDE) + abs(k)) + 1.0e-37;
    i = abs(i) < least ? (i < 0.0 ? -least : least) : i;
    return Line(vec2(-k, -j) / i, i > 0.0);
}

vec2 least_of(Line line)
{
    return line.least ? line.at : vec2(-FAR, 0.0);
}

vec2 most_of(Line line)
{
    return line.least ? vec2(FAR, 0.0) : line.at;
}

// The mask of the samples from above `least` to `most`; a sample at the very edge of two triangles belongs to one.
uint interval(float least, float most)
{
    int from = int(clamp(least + 1.0, 0.0, float(SIDE)));
    int to = int(clamp(most + 1.0, 0.0, float(SIDE)));
    return (1u << to) - 1u & 0xffffffffu << from;
}

#endif
