#version 450
#extension GL_EXT_samplerless_texture_functions : require

// visibility x unshadowed irradiance. The irradiance of the whole rectangle knows nothing of what
// stands in between; the visible fraction is all that shadows add.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform texture2D depth;
layout(set = 0, binding = 1) uniform texture2D normal;
layout(set = 0, binding = 2) uniform texture2D visibility;
layout(set = 0, binding = 3, rgba8) writeonly uniform image2D picture;

layout(push_constant) uniform Push {
    mat4 world_from_ndc;
    vec4 radiance; // of the light
    vec4 center;   // of the light
    vec4 half_u;   // from the centre to the middle of an edge
    vec4 half_v;   // likewise; light leaves along half_v x half_u
} push;

const vec3 BACKGROUND = vec3(0.028, 0.032, 0.040);
const float ALBEDO = 0.8;
const float AMBIENT = 0.05;
const int GRID = 4; // points a side of the light

float irradiance(vec3 position, vec3 n)
{
    vec3 emission = cross(push.half_v.xyz, push.half_u.xyz); // as long as a quarter of the area
    float sum = 0.0;
    for (int i = 0; i < GRID * GRID; ++i) {
        vec2 at = (vec2(i % GRID, i / GRID) + 0.5) * 2.0 / float(GRID) - 1.0;
        vec3 to_light = push.center.xyz + at.x * push.half_u.xyz + at.y * push.half_v.xyz - position;
        float r2 = max(dot(to_light, to_light), 1.0e-6);
        sum += max(dot(n, to_light), 0.0) * max(-4.0 * dot(emission, to_light), 0.0) / (r2 * r2);
    }
    return sum / float(GRID * GRID);
}

vec3 srgb(vec3 x)
{
    x = clamp(x, 0.0, 1.0);
    return mix(12.92 * x, 1.055 * pow(x, vec3(1.0 / 2.4)) - 0.055, greaterThan(x, vec3(0.0031308)));
}

void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    ivec2 extent = imageSize(picture);
    if (p.x >= extent.x || p.y >= extent.y) {
        return;
    }
    float d = texelFetch(depth, p, 0).x;
    vec3 color = BACKGROUND;
    if (d > 0.0) { // reversed depth: 0 is where nothing was drawn
        vec2 ndc = (vec2(p) + 0.5) * 2.0 / vec2(extent) - 1.0;
        vec4 world = push.world_from_ndc * vec4(ndc, d, 1.0);
        float e = irradiance(world.xyz / world.w, texelFetch(normal, p, 0).xyz);
        float v = texelFetch(visibility, p, 0).x;
        color = ALBEDO * (v * e * push.radiance.rgb + AMBIENT);
    }
    imageStore(picture, p, vec4(srgb(color), 1.0));
}
