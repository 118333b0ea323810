// Entered from traced/tiles.comp, traced/gather.comp and traced/cover.comp.
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

struct Shaft {
    vec4 low;   // the sides where x and y are least: x >= low.x + low.y z, y >= low.z + low.w z
    vec4 high;  // and largest
    vec3 least; // the box around the receivers in light space
    uint pixels; // a bit for each of the tile's pixels whose receiver is in the group
    vec3 most;
};

Shaft empty_shaft()
{
    float none = 3.0e38;
    return is_sun()
        ? Shaft(vec4(none, half_light.x, none, half_light.y),
                vec4(-none, -half_light.x, -none, -half_light.y), vec3(none), 0u, vec3(-none))
        : Shaft(vec4(-half_light.x, none, -half_light.y, none),
                vec4(half_light.x, -none, half_light.y, -none), vec3(none), 0u, vec3(-none));
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

// Sets light space for the receivers of a shaft, in the tile whose first pixel is `corner`.
void face_light(Shaft shaft, ivec2 corner)
{
    int first = findLSB(shaft.pixels);
    Receiver r = Receiver(false, vec3(0.0), vec3(0.0));
    if (frame.kind == ROUND && first >= 0) {
        r = receiver_of(corner + ivec2(first % TILE_SIDE, first / TILE_SIDE));
    }
    face_light(r.position);
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
Plane in_steps(vec4 plane, vec3 root_low, vec3 root_step)
{
    vec4 world = plane.x * light_x + plane.y * light_y + plane.z * light_z;
    world.w += plane.w;
    vec3 reach = abs(root_low) + 65535.0 * root_step;
    float slack = ROUNDING * 4.0 * (dot(abs(world.xyz), reach) + abs(plane.x * light_x.w) +
                                    abs(plane.y * light_y.w) + abs(plane.z * light_z.w) + abs(plane.w));
    return plane_of(vec4(world.xyz * root_step, world.w + dot(world.xyz, root_low) + slack));
}

Planes planes_of(Shaft shaft, vec3 root_low, vec3 root_step)
{
    Planes planes;
    planes.left = in_steps(vec4(1.0, 0.0, -shaft.low.y, -shaft.low.x), root_low, root_step);
    planes.bottom = in_steps(vec4(0.0, 1.0, -shaft.low.w, -shaft.low.z), root_low, root_step);
    planes.right = in_steps(vec4(-1.0, 0.0, shaft.high.y, shaft.high.x), root_low, root_step);
    planes.top = in_steps(vec4(0.0, -1.0, shaft.high.w, shaft.high.z), root_low, root_step);
    planes.far = in_steps(vec4(0.0, 0.0, -1.0, shaft.most.z), root_low, root_step);
    planes.near = in_steps(is_sun() ? vec4(0.0, 0.0, 0.0, 1.0) : vec4(0.0, 0.0, 1.0, 0.0), root_low, root_step);
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
