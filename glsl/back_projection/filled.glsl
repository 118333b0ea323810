// Entered from back_projection.comp.
//
// Back-projection of texels, with the gaps between neighbouring texels filled.

#ifndef BACK_PROJECTION_FILLED_GLSL
#define BACK_PROJECTION_FILLED_GLSL

#include "common/light_space.glsl"

// The fraction of the light that a texel with magnification k hides, where its rectangle on the light is extended to
// the edges of the texels before it along x and y: surfaces have no gaps.
float filled_occlusion(vec2 lo, vec2 t, float k, float k_left, float k_above, vec2 scale)
{
    vec2 a = (lo - t) * scale;
    vec2 b = (lo + 1.0 - t) * scale * k;
    float left = k_left > 0.0 ? min(a.x * k, a.x * k_left) : a.x * k;
    float above = k_above > 0.0 ? min(a.y * k, a.y * k_above) : a.y * k;
    return k > 0.0 ? overlap(left, b.x) * overlap(above, b.y) : 0.0;
}

#endif
