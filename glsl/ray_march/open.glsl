// Whether a pixel's visible fraction takes rays to tell.

#ifndef RAY_MARCH_OPEN_GLSL
#define RAY_MARCH_OPEN_GLSL

// Where it does not, `v` is the fraction; where it does, `reach` has the heights that its rays need look
// at. The receiver has a normal where that matters.
bool is_open(ivec2 p, inout Receiver r, out float v, out Reach reach)
{
    v = 1.0;
    reach = Reach(0.0, -1.0, false, vec2(0.0), 0.0, vec4(0.0));
    // Behind the light's plane there is nothing to hide.
    if (!r.receives || r.position.z <= 0.0) {
        return false;
    }
    reach = reach_of(place_of(r), r.position.z);
    bool open = reach.start <= reach.end;
    // Most pixels do without a normal.
    if (open || r.blocks) {
        r.normal = pixel_normal(p, r);
        v = part_above(r);
        // Which part of a texture is above the plane only rays tell.
        open = v > 0.0 && (open || (is_textured() && v < 1.0));
    }
    if (open && v == 1.0 && reach.whole && !looks_from_eye()) {
        Place place = place_of(r);
        if (stops_all(place, reach.from, reach.side, reach.bounds, place.w + reach.start,
                      place.w + reach.end)) {
            open = false;
            v = 0.0;
        }
    }
    return open;
}

#endif
