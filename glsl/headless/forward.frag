#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require

// Ray marching without a G-buffer: every fragment that passes the depth test when it is drawn traces its rays, whatever
// is drawn over it later (Curtis 2009 section 4.2, "deferred shading: no"). The functions are those of classify.comp
// and trace.comp; there is no list and no filter.

#define FORWARD
#define USUAL
#include "ray_march/pixel.glsl"

layout(push_constant) uniform Mesh {
    layout(offset = 124) uint flags; // see headless/gbuffer.vert
} mesh;

layout(location = 0) out float visible;

// The normal of the triangle's plane, by the derivatives over neighbouring fragments, which may lie outside of it.
vec3 fragment_normal;

vec3 pixel_normal(ivec2 p, Receiver r)
{
    return !r.blocks && dot(fragment_normal, r.position) > 0.0 ? -fragment_normal : fragment_normal;
}

void main()
{
    ivec2 p = ivec2(gl_FragCoord.xy);
    float role = float(mesh.flags & 255u) / 255.0;
    Receiver r;
    r.receives = role > 0.25;
    r.blocks = role > 0.75;
    // A G-buffer would hold this very depth.
    r.position = dehomogenize(
        unproject(gbuffer.light_from_ndc, vec2(p), vec2(gbuffer.extent), gl_FragCoord.z));
    r.normal = vec3(0.0);
    fragment_normal = plane_normal(dFdx(r.position), dFdy(r.position),
                                   towards_viewer(gbuffer.light_from_ndc, r.position, gbuffer.background));
    uint hidden = mesh.flags >> 8u & 3u;
    if (hidden == (gl_FrontFacing ? 1u : 2u)) {
        discard;
    }
    float v;
    Reach reach;
    if (is_open(p, r, v, reach)) {
        v = found_by_rays(p, r, reach.start, reach.end).visible;
    }
    visible = v;
}
