// What the layers say is solid over a texel, and whether a ray meets it.
//
// A column is (top, bottom, second top, second bottom): heights above the furthest, growing towards the
// light, between which there is matter; the second is below the first, 0 where there is none. A column of
// nothing is 0. Height is w = 1/distance from the projection point, or what is left to the far plane where
// the projection is orthographic: either way a straight line in space is one in (texels, height).

#ifndef RAY_MARCH_COLUMN_GLSL
#define RAY_MARCH_COLUMN_GLSL

const float FAR_OFF = 3.0e38;

// What a window's columns have in common, each the larger of two:
//     x   the highest top                   y   minus the lowest bottom
//     z   minus the lowest first top        w   the highest first bottom
// No ray is stopped above x or below -y; between w and -z, where that is an interval, every ray is.
vec4 bounds_of(vec4 column)
{
    if (column.x <= 0.0) {
        return vec4(0.0, -FAR_OFF, 0.0, FAR_OFF);
    }
    return vec4(column.x, -(column.z > 0.0 ? column.w : column.y), -column.x, column.y);
}

// How far a surface goes down from a texel at height h towards a neighbour: not at all where a step that
// is more than twice the one on the other side (or behind the neighbour, where there is none) says that
// the neighbour shows another surface. Heights of 0 are nothing.
float step_down(float h, float neighbour, float behind_it, float opposite)
{
    float drop = h - neighbour;
    float slope = opposite > 0.0 ? abs(h - opposite) : behind_it > 0.0 ? abs(neighbour - behind_it) : 0.0;
    return neighbour > 0.0 && drop <= 2.0 * slope ? max(drop, 0.0) : 0.0;
}

// What is left of a piece of matter over a texel, with surfaces that go so far up or down within half a
// texel at its top and its bottom. A column is as high all over its texel as at its centre; rays that graze a
// solid meet the corners that stick out of it, and no more than these are cut off: half the piece at most
// from either side, and nothing of a sheet.
vec2 beveled(vec2 piece, float above, float below)
{
    float most = 0.5 * max(piece.x - piece.y, 0.0);
    return vec2(piece.x - min(above, most), piece.y + min(below, most));
}

// The column of a solid between its nearest faces (top) and its furthest back faces, 0 where it has none.
vec4 one_interval(float top, float far_back)
{
    return vec4(top, far_back > 0.0 ? min(far_back, top) : top, 0.0, 0.0);
}

// The column of what has nearest faces, nearest back faces, furthest front faces and furthest back faces,
// each 0 where there are none. Matter reaches from a front face to the next back face; a face without its
// other side is a sheet.
vec4 two_intervals(float top, float near_back, float far_front, float far_back)
{
    float bottom = near_back > 0.0 ? near_back : top;
    if (far_front <= 0.0 || far_front >= bottom) {
        // No matter begins below the first that ends: one piece, or several that overlap.
        return one_interval(top, far_back);
    }
    float second = far_back > 0.0 ? min(far_back, far_front) : far_front;
    return vec4(top, bottom, far_front, second);
}

#endif
