// Entered from mask.comp.
//
// The solid part of a column: faces that bound it, and slices that lie inside.

#ifndef OCCLUSION_TEXTURES_SOLID_GLSL
#define OCCLUSION_TEXTURES_SOLID_GLSL

// A column walked from the light down, slice by slice.
struct Column {
    uint faces;  // bit k: slice k holds a face
    uint inside; // bit k: matter reaches from slice k into slice k + 1
    int depth;   // solids entered and not yet left
};

// Walks on to the next slice, which has `fronts` faces that look at the light and `backs` that look away from it.
Column walk(Column c, int slice, int fronts, int backs)
{
    c.depth += fronts - backs;
    c.faces |= uint(fronts + backs > 0) << uint(slice);
    c.inside |= uint(c.depth > 0) << uint(slice);
    return c;
}

// The slices that block, with a bit each. A column in which not everything entered is left again goes through an open
// mesh, which has no inside, and only its faces are known.
uint solid_of(Column c)
{
    return c.depth == 0 ? c.faces | c.inside | c.inside << 1 : c.faces;
}

#endif
