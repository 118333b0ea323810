// Workgroups of an indirect dispatch whose number a shader counts. They stand in rows, because not every device takes
// more than 65,535 in x.

#ifndef COMMON_GROUPS_GLSL
#define COMMON_GROUPS_GLSL

const uint GROUPS_A_ROW = 16384u;

// Which of the workgroups one is.
uint nth_group(uvec2 id)
{
    return id.y * GROUPS_A_ROW + id.x;
}

// Workgroups in x and y that reach as far as the nth.
uvec2 groups_as_far_as(uint nth)
{
    return uvec2(min(nth + 1u, GROUPS_A_ROW), nth / GROUPS_A_ROW + 1u);
}

#endif
