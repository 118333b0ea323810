// Unit vectors as two numbers: the octahedron's surface, unfolded into [-1, 1]^2 (Meyer et al. 2010).

#ifndef RAY_MARCH_NORMAL_GLSL
#define RAY_MARCH_NORMAL_GLSL

vec2 over_the_edge(vec2 flat_n)
{
    return (1.0 - abs(flat_n.yx)) * vec2(flat_n.x < 0.0 ? -1.0 : 1.0, flat_n.y < 0.0 ? -1.0 : 1.0);
}

vec2 folded(vec3 n)
{
    vec2 flat_n = n.xy / max(abs(n.x) + abs(n.y) + abs(n.z), 1.0e-30);
    return n.z < 0.0 ? over_the_edge(flat_n) : flat_n;
}

vec3 unfolded(vec2 flat_n)
{
    float z = 1.0 - abs(flat_n.x) - abs(flat_n.y);
    return normalize(vec3(z < 0.0 ? over_the_edge(flat_n) : flat_n, z));
}

#endif
