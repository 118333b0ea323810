//! The helper that says what a module binds: on every committed module, and on a made-up one.

use antumbra_tests::compile::{committed, to_bytes, try_compile};
use antumbra_tests::reflect::{Binding, PushMember, reflect};
use ash::vk;

#[test]
fn every_committed_module_can_be_reflected() {
    let failures: Vec<_> = committed()
        .into_iter()
        .filter_map(|(name, spirv)| Some(format!("spirv/{name}.spv: {}", reflect(&spirv).err()?)))
        .collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn every_kind_of_binding_is_told_apart() {
    let source = "#version 450\n#extension GL_EXT_samplerless_texture_functions : require\n\
        layout(local_size_x = 8, local_size_y = 4) in;\n\
        layout(set = 0, binding = 0) uniform texture2D depth;\n\
        layout(set = 0, binding = 1, std430) readonly buffer In { vec4 rows[]; };\n\
        layout(set = 0, binding = 2, std430) buffer Out { float sums[]; };\n\
        layout(set = 0, binding = 3, r32f) uniform writeonly image2D result;\n\
        layout(push_constant) uniform Push { vec3 axis; uint width; mat4 m; };\n\
        void main() {\n\
            ivec2 at = ivec2(gl_GlobalInvocationID.xy);\n\
            float d = texelFetch(depth, at, 0).r + (m * rows[at.x]).x + axis.x;\n\
            sums[at.y * width + at.x] += d;\n\
            imageStore(result, at, vec4(d));\n\
        }\n";
    let found = reflect(&to_bytes(&try_compile("kinds.comp", source).unwrap())).unwrap();
    let binding = |binding, name: &str, kind, reads, writes, format| {
        let name = name.into();
        Binding { set: 0, binding, name, kind, reads, writes, format }
    };
    let no_format = vk::Format::UNDEFINED;
    use vk::DescriptorType as Kind;
    assert_eq!(
        found.bindings,
        [
            binding(0, "depth", Kind::SAMPLED_IMAGE, true, false, no_format),
            binding(1, "In", Kind::STORAGE_BUFFER, true, false, no_format),
            binding(2, "Out", Kind::STORAGE_BUFFER, true, true, no_format),
            binding(3, "result", Kind::STORAGE_IMAGE, false, true, vk::Format::R32_SFLOAT),
        ]
    );
    let member = |name: &str, offset, size| PushMember { name: name.into(), offset, size };
    assert_eq!(found.push, [member("axis", 0, 12), member("width", 12, 4), member("m", 16, 64)]);
    assert_eq!(found.push_bytes(), 80);
    assert_eq!(found.workgroup, [8, 4, 1]);
}

#[test]
fn a_shader_that_binds_nothing_is_reflected_too() {
    let source = "#version 450\nvoid main() { gl_Position = vec4(0.0); }\n";
    let found = reflect(&to_bytes(&try_compile("nothing.vert", source).unwrap())).unwrap();
    assert!(found.bindings.is_empty() && found.push.is_empty());
    assert_eq!((found.push_bytes(), found.workgroup), (0, [0; 3]));
}
