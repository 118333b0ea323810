// The list of pixels that rays are spent on, and the workgroups of the passes over it.

#ifndef RAY_MARCH_LIST_GLSL
#define RAY_MARCH_LIST_GLSL

#include "common/groups.glsl"

// Pixels a workgroup of the passes over the list, one an invocation.
const uint PIXELS_A_GROUP = 64u;

// The place in the list that an invocation works at.
uint place_in_list(uvec2 group, uint invocation)
{
    return nth_group(group) * PIXELS_A_GROUP + invocation;
}

// Workgroups in x and y that reach as far as a place in the list.
uvec2 groups_up_to(uint at)
{
    return groups_as_far_as(at / PIXELS_A_GROUP);
}

#endif
