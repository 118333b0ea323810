// Entered from ray_march/level.comp, ray_march/column.glsl and occlusion_textures/levels.glsl; at first skip what is behind VALUE.
//
// The levels of a map: each node of a level holds a value for a window of the map's texels.
//
//     kind      a window of level k    one begins at every
//     N_BUFFER  2^k x 2^k texels       texel                   (Decoret 2005)
//     THIRDS    3^k x 3^k              texel                   (Curtis 2009, section 5.1)
//     MIP       2^k x 2^k              2^k-th texel
//
// Level 0 is the map itself. Windows lie within the map; only MIP's last ones may stick out behind its end.
//
// In memory a level is a layer of an image array as large as the map, but MIP's from level 1 on share one:
//
//     layer 0         layer 1
//     ┌───────────┐   ┌─────┬──┬──┐
//     │           │   │     │2 │  │
//     │  the map  │   │  1  ├─┬┘  │
//     │           │   │     │3│   │
//     └───────────┘   └─────┴─┴───┘

#ifndef NBUFFER_LEVELS_GLSL
#define NBUFFER_LEVELS_GLSL

const int N_BUFFER = 0;
const int THIRDS = 1;
const int MIP = 2;

struct Levels {
    int map; // the map's side in texels
    int kind;
};

int power_of_three(int k)
{
    return ((k & 1) == 0 ? 1 : 3) * ((k & 2) == 0 ? 1 : 9) * ((k & 4) == 0 ? 1 : 81) *
           ((k & 8) == 0 ? 1 : 6561);
}

// The largest k for which 3^k is no more than x.
int log_three(int x)
{
    return int(x >= 3) + int(x >= 9) + int(x >= 27) + int(x >= 81) + int(x >= 243) + int(x >= 729) +
           int(x >= 2187);
}

// The least k for which 2^k is no less than x.
int log_above(int x)
{
    return findMSB(2 * x - 1);
}

// A window's side in texels.
int window_of(Levels l, int level)
{
    return l.kind == THIRDS ? power_of_three(level) : 1 << level;
}

// The number of windows along a side of a level.
int side_of(Levels l, int level)
{
    return l.kind == MIP ? ((l.map - 1) >> level) + 1 : l.map + 1 - window_of(l, level);
}

// The last level. No window is larger than the map, except that MIP's last one may stick out of it.
int top_of(Levels l)
{
    return l.kind == THIRDS ? log_three(l.map) : l.kind == MIP ? log_above(l.map) : findMSB(l.map);
}

// The layers of an image array that hold the map and all its levels.
int layers_of(Levels l)
{
    return l.kind == MIP ? min(top_of(l), 1) + 1 : top_of(l) + 1;
}

// The node of a level whose window begins at a texel or, for MIP, holds it; moved inside where there is no such node.
ivec2 node_at(Levels l, int level, ivec2 texel)
{
    return clamp(l.kind == MIP ? texel >> level : texel, ivec2(0), ivec2(side_of(l, level) - 1));
}

// The texel (xy) and the layer (z) at which a node is kept.
ivec3 place_of(Levels l, int level, ivec2 node)
{
    if (l.kind != MIP || level == 0) {
        return ivec3(node, level);
    }
    // MIP's levels from 2 on lie below each other, each with the room that the next power of two would need. They fit,
    // because that power is less than twice the map's side.
    int next = 1 << log_above(l.map);
    return ivec3(node + (level == 1 ? ivec2(0) : ivec2(side_of(l, 1), next / 2 - (next >> level - 1))), 1);
}

#ifdef VALUE
// Values of nodes: how a level is made from the one before it, and what any window holds. Before it includes this, the
// including shader names the value's type by `#define VALUE`, and declares two functions: `combine` makes one value of
// two, `value_at` reads a node's value. With `#define MEAN` values are added up and divided by their number, and texels
// outside the map are 0; without it, combining a value with itself must not change it, as for a minimum or a maximum.

#ifdef MEAN
#define SHARE(v, parts) ((v) / (parts))
#else
#define SHARE(v, parts) (v)
#endif

VALUE combine(VALUE a, VALUE b);
VALUE value_at(Levels l, int level, ivec2 node);

// Combines four nodes of a level that lie `apart` nodes from each other.
VALUE combined_four(Levels l, int level, ivec2 node, int apart)
{
    return combine(combine(value_at(l, level, node), value_at(l, level, node + ivec2(apart, 0))),
                   combine(value_at(l, level, node + ivec2(0, apart)), value_at(l, level, node + apart)));
}

// The value of a node of level 1 or above, from the level before it.
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
    // Windows and their parts lie within the map.
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
// The value of a window that contains a square window: of up to twice as many texels a side (three times for THIRDS).
// For MIP, and where no window is as large, it is `window_value`.
VALUE window_value(Levels l, ivec2 first, int side);

VALUE wider_window_value(Levels l, ivec2 first, int side)
{
    int level = l.kind == THIRDS ? log_three(3 * side - 1) : log_above(side);
    if (l.kind == MIP || level > top_of(l)) {
        return window_value(l, first, side);
    }
    return value_at(l, level, node_at(l, level, first));
}

// The value of a square window, over exactly its texels; for MIP over up to 16 times as many around them. A window that
// would stick out of the map is moved inside whole; one larger than the map is the map.
VALUE window_value(Levels l, ivec2 first, int side)
{
    side = min(side, l.map);
    first = clamp(first, ivec2(0), ivec2(l.map - side));
    int level = l.kind == THIRDS ? log_three(side) : l.kind == MIP ? log_above(side) : findMSB(side);
    // Neighbouring windows that cover it overlap.
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

#endif
