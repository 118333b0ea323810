// The levels of a map: what windows of its texels hold, for a window at every texel or at few.
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

// The largest k of which 3^k is no more than x.
int log_three(int x)
{
    return int(x >= 3) + int(x >= 9) + int(x >= 27) + int(x >= 81) + int(x >= 243) + int(x >= 729) +
           int(x >= 2187);
}

// The least k of which 2^k is no less than x.
int log_above(int x)
{
    return findMSB(2 * x - 1);
}

// Texels a side of a window.
int window_of(Levels l, int level)
{
    return l.kind == THIRDS ? power_of_three(level) : 1 << level;
}

// Windows a side.
int side_of(Levels l, int level)
{
    return l.kind == MIP ? ((l.map - 1) >> level) + 1 : l.map + 1 - window_of(l, level);
}

// The last level: no window is larger than the map, but for MIP's only one there, which holds all of it.
int top_of(Levels l)
{
    return l.kind == THIRDS ? log_three(l.map) : l.kind == MIP ? log_above(l.map) : findMSB(l.map);
}

// The node of a level whose window begins at a texel, or holds it, as near to it as there is one.
ivec2 node_at(Levels l, int level, ivec2 texel)
{
    return clamp(l.kind == MIP ? texel >> level : texel, ivec2(0), ivec2(side_of(l, level) - 1));
}

// Where a node is kept: texel and layer.
ivec3 place_of(Levels l, int level, ivec2 node)
{
    if (l.kind != MIP || level == 0) {
        return ivec3(node, level);
    }
    // Below each other from level 2 on, with the room that the next power of two would need: it is no
    // more than the map has, as that is less than twice as large as the map.
    int next = 1 << log_above(l.map);
    return ivec3(node + (level == 1 ? ivec2(0) : ivec2(side_of(l, 1), next / 2 - (next >> level - 1))), 1);
}

#endif
