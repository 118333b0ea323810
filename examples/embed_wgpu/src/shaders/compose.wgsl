// visibility × unshadowed irradiance. The irradiance of the whole rectangle knows nothing of what
// stands in between; the visible fraction is all that shadows add.

struct Uniforms {
    world_from_ndc: mat4x4f, // y down
    center: vec4f,           // of the light
    half_u: vec4f,           // from the centre to the middle of an edge
    half_v: vec4f,           // likewise; light leaves along half_v × half_u
    radiance: vec4f,
}

@group(0) @binding(0) var<uniform> scene: Uniforms;
@group(0) @binding(1) var depth: texture_depth_2d;
@group(0) @binding(2) var normal: texture_2d<f32>;
@group(0) @binding(3) var visibility: texture_2d<f32>;
@group(0) @binding(4) var picture: texture_storage_2d<rgba8unorm, write>;

const BACKGROUND = vec3f(0.028, 0.032, 0.040);
const ALBEDO = 0.8;
const AMBIENT = 0.05;
const PI = 3.14159265;
const GRID = 4; // points a side of the light

fn irradiance(position: vec3f, n: vec3f) -> f32 {
    let emission = cross(scene.half_v.xyz, scene.half_u.xyz); // as long as a quarter of the area
    var sum = 0.0;
    for (var i = 0; i < GRID * GRID; i++) {
        let at = (vec2f(f32(i % GRID), f32(i / GRID)) + 0.5) * 2.0 / f32(GRID) - 1.0;
        let point = scene.center.xyz + at.x * scene.half_u.xyz + at.y * scene.half_v.xyz;
        let to_light = point - position;
        let r2 = max(dot(to_light, to_light), 1.0e-6);
        sum += max(dot(n, to_light), 0.0) * max(-4.0 * dot(emission, to_light), 0.0) / (r2 * r2);
    }
    return sum / f32(GRID * GRID);
}

fn srgb(linear: vec3f) -> vec3f {
    let x = saturate(linear);
    return select(1.055 * pow(x, vec3f(1.0 / 2.4)) - 0.055, 12.92 * x, x <= vec3f(0.0031308));
}

@compute @workgroup_size(8, 8)
fn compose(@builtin(global_invocation_id) id: vec3u) {
    let p = id.xy;
    let extent = textureDimensions(picture);
    if any(p >= extent) {
        return;
    }
    let d = textureLoad(depth, p, 0);
    var color = BACKGROUND;
    if d > 0.0 { // reversed depth: 0 is where nothing was drawn
        let ndc = (vec2f(p) + 0.5) * 2.0 / vec2f(extent) - 1.0;
        let world = scene.world_from_ndc * vec4f(ndc, d, 1.0);
        let e = irradiance(world.xyz / world.w, textureLoad(normal, p, 0).xyz);
        let v = textureLoad(visibility, p, 0).x;
        color = ALBEDO * (v * e / PI * scene.radiance.xyz + AMBIENT);
    }
    textureStore(picture, p, vec4f(srgb(color), 1.0));
}
