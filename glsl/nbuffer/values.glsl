// A map's levels as values: how a level is made from the one before it, and what a window holds.
//
// The including shader says what a value is, and how two become one:
//     #define VALUE vec4
//     VALUE combine(VALUE a, VALUE b)
//     VALUE value_at(int level, int index)   the map's own where level is 0
// With `#define MEAN` the values are added up and divided by their number, what lies outside the map being
// 0; without, combining a value with itself must not change it, as the least and the largest do not.

#ifndef NBUFFER_VALUES_GLSL
#define NBUFFER_VALUES_GLSL

#include "nbuffer/levels.glsl"

// What a node of a level from 1 on holds, by the level before it.
VALUE combined(Levels l, int level, ivec2 node)
{
    int finer = level - 1;
    ivec2 first = l.kind == MIP ? 2 * node : node;
    int at = index_of(l, finer, first);
    // To the next part along a row, and to that along a column.
    int across = l.kind == MIP ? 1 : window_of(l, finer);
    int down = across * row_of(l, finer);
    bvec2 there = lessThan(first + across, ivec2(side_of(l, finer)));
    VALUE v = value_at(finer, at);
    if (there.x) {
        v = combine(v, value_at(finer, at + across));
    }
    if (there.y) {
        v = combine(v, value_at(finer, at + down));
    }
    if (there.x && there.y) {
        v = combine(v, value_at(finer, at + across + down));
    }
    if (l.kind == THIRDS) {
        for (int i = 0; i < 3; ++i) {
            v = combine(v, value_at(finer, at + 2 * across + i * down));
            if (i < 2) {
                v = combine(v, value_at(finer, at + i * across + 2 * down));
            }
        }
    }
#ifdef MEAN
    v /= l.kind == THIRDS ? 9.0 : 4.0;
#endif
    return v;
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
    return value_at(level, index_of(l, level, node_at(l, level, first)));
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
    VALUE v = value_at(level, index_of(l, level, from));
    for (ivec2 at = from; at != to;) {
        at = at.x < to.x ? ivec2(min(at.x + apart, to.x), at.y)
                         : ivec2(from.x, min(at.y + apart, to.y));
        v = combine(v, value_at(level, index_of(l, level, at)));
    }
    return v;
}
#endif

#endif
