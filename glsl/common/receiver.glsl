// Receivers from the host's G-buffer: depth alone gives the position and the geometric plane.

#ifndef COMMON_RECEIVER_GLSL
#define COMMON_RECEIVER_GLSL

struct Receiver {
    bool receives;
    bool blocks;   // its own surface blocks light
    vec3 position; // light space, metres
    vec3 normal;   // of the plane that what hides it lies above: the surface's own where that blocks, on the
                   // viewer's side; where it does not, it is in no map, and whatever is nearer to the light hides it
};

const vec3 TOWARDS_LIGHT = vec3(0.0, 0.0, -1.0);

// A pixel with depth `depth` to a homogeneous point of light space. `ndc` runs from -1 to 1.
vec4 unproject(mat4 light_from_ndc, vec2 pixel, vec2 extent, float depth)
{
    vec2 ndc = (pixel + 0.5) * 2.0 / extent - 1.0;
    return light_from_ndc * vec4(ndc, depth, 1.0);
}

vec3 dehomogenize(vec4 p)
{
    return p.xyz / p.w;
}

// The direction from `p` to the viewer, not normalized. Column 2 of light_from_ndc is the image of
// the clip-space point (0, 0, 1, 0): the eye of a perspective camera; for an orthographic one the
// direction of growing depth, which points at the viewer where depth is reversed.
vec3 towards_viewer(mat4 light_from_ndc, vec3 p, float background)
{
    vec4 eye = light_from_ndc[2];
    if (eye.w != 0.0) {
        return eye.xyz / eye.w - p;
    }
    return background == 0.0 ? eye.xyz : -eye.xyz;
}

// A vector whose largest component is 1 or -1, or 0: products of four of them stay within a float, whatever the
// scene's scale.
vec3 of_unit_size(vec3 v)
{
    vec3 size = abs(v);
    return v / max(max(size.x, size.y), max(size.z, 1.2e-38));
}

// The unit normal of the plane through p and its neighbours along x and y, on the viewer's side.
vec3 plane_normal(vec3 along_x, vec3 along_y, vec3 to_viewer)
{
    vec3 n = cross(of_unit_size(along_x), of_unit_size(along_y));
    n *= inversesqrt(max(dot(n, n), 1.0e-38));
    return dot(n, to_viewer) < 0.0 ? -n : n;
}

#endif
