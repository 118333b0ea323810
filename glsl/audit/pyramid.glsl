// Entered from audit/choose.comp and audit/trace.comp.
//
// What lies between a receiver and the light's figure.

#ifndef AUDIT_PYRAMID_GLSL
#define AUDIT_PYRAMID_GLSL

#include "hierarchy/tree.glsl"

// The turns of all loops of an invocation: some drivers end loops without a word after 65,535 of them.
const int MOST_TURNS = 60000;

// A plane about the tip, and the same in steps of the root's box: its parts above and below 0 on their own, so that the
// furthest corner of a box needs no choice.
struct Side {
    vec3 normal; // the inside is where dot(normal, p) >= offset
    float offset;
    vec3 above;
    vec3 below;
    float start;
};

// The pyramid between a receiver and a figure, in the hierarchy's space about the receiver. What lies outside of one of
// its sides hides nothing.
struct Pyramid {
    vec3 tip;
    Side a; // through the tip and the figure's edges
    Side b;
    Side c;
    Side d;
    Side base;       // the figure's plane
    vec3 corner[4];  // the figure's
};

// How much a product with a normal may be off for the arithmetic's rounding; `size` bounds the positions that it was
// made from.
float slack(vec3 normal, vec3 size)
{
    return 8.0 * ROUNDING * dot(abs(normal), size);
}

// The positions that the hierarchy's boxes and triangles about a tip are made from.
vec3 size_about(vec3 tip, vec3 low, vec3 step)
{
    return abs(tip) + abs(low) + 65535.0 * step;
}

Side side_of(vec3 normal, float offset, vec3 tip, vec3 low, vec3 step)
{
    float wider = offset - slack(normal, size_about(tip, low, step));
    vec3 steps = normal * step;
    return Side(normal, wider, max(steps, 0.0), min(steps, 0.0), dot(normal, low - tip) - wider);
}

Side edge_of(vec3 p, vec3 q, vec3 middle, vec3 tip, vec3 low, vec3 step)
{
    vec3 n = normalize(cross(p, q));
    return side_of(dot(n, middle) < 0.0 ? -n : n, 0.0, tip, low, step);
}

Pyramid pyramid_of(vec3 tip, Figure f, vec3 low, vec3 step)
{
    Pyramid p;
    p.tip = tip;
    vec3 middle = f.base - tip;
    // A line or a point has no pyramid of its own; one that is a little wider holds it.
    float least = 1.0e-3 * length(middle);
    vec3 u = f.u * max(f.half_size.x, least);
    vec3 v = f.v * max(f.half_size.y, least);
    p.corner = vec3[4](middle - u - v, middle + u - v, middle + u + v, middle - u + v);
    p.a = edge_of(p.corner[0], p.corner[1], middle, tip, low, step);
    p.b = edge_of(p.corner[1], p.corner[2], middle, tip, low, step);
    p.c = edge_of(p.corner[2], p.corner[3], middle, tip, low, step);
    p.d = edge_of(p.corner[3], p.corner[0], middle, tip, low, step);
    // Behind a sun there is nothing.
    p.base = push.kind == SUN_DISC ? Side(vec3(0.0), -1.0, vec3(0.0), vec3(0.0), 1.0)
                              : side_of(f.normal, dot(f.normal, middle), tip, low, step);
    return p;
}

float furthest(Side side, Node node)
{
    return dot(side.above, node.high) + (dot(side.below, node.low) + side.start);
}

// Whether a node's box may reach into the pyramid.
bool reaches(Pyramid p, Node node)
{
    float sides = min(min(furthest(p.a, node), furthest(p.b, node)), min(furthest(p.c, node), furthest(p.d, node)));
    return min(sides, furthest(p.base, node)) >= 0.0;
}

#endif
