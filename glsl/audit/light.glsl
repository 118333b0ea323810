// Entered from audit/choose.comp and audit/trace.comp.
//
// The light as a pixel sees it: a figure in a plane, whose points all count the same (`antumbra::truth` has the table).

#ifndef AUDIT_LIGHT_GLSL
#define AUDIT_LIGHT_GLSL

const uint STADIUM = 1u;
const uint POLYGON = 2u;
const uint SPHERE = 3u;
const uint CAPSULE = 4u;
const uint POINT = 5u;
const uint SUN_DISC = 6u;

layout(push_constant) uniform Push {
    vec3 center;       // the light's, in the hierarchy's space
    float reach;       // m; 0 for a light without limit
    uint kind;         // one of those above; 0 for a rectangle or a line
    uint corner_count; // how many corners a polygon has
    float half_length; // half the length of a stadium's or a capsule's segment, m
    float radius;      // m; a sun's is a tangent
    uvec2 cells;       // along the image's width and height
    uint all_sides;    // 1 for a light that shines to all sides
    uint unused;
    uint corners[16];  // as shares of the light's width and height, 16 bits each
} push;

struct Figure {
    bool there;    // whether the light reaches the receiver at all
    vec3 base;     // its centre in the hierarchy's space; a sun's is a metre from the receiver
    vec3 u;        // unit vectors along its width and height
    vec3 v;
    vec3 normal;   // from it towards the receiver
    vec2 half_size; // half its width and height
    vec2 stadium;  // half the length and the radius of its segment; a radius of 0 for other shapes
    float end;     // the share of the way to it at which a segment ends: short of what lies in its plane
};

// Whether a pixel shows a receiver that the light may reach: in front of its plane, where it shines to one side.
bool is_lit(Receiver r)
{
    bool all_sides = push.all_sides != 0u;
    // A pixel without a receiver has no position.
    return r.receives || (all_sides && any(notEqual(r.in_light, vec3(0.0))));
}

bool within_reach(vec3 p)
{
    vec3 away = p - push.center;
    return push.reach == 0.0 || dot(away, away) <= push.reach * push.reach;
}

Figure figure_of(Receiver r)
{
    vec3 x = frame.light_x.xyz;
    vec3 z = frame.light_z.xyz;
    vec3 away = r.position - push.center;
    Figure f = Figure(true, push.center, x, frame.light_y.xyz, z, frame.half_light, vec2(0.0), 1.0);
    float distance = r.in_light.z;
    if (push.kind == STADIUM) {
        f.stadium = vec2(push.half_length, push.radius);
    } else if (push.kind == SPHERE || push.kind == POINT || (push.kind == CAPSULE && push.half_length == 0.0)) {
        distance = length(away);
        f.there = distance > push.radius;
        f.normal = f.there ? away / distance : z;
        f.u = normalize(cross(f.normal, abs(f.normal.x) < 0.7 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0)));
        f.v = cross(f.normal, f.u);
        // The disc within the cone that touches a sphere.
        float reach = sqrt(max((distance - push.radius) * (distance + push.radius), 1.0e-30));
        float radius = push.kind == SPHERE ? push.radius * distance / reach : push.radius;
        f.half_size = vec2(radius);
        f.stadium = vec2(0.0, radius);
    } else if (push.kind == CAPSULE) {
        float along = dot(away, x);
        distance = length(away - x * clamp(along, -push.half_length, push.half_length));
        f.there = distance > push.radius;
        vec3 aside = away - x * along;
        f.normal = dot(aside, aside) > 0.0 ? normalize(aside) : z;
        f.v = cross(f.normal, x);
        f.half_size = vec2(push.half_length + push.radius, push.radius);
        f.stadium = vec2(push.half_length, push.radius);
    } else if (push.kind == SUN_DISC) {
        f.base = r.position - z;
        f.stadium = vec2(0.0, push.radius);
        return f;
    }
    vec3 size = max(abs(r.position), abs(push.center));
    float short_of = 16.0 * ROUNDING * max(max(size.x, size.y), size.z);
    f.there = f.there && distance > 2.0 * short_of;
    f.end = 1.0 - short_of / max(distance, 2.0 * short_of);
    return f;
}

// The receiver itself: `turns`, which a walk counts down, is never so few. A compiler cannot know that, and so it makes a
// figure of this receiver anew instead of holding one in registers throughout the walk.
Receiver still(Receiver r, int turns)
{
    r.position = turns > -64 ? r.position : vec3(0.0);
    r.in_light = turns > -64 ? r.in_light : vec3(0.0);
    return r;
}

vec2 corner_at(uint nth)
{
    vec2 share = vec2(push.corners[nth] & 0xffffu, push.corners[nth] >> 16) / 65535.0;
    return share * 2.0 - 1.0;
}

// Whether a point of the rectangle around the figure, from -1 to 1, is of the figure.
bool is_of(Figure f, vec2 at)
{
    if (push.kind == POLYGON) {
        bool inside = false;
        vec2 a = corner_at(push.corner_count - 1u);
        for (uint i = 0u; i < push.corner_count; ++i) {
            vec2 b = corner_at(i);
            bool crosses = (a.y > at.y) != (b.y > at.y);
            float meets = a.x + (at.y - a.y) / (crosses ? b.y - a.y : 1.0) * (b.x - a.x);
            inside = inside != (crosses && at.x < meets);
            a = b;
        }
        return inside;
    }
    vec2 p = abs(at * f.half_size);
    p.x = max(p.x - f.stadium.x, 0.0);
    return f.stadium.y == 0.0 || dot(p, p) <= f.stadium.y * f.stadium.y;
}

#endif
