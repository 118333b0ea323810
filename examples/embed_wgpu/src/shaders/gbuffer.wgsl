struct Object {
    clip_from_mesh: mat4x4f,
    world_from_normal: mat3x3f,
    role: f32, // 1 blocks and receives, 1/2 receives only, 0 only blocks
}

@group(0) @binding(0) var<uniform> object: Object;

struct Corner {
    @builtin(position) position: vec4f,
    @location(0) normal: vec3f,
}

@vertex
fn vertex(@location(0) position: vec3f, @location(1) normal: vec3f) -> Corner {
    return Corner(object.clip_from_mesh * vec4f(position, 1.0), object.world_from_normal * normal);
}

struct Pixel {
    @location(0) normal: vec4f,
    @location(1) role: f32,
}

@fragment
fn fragment(corner: Corner) -> Pixel {
    let square = dot(corner.normal, corner.normal);
    let normal = select(vec3f(0.0), corner.normal * inverseSqrt(square), square > 0.0);
    return Pixel(vec4f(normal, 0.0), object.role);
}
