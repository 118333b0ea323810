// Entry of the pass ray_march.level (src/techniques/ray_march/passes.rs).
#version 450
#extension GL_GOOGLE_include_directive : require

// Writes the bounds of a level's windows from those of the level before it; the first level is made from the columns.
// With `#define USUAL` the windows are an N-buffer's.

#include "ray_march/column.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0, rgba32f) uniform image2DArray windows;

layout(push_constant) uniform Push {
    int map;   // the map's side in texels
    int kind;  // the kind of the levels' windows
    int level; // the level to make
} push;

#define VALUE vec4
#include "nbuffer/levels.glsl"

// A CPU that stands in for a GPU runs through the branches of every possible kind: with `#define USUAL` a level takes
// half of the time.
int level_kind()
{
#ifdef USUAL
    return N_BUFFER;
#else
    return push.kind;
#endif
}

vec4 combine(vec4 a, vec4 b)
{
    return max(a, b);
}

vec4 value_at(Levels l, int level, ivec2 node)
{
    vec4 v = imageLoad(windows, place_of(l, level, node));
    return level == 0 ? bounds_of(v) : v;
}

void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    Levels l = Levels(push.map, level_kind());
    int side = side_of(l, push.level);
    if (p.x < side && p.y < side) {
        imageStore(windows, place_of(l, push.level, p), combined(l, push.level, p));
    }
}
