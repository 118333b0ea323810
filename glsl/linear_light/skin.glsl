// Entered from edges.comp, skins.vert and skins.frag.
//
// Skins: strips from the edge of an occluder that one sample sees to the receiver behind it, and the part of the light
// between that sample and its neighbour that a point behind a skin sees (Heidrich, Brabec and Seidel 2000, sections 3.1
// and 3.2).
//
// Samples of a line see a point at one height v, so a skin lies in one row of texels of either map. In inverse
// distance w it is straight: a ray that leaves the sample at tangent u_e is seen by the neighbour, `apart` metres
// towards -x from it, at u_e + apart * w.

#ifndef LINEAR_LIGHT_SKIN_GLSL
#define LINEAR_LIGHT_SKIN_GLSL

struct Skin {
    float u_edge; // the sample's ray past the occluder's edge, tangent
    float w_edge; // the edge, 1/m
    float w_seen; // the w of the surface that the sample sees beside the edge
    float row;    // the row of texels
};

// Whether an occluder ends between two neighbouring texels: the step in w is one that no plane makes, because a plane's
// w falls by the same amount from each texel to the next. Steps in the other direction are ignored. A surface that
// bends away by more than a fifth counts as one that ends. It hides as one does, so that its skin is not wrong; a
// missed edge lets light through. (Missed in the bunny's shadow: 15 spots with a threshold of twice the step, 2 with a
// fifth more, 2 with none, which takes twice as many skins.)
bool is_edge(float w_before, float w_near, float w_seen, float w_behind)
{
    float step = w_near - w_seen;
    float before = max(w_before - w_near, 0.0);
    float behind = max(w_seen - w_behind, 0.0);
    // The last term is the rounding of the four values.
    return step > 1.2 * min(before, behind) + 1.0e-6 * w_near;
}

// The w of the receiver beside the edge, or of the furthest receiver where the map shows none.
float w_beside(Skin s, float w_far)
{
    return max(s.w_seen, w_far);
}

// The w at which the ray past the edge crosses the neighbour's u, in tangents or in texels. The neighbour sees the ray
// at `ray` for w = 0, and moving by `step` with w.
float crossing_of(float ray, float u, float step)
{
    return (u - ray) / step;
}

// The part of the light between the two samples that a point behind the skin sees, where the skin's ray is at
// w_crossing: 0 at the occluder, 1 at the receiver. With the w of the receiver beside the edge it grows evenly
// (section 3.2); with the point's own w it is the rational function of eq. 1, exact on receivers of any slope.
float transition(float w_edge, float w_crossing, float w_receiver)
{
    float whole = w_edge - w_receiver;
    return whole > 0.0 ? clamp((w_edge - w_crossing) / whole, 0.0, 1.0) : 1.0;
}

#endif
