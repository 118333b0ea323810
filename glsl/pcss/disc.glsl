// Entered from pcss.comp.
//
// The pattern of taps: points of a disc, mapped to the light's rectangle or to a rectangle around a place in a map.

#ifndef PCSS_DISC_GLSL
#define PCSS_DISC_GLSL

// Maps a disc's polar coordinates (radius, turn from 0 to 1) to the square [-1, 1]^2, equal areas to equal areas
// (Shirley and Chiu 1997): circles become squares, and an angle becomes a length along their sides.
vec2 disc_to_square(vec2 polar)
{
    float quarter = polar.y * 4.0 + 0.5;
    float along = (fract(quarter) * 2.0 - 1.0) * polar.x;
    int side = int(floor(quarter)) & 3;
    vec2 p = (side & 1) == 0 ? vec2(polar.x, along) : vec2(-along, polar.x);
    return side < 2 ? p : -p;
}

// How far a pixel's disc is turned, 0 to 1: multiples of the plastic number's reciprocal and its square,
// in integers, so that the turns of neighbouring pixels lie as far apart as they can.
float pixel_turn(uint x, uint y)
{
    return float((x * 3242174889u + y * 2447445414u) >> 8) / 16777216.0;
}

// Point i of n on the disc, as (radius, turn): a spiral by the golden angle, each point in its own ring of
// one area (Vogel 1979). No two are close, whatever n is.
vec2 disc_point(int i, int n)
{
    return vec2(sqrt((float(i) + 0.5) / float(n)), fract(float(i) * 0.618034));
}

#endif
