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

Shaft empty_shaft()
{
    float none = 3.0e38;
    return is_sun()
        ? Shaft(vec4(none, half_light.x, none, half_light.y),
                vec4(-none, -half_light.x, -none, -half_light.y), vec3(none), 0u, vec3(-none), 0u)
        : Shaft(vec4(-half_light.x, none, -half_light.y, none),
                vec4(half_light.x, -none, half_light.y, -none), vec3(none), 0u, vec3(-none), 0u);
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
    shaft.least = min(shaft.least, p);
    shaft.most = max(shaft.most, p);
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

// A plane of light space, (n, d) with n p + d >= 0 inside, in steps of the root's box; `slack` metres wider, which is
// more than the arithmetic of it rounds.
Plane in_steps(vec4 plane, vec3 low, vec3 step)
{
    vec4 world = plane.x * light_x + plane.y * light_y + plane.z * light_z;
    world.w += plane.w;
    vec3 reach = abs(low) + 65535.0 * step;
    float slack = ROUNDING * 4.0 * (dot(abs(world.xyz), reach) + abs(plane.x * light_x.w) +
                                    abs(plane.y * light_y.w) + abs(plane.z * light_z.w) + abs(plane.w));
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
    planes.far = in_steps(vec4(0.0, 0.0, -1.0, shaft.most.z), low, step);
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
