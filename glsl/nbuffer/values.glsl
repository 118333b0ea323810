// A map's levels as values: how a level is made from the one before it, and what a window holds.
//
// The including shader says what a value is, how two become one, and where a node's value is:
//     #define VALUE vec4
//     VALUE combine(VALUE a, VALUE b)
//     VALUE value_at(Levels l, int level, ivec2 node)
// With `#define MEAN` the values are added up and divided by their number, what lies outside the map being
// 0; without, combining a value with itself must not change it, as the least and the largest do not.

#ifndef NBUFFER_VALUES_GLSL
#define NBUFFER_VALUES_GLSL

#include "nbuffer/levels.glsl"

#ifdef MEAN
#define SHARE(v, parts) ((v) / (parts))
#else
#define SHARE(v, parts) (v)
#endif

// Four nodes of a level, so far apart.
VALUE combined_four(Levels l, int level, ivec2 node, int apart)
{
    return combine(combine(value_at(l, level, node), value_at(l, level, node + ivec2(apart, 0))),
                   combine(value_at(l, level, node + ivec2(0, apart)), value_at(l, level, node + apart)));
}

// What a node of a level from 1 on holds, by the level before it.
VALUE combined(Levels l, int level, ivec2 node)
{
    int finer = level - 1;
    if (l.kind == MIP) {
        ivec2 first = 2 * node;
        bvec2 there = lessThan(first + 1, ivec2(side_of(l, finer)));
        VALUE v = value_at(l, finer, first);
        if (there.x) {
            v = combine(v, value_at(l, finer, first + ivec2(1, 0)));
        }
        if (there.y) {
            v = combine(v, value_at(l, finer, first + ivec2(0, 1)));
        }
        if (there.x && there.y) {
            v = combine(v, value_at(l, finer, first + 1));
        }
        return SHARE(v, 4.0);
    }
    // Windows lie in the map whole, and so do their parts.
    int apart = window_of(l, finer);
    VALUE four = combined_four(l, finer, node, apart);
    if (l.kind == N_BUFFER) {
        return SHARE(four, 4.0);
    }
    VALUE right = combine(value_at(l, finer, node + apart * ivec2(2, 0)),
                          value_at(l, finer, node + apart * ivec2(2, 1)));
    VALUE below = combine(value_at(l, finer, node + apart * ivec2(0, 2)),
                          value_at(l, finer, node + apart * ivec2(1, 2)));
    VALUE corner = value_at(l, finer, node + 2 * apart);
    return SHARE(combine(combine(four, right), combine(below, corner)), 9.0);
}

#ifndef MEAN
// What a window holds that has a square window within it: one value, of up to twice as many texels a side
// (three times, for THIRDS); as `window_value` for MIP, and where no window is as large.
VALUE window_value(Levels l, ivec2 first, int side);

VALUE wider_window_value(Levels l, ivec2 first, int side)
{
    int level = l.kind == THIRDS ? log_three(3 * side - 1) : log_above(side);
    if (l.kind == MIP || level > top_of(l)) {
        return window_value(l, first, side);
    }
    return value_at(l, level, node_at(l, level, first));
}

// What a square window holds: the least and the largest over exactly its texels, but for MIP, where they
// may be of up to 16 times as many around them. A window that would stick out of the map is moved inside
// whole; one larger than the map is the map.
VALUE window_value(Levels l, ivec2 first, int side)
{
    side = min(side, l.map);
    first = clamp(first, ivec2(0), ivec2(l.map - side));
    int level = l.kind == THIRDS ? log_three(side) : l.kind == MIP ? log_above(side) : findMSB(side);
    // The windows that cover it overlap.
    int apart = l.kind == MIP ? 1 : window_of(l, level);
    ivec2 from = l.kind == MIP ? first >> level : first;
    ivec2 to = l.kind == MIP ? (first + side - 1) >> level : first + side - apart;
    VALUE v = value_at(l, level, from);
    for (ivec2 at = from; at != to;) {
        at = at.x < to.x ? ivec2(min(at.x + apart, to.x), at.y)
                         : ivec2(from.x, min(at.y + apart, to.y));
        v = combine(v, value_at(l, level, at));
    }
    return v;
}
#endif

#endif
