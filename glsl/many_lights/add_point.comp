// Entry of the pass many_lights.add_point (src/techniques/many_lights/mod.rs).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "common/compare.glsl"

// Adds 1 to the count of each pixel from which one point of the light is hidden: one comparison with the point's map.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform texture2D positions;
layout(set = 0, binding = 1) uniform texture2D normals;
layout(set = 0, binding = 2) uniform texture2D point_depth;
layout(set = 0, binding = 3, r32f) uniform image2D hidden_points;

layout(push_constant) uniform Push {
    vec2 point;         // the point's place on the light, m; of parallel light how x and y go on a metre towards it
    vec2 texels_per_uv; // map texels a unit of u and v, in the point's map
    vec2 first;         // texel coordinates of u = v = 0
    ivec2 extent;       // the G-buffer's width and height
    float inv_near;     // 1 over the map's near plane, 1/m; or its height, m
    float snap;         // how far a raster moves a vertex, in texels
    int map;            // the map's side in texels
    int parallel;       // 1 where light is parallel
} push;

bool hidden(ivec2 pixel)
{
    vec4 position = texelFetch(positions, pixel, 0);
    if (position.w <= 0.0) {
        return false;
    }
    vec3 normal = texelFetch(normals, pixel, 0).xyz;
    // Under a sun the point is a direction: x and y are made the same all along the ray to it, and planes are turned along.
    bool parallel = push.parallel != 0;
    vec3 p = position.xyz + vec3(push.point * (parallel ? position.z : -1.0), 0.0);
    normal.z -= parallel ? dot(normal.xy, push.point) : 0.0;
    float c = parallel ? normal.z : dot(normal, p);
    // The point lies below the pixel's own surface.
    if (c >= 0.0) {
        return true;
    }
    float w = parallel ? -p.z : 1.0 / p.z;
    MapPlane m = map_plane_at(p.xy * (parallel ? 1.0 : w), w, normal.xy, parallel ? -dot(normal, p) : normal.z, c,
                              position.w == 2.0, push.texels_per_uv, push.first, push.snap, 0.0);
    ivec2 texel = ivec2(floor(m.t));
    if (any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, ivec2(push.map)))) {
        return false;
    }
    float w_o = texelFetch(point_depth, texel, 0).x * push.inv_near;
    return in_front(m, vec2(texel) + 0.5, w_o);
}

void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    if (p.x >= push.extent.x || p.y >= push.extent.y) {
        return;
    }
    // Whole numbers up to 4096: exact, whatever their order. Counting what is hidden leaves lit pixels alone.
    if (hidden(p)) {
        imageStore(hidden_points, p, vec4(imageLoad(hidden_points, p).x + 1.0));
    }
}
