// The maps of a segment's two samples. One of them was made for the segment before, so they take turns.

#ifndef LINEAR_LIGHT_SLOTS_GLSL
#define LINEAR_LIGHT_SLOTS_GLSL

// The nearest occluder in a texel of a sample's map: stored is near times w, 0 is nothing.
float occluder_at(int slot, ivec2 p)
{
    return slot == 0 ? texelFetch(occluders_0, p, 0).x : texelFetch(occluders_1, p, 0).x;
}

// The nearest surface of any kind.
float surface_at(int slot, ivec2 p)
{
    float receiver = slot == 0 ? texelFetch(receivers_0, p, 0).x : texelFetch(receivers_1, p, 0).x;
    return max(occluder_at(slot, p), receiver);
}

#endif
