#version 450

// No skins yet: the arguments of two draws.

layout(local_size_x = 1) in;

layout(set = 0, binding = 0, std430) buffer Left { uint left_draw[4]; };
layout(set = 0, binding = 1, std430) buffer Right { uint right_draw[4]; };

void main()
{
    left_draw[0] = 0u;
    left_draw[1] = 1u;
    left_draw[2] = 0u;
    left_draw[3] = 0u;
    right_draw[0] = 0u;
    right_draw[1] = 1u;
    right_draw[2] = 0u;
    right_draw[3] = 0u;
}
