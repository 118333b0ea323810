struct Object {
    clip_from_mesh: mat4x4f,
    world_from_normal: mat3x3f,
    role: f32, // 1 blocks and receives, 1/2 receives only, 0 only blocks
}

@group(0) @binding(0) var<uniform> object: Object;

struct Corner {
    @builtin(position) position: vec4f,
    @location(0) normal: vec3f,
    @location(1) place: vec3f,
}

@vertex
fn vertex(@location(0) position: vec3f, @location(1) normal: vec3f) -> Corner {
    let clip = object.clip_from_mesh * vec4f(position, 1.0);
    return Corner(clip, object.world_from_normal * normal, position);
}

struct Pixel {
    @location(0) normal: vec4f,
    @location(1) role: f32,
    @location(2) plane: vec4f,
}

@fragment
fn fragment(corner: Corner) -> Pixel {
    let square = dot(corner.normal, corner.normal);
    let normal = select(vec3f(0.0), corner.normal * inverseSqrt(square), square > 0.0);
    // The triangle's own normal; the node takes either side.
    let across = cross(normalize(dpdx(corner.place)), normalize(dpdy(corner.place)));
    let plane = normalize(object.world_from_normal * across);
    return Pixel(vec4f(normal, 0.0), object.role, vec4f(plane, 0.0));
}
