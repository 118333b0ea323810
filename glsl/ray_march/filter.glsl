// How noisy pixels are filtered: a Gaussian over their own surface, along rows and then along columns
// (Curtis 2009 section 3, with normals as proposed there).
//
// Its width is where what it takes from the noise is what it adds by blurring. The visible fraction goes from
// 0 to 1 over the penumbra's width W; a Gaussian of standard deviation a spoils the two ends of the ramp,
// by (a/W)^2 in the mean over the penumbra, and leaves 1/(2 a sqrt(pi)) of independent noise N a pixel, a in
// pixels. Their sum is least at a^3 = N W^2 / (4 sqrt(pi)).

#ifndef RAY_MARCH_FILTER_GLSL
#define RAY_MARCH_FILTER_GLSL

#include "common/receiver.glsl"

// Pixels to either side, at most.
const int REACH = 12;

// The noise of this many rays in the mean over a penumbra: for one ray 2v(1 - v), whose mean is 1/3 where v
// rises evenly; falling with the root of the rays where each goes anywhere, and with their 3/4th power where
// each has a part of the light of its own and shadows have edges. (Measured on spheres: 0.30 for one ray,
// exponents -0.51 for random, -0.73 for jittered and -0.77 for low-discrepancy points.)
float noise_of(int rays, bool random)
{
    return 0.33 * pow(float(rays), random ? -0.5 : -0.75);
}

// The Gaussian's standard deviation in metres, by the penumbra's width and a pixel's; 0 where it is too
// narrow to change anything.
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

// How wide a pixel is at its own depth, m.
float pixel_width(mat4 light_from_ndc, vec2 pixel, ivec2 extent, float depth)
{
    return distance(position_of(light_from_ndc, pixel + vec2(1.0, 0.0), extent, depth),
                    position_of(light_from_ndc, pixel, extent, depth));
}

// How much a neighbour counts: by how far away it is, how far off the pixel's plane, and how its own surface
// is turned. `width` is the Gaussian's.
float filter_weight(vec3 apart, vec3 normal, vec3 its_normal, float width)
{
    float off_plane = dot(apart, normal);
    float turned = max(dot(normal, its_normal), 0.0);
    // Off the plane it falls four times as fast.
    float squares = dot(apart, apart) + 15.0 * off_plane * off_plane;
    return exp(-0.5 * squares / (width * width)) * pow(turned, 16.0);
}

#endif
