// Entered from traced/tiles.comp and traced/gather.comp.
//
// A shaft: the region that holds every segment from a group of receivers to the light.
//
//        light              In x and in y of light space a line on either side: through the light's edge past the
//       -a     a            outermost receiver, or for a sun through that receiver along the outermost ray. The
//       /     |             furthest receiver and the light's plane are its ends.
//      /      |
//     .  . . .  receivers

#ifndef TRACED_SHAFT_GLSL
#define TRACED_SHAFT_GLSL

#include "hierarchy/tree.glsl"

// How large the numbers are that the coordinates of light space are made of.
vec3 offsets;

// How much the samples' i and j (traced/cover.glsl) are turned against x and y.
float turn;

// From here on light space is grid space, turned so that x and y are the samples' own i and j, and the light ends at its
// outermost samples: what bounds it is tight. Where the light is much longer than wide, the turn would mix long and short,
// and be neither tight nor exact; there grid space is left as it is.
void enter_turned_grid(int side)
{
    float n = float(side);
    bool is_strip = max(half_light.x, half_light.y) > 2.0 * min(half_light.x, half_light.y);
    enter_grid(side);
    turn = is_strip ? 1.0 / n : 0.0;
    float by = is_strip ? 0.0 : 1.0 / n;
    vec4 i = light_x - by * light_y;
    vec4 j = light_y + by * light_x;
    offsets = vec3(abs(light_x.w) + abs(light_y.w) * by, abs(light_y.w) + abs(light_x.w) * by, abs(light_z.w));
    light_x = i / (1.0 + by * by);
    light_y = j / (1.0 + by * by);
    half_light = vec2(0.5 * n - (is_strip ? 0.5 / n : 0.5));
}

Shaft empty_shaft()
{
    float none = 3.0e38;
    Shaft shaft;
    vec4 edges = vec4(half_light.x, half_light.x, half_light.y, half_light.y);
    bvec4 slopes = is_sun() ? bvec4(false, true, false, true) : bvec4(true, false, true, false);
    shaft.low = mix(vec4(none), is_sun() ? edges : -edges, slopes);
    shaft.high = mix(vec4(-none), is_sun() ? -edges : edges, slopes);
    shaft.pixels = 0u;
    shaft.count = 0u;
    shaft.near = none;
    shaft.far = -none;
    return shaft;
}

Shaft with_receiver(Shaft shaft, vec3 p, uint pixel)
{
    if (is_sun()) {
        shaft.low.xz = min(shaft.low.xz, p.xy - half_light * p.z);
        shaft.high.xz = max(shaft.high.xz, p.xy + half_light * p.z);
    } else {
        shaft.low.yw = min(shaft.low.yw, (p.xy + half_light) / p.z);
        shaft.high.yw = max(shaft.high.yw, (p.xy - half_light) / p.z);
    }
    shaft.near = min(shaft.near, p.z);
    shaft.far = max(shaft.far, p.z);
    shaft.pixels |= 1u << pixel;
    return shaft;
}

// The planes of a shaft in steps of the root's box, as `furthest` takes them.
struct Planes {
    Plane left;
    Plane bottom;
    Plane right;
    Plane top;
    Plane far;
    Plane near;
};

// A plane of light space, (n, d) with n p + d >= 0 inside, in steps of the root's box; wider by `slack`, which is more than
// the arithmetic of it rounds.
Plane in_steps(vec4 plane, vec3 low, vec3 step)
{
    vec4 world = plane.x * light_x + plane.y * light_y + plane.z * light_z;
    world.w += plane.w;
    vec3 reach = abs(low) + 65535.0 * step;
    float slack = ROUNDING * 4.0 * (dot(abs(world.xyz), reach) + dot(abs(plane.xyz), offsets) + abs(plane.w));
    return plane_of(vec4(world.xyz * step, world.w + dot(world.xyz, low) + slack));
}

Planes planes_of(Shaft shaft)
{
    vec3 low = root_low();
    vec3 step = root_step();
    Planes planes;
    planes.left = in_steps(vec4(1.0, 0.0, -shaft.low.y, -shaft.low.x), low, step);
    planes.bottom = in_steps(vec4(0.0, 1.0, -shaft.low.w, -shaft.low.z), low, step);
    planes.right = in_steps(vec4(-1.0, 0.0, shaft.high.y, shaft.high.x), low, step);
    planes.top = in_steps(vec4(0.0, -1.0, shaft.high.w, shaft.high.z), low, step);
    planes.far = in_steps(vec4(0.0, 0.0, -1.0, shaft.far), low, step);
    planes.near = in_steps(is_sun() ? vec4(0.0, 0.0, 0.0, 1.0) : vec4(0.0, 0.0, 1.0, 0.0), low, step);
    return planes;
}

// Whether a node's box may meet the shaft.
bool meets(Planes planes, Node node)
{
    float a = min(furthest(planes.left, node), furthest(planes.bottom, node));
    float b = min(furthest(planes.right, node), furthest(planes.top, node));
    float c = min(furthest(planes.far, node), furthest(planes.near, node));
    return min(min(a, b), c) >= 0.0;
}

#endif
