// Where slices begin and end, and which of them a distance lies in.
//
// The distances that the occluders reach are cut into BINS equal parts; a slice is a run of these. The
// placement is an image of one row: of every bin the slice that it belongs to, then of every slice the
// distances of its upper plane, its lower plane and its texture, in metres from the light.

#ifndef OCCLUSION_TEXTURES_PLACEMENT_GLSL
#define OCCLUSION_TEXTURES_PLACEMENT_GLSL

// Many small numbers divide it, so that equal slices are equal.
const int BINS = 960;

// The bin of a depth that a projection from behind the light stores (near/d), with `near` the distance of
// the near plane and `span` that of the far one from it, both from the projection point or both in units
// of near.
int bin_of(float stored, float near, float span)
{
    float t = (near / stored - near) / span;
    return clamp(int(t * float(BINS)), 0, BINS - 1);
}

// The first bin of a slice of `slices` equal ones.
int equal_bin(int slice, int slices)
{
    return (slice * BINS + slices / 2) / slices;
}

#endif
