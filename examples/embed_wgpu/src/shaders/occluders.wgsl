// Positions to the light's clip space; depth is all that is drawn.

@group(0) @binding(0) var<uniform> clip_from_mesh: mat4x4f;

@vertex
fn vertex(@location(0) position: vec3f) -> @builtin(position) vec4f {
    return clip_from_mesh * vec4f(position, 1.0);
}
