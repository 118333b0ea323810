//! Every committed module passes naga and translates to WGSL, so that an engine on wgpu can run the
//! same shaders.

use antumbra_tests::compile::{committed, to_bytes, try_compile};
use naga::valid::{Capabilities, ValidationFlags, Validator};

/// Push constants (naga's immediates) are the one capability beyond WebGPU's baseline.
const CAPABILITIES: Capabilities = Capabilities::IMMEDIATES;

/// SPIR-V to WGSL through naga's frontend, validator and backend.
fn translate(spirv: &[u8]) -> Result<String, String> {
    let options = naga::front::spv::Options::default();
    let module = naga::front::spv::parse_u8_slice(spirv, &options)
        .map_err(|error| format!("naga cannot read it: {error}"))?;
    let info = Validator::new(ValidationFlags::all(), CAPABILITIES)
        .validate(&module)
        .map_err(|error| format!("naga finds it invalid: {}", chain(&error)))?;
    let flags = naga::back::wgsl::WriterFlags::empty();
    naga::back::wgsl::write_string(&module, &info, flags)
        .map_err(|error| format!("naga cannot write it as WGSL: {}", chain(&error)))
}

/// An error with its causes.
fn chain(error: &dyn std::error::Error) -> String {
    let causes = std::iter::successors(Some(error), |error| error.source());
    causes.map(ToString::to_string).collect::<Vec<_>>().join(": ")
}

#[test]
fn committed_modules_translate_to_wgsl() {
    let failures: Vec<_> = committed()
        .into_iter()
        .filter_map(|(name, spirv)| Some(format!("spirv/{name}.spv: {}", translate(&spirv).err()?)))
        .collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn the_kinds_of_binding_that_the_shaders_use_translate() {
    let source = "#version 450\n#extension GL_EXT_samplerless_texture_functions : require\n\
        layout(local_size_x = 8, local_size_y = 8) in;\n\
        layout(set = 0, binding = 0) uniform texture2D depth;\n\
        layout(set = 0, binding = 1, std430) readonly buffer In { vec4 rows[]; };\n\
        layout(set = 0, binding = 2, std430) buffer Out { float sums[]; };\n\
        layout(set = 0, binding = 3, r32f) uniform writeonly image2D result;\n\
        layout(push_constant) uniform Push { uint width; };\n\
        void main() {\n\
            ivec2 at = ivec2(gl_GlobalInvocationID.xy);\n\
            float d = texelFetch(depth, at, 0).r + rows[at.x].x;\n\
            sums[at.y * width + at.x] = d;\n\
            imageStore(result, at, vec4(d));\n\
        }\n";
    let wgsl = translate(&to_bytes(&try_compile("kinds.comp", source).unwrap())).unwrap();
    assert!(wgsl.contains("textureStore") && wgsl.contains("@workgroup_size(8, 8"), "{wgsl}");
}

#[test]
fn what_naga_cannot_do_is_caught() {
    let source = "#version 450\nlayout(local_size_x = 1) in;\n\
        layout(set = 0, binding = 0, r32ui) uniform uimage2D counts;\n\
        void main() { imageAtomicAdd(counts, ivec2(0), 1u); }\n";
    let spirv = to_bytes(&try_compile("atomic.comp", source).unwrap());
    let problem = translate(&spirv).unwrap_err();
    assert!(problem.contains("naga"), "{problem}");
    assert!(translate(&spirv[..spirv.len() / 2]).is_err());
}
