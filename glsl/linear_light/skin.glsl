// Entered from edges.comp, skins.vert and skins.frag.
//
// Skins: where one sample of the light sees an occluder end, and what the light that lies between it and its
// neighbour sees of what is behind (Heidrich, Brabec and Seidel 2000, sections 3.1 and 3.2).
//
// Samples of a line see a point at one height v, so a skin lies in one row of texels of either map. In inverse
// distance w it is straight: a ray that leaves the sample at tangent u_e is seen by the neighbour, `apart` metres
// towards -x from it, at u_e + apart * w.

#ifndef LINEAR_LIGHT_SKIN_GLSL
#define LINEAR_LIGHT_SKIN_GLSL

struct Skin {
    float u_edge; // the sample's ray past the occluder's edge, tangent
    float w_edge; // the edge, 1/m
    float w_seen; // what the sample sees beside it
    float row;    // of texels
};

// Whether an occluder ends between two texels that lie side by side: by a step that is no plane's, whichever way it
// leans, because a plane's w falls by as much from each texel to the next. A step that goes the other way says nothing
// of this one. A surface that bends away by more than a fifth counts as one that ends. It hides as one does, so that
// its skin is not wrong; one that is missed lets light through. (Missed in the bunny's shadow: 15 spots with a step of
// twice as much, 2 with a fifth more, 2 with none, which takes twice as many skins.)
bool is_edge(float w_before, float w_near, float w_seen, float w_behind)
{
    float step = w_near - w_seen;
    float before = max(w_before - w_near, 0.0);
    float behind = max(w_seen - w_behind, 0.0);
    // Rounding of the four.
    return step > 1.2 * min(before, behind) + 1.0e-6 * w_near;
}

// The receiver beside the edge; where the map shows none, as far as the furthest there is.
float w_beside(Skin s, float w_far)
{
    return max(s.w_seen, w_far);
}

// The ray's w where the neighbour sees it at u, in tangents or in texels: it is at `ray` for w = 0 and moves by `step`
// with w.
float crossing_of(float ray, float u, float step)
{
    return (u - ray) / step;
}

// What a point behind the skin sees of the light between the two samples, seen at w_crossing by the neighbour: 0 at
// the occluder, 1 at the receiver. With the w of the receiver beside the edge it grows evenly (section 3.2); with
// the point's own it is the rational function of eq. 1, exact on receivers of any slope.
float transition(float w_edge, float w_crossing, float w_receiver)
{
    float whole = w_edge - w_receiver;
    return whole > 0.0 ? clamp((w_edge - w_crossing) / whole, 0.0, 1.0) : 1.0;
}

#endif
