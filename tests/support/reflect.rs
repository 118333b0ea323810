//! What a SPIR-V module says of its bindings, push constants and workgroup size.
//!
//! Names, types and offsets are spirv-reflect's; what it does not tell (who reads and writes, and the
//! workgroup size) is naga's.

use ash::vk;
use naga::{AddressSpace, ImageClass, StorageAccess, TypeInner};
use spirv_reflect::types::{ReflectDescriptorType, ReflectImageFormat};

/// A module's interface.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Interface {
    /// Sorted by set and binding.
    pub bindings: Vec<Binding>,
    /// Empty where there are no push constants.
    pub push: Vec<PushMember>,
    /// Invocations a workgroup in x, y, z; zeros for a vertex or fragment shader.
    pub workgroup: [u32; 3],
    /// Bytes that a workgroup's invocations share.
    pub shared_bytes: u32,
    /// The SPIR-V capabilities that it declares, by number.
    pub capabilities: Vec<u32>,
}

/// A resource that the module declares.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Binding {
    /// The descriptor set.
    pub set: u32,
    /// The binding in it.
    pub binding: u32,
    /// The variable's name, or the block's where the variable has none.
    pub name: String,
    /// What is bound.
    pub kind: vk::DescriptorType,
    /// The module may read it: it is not `writeonly`.
    pub reads: bool,
    /// The module may write it: a buffer or storage image that is not `readonly`.
    pub writes: bool,
    /// A storage image's format; `UNDEFINED` for others.
    pub format: vk::Format,
}

/// A member of the push constant block.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PushMember {
    /// Its name in GLSL.
    pub name: String,
    /// From the block's start, in bytes.
    pub offset: u32,
    /// In bytes, padding left out.
    pub size: u32,
}

impl Interface {
    /// Bytes from the start of the push constants to the end of the last member.
    pub fn push_bytes(&self) -> u32 {
        self.push.iter().map(|member| member.offset + member.size).max().unwrap_or(0)
    }
}

/// Reflects a module with one entry point.
///
/// # Errors
/// What either reader could not make sense of.
pub fn reflect(spirv: &[u8]) -> Result<Interface, String> {
    let options = naga::front::spv::Options::default();
    let module = naga::front::spv::parse_u8_slice(spirv, &options).map_err(|e| e.to_string())?;
    let [entry] = &module.entry_points[..] else {
        return Err(format!("{} entry points where one is expected", module.entry_points.len()));
    };
    let reflection = spirv_reflect::ShaderModule::load_u8_data(spirv)?;
    let mut bindings = Vec::new();
    for found in reflection.enumerate_descriptor_bindings(None)? {
        let (set, binding) = (found.set, found.binding);
        let (reads, writes) = access(&module, set, binding)
            .ok_or_else(|| format!("naga knows no binding {binding} in set {set}"))?;
        let type_name = found.type_description.map(|t| t.type_name).unwrap_or_default();
        let name = if found.name.is_empty() { type_name } else { found.name };
        let kind = descriptor_type(found.descriptor_type)?;
        let format = match kind {
            vk::DescriptorType::STORAGE_IMAGE => image_format(found.image.image_format)?,
            _ => vk::Format::UNDEFINED,
        };
        bindings.push(Binding { set, binding, name, kind, reads, writes, format });
    }
    bindings.sort_by_key(|b| (b.set, b.binding));
    let blocks = reflection.enumerate_push_constant_blocks(None)?;
    let push = blocks
        .iter()
        .flat_map(|block| &block.members)
        .map(|m| PushMember { name: m.name.clone(), offset: m.absolute_offset, size: m.size })
        .collect();
    let shared = module.global_variables.iter().filter(|(_, v)| v.space == AddressSpace::WorkGroup);
    let shared_bytes = shared.map(|(_, v)| module.types[v.ty].inner.size(module.to_ctx())).sum();
    let (workgroup, capabilities) = (entry.workgroup_size, capabilities(spirv));
    Ok(Interface { bindings, push, workgroup, shared_bytes, capabilities })
}

/// The operands of every OpCapability: an instruction's first word holds how many words it has, and which it is.
fn capabilities(spirv: &[u8]) -> Vec<u32> {
    const HEAD: usize = 5;
    const OP_CAPABILITY: u32 = 17;
    let words: Vec<u32> =
        spirv.chunks_exact(4).map(|w| u32::from_le_bytes([w[0], w[1], w[2], w[3]])).collect();
    let mut found = Vec::new();
    let mut at = HEAD;
    while let Some(first) = words.get(at) {
        if first & 0xffff == OP_CAPABILITY {
            found.push(words[at + 1]);
        }
        at += (first >> 16).max(1) as usize;
    }
    found
}

/// Whether the module may read and write a binding.
fn access(module: &naga::Module, set: u32, binding: u32) -> Option<(bool, bool)> {
    let wanted = naga::ResourceBinding { group: set, binding };
    let (_, variable) =
        module.global_variables.iter().find(|(_, v)| v.binding.as_ref() == Some(&wanted))?;
    let storage = match (variable.space, &module.types[variable.ty].inner) {
        (AddressSpace::Storage { access }, _) => access,
        (_, TypeInner::Image { class: ImageClass::Storage { access, .. }, .. }) => *access,
        _ => StorageAccess::LOAD,
    };
    Some((storage.contains(StorageAccess::LOAD), storage.contains(StorageAccess::STORE)))
}

fn descriptor_type(kind: ReflectDescriptorType) -> Result<vk::DescriptorType, String> {
    Ok(match kind {
        ReflectDescriptorType::Sampler => vk::DescriptorType::SAMPLER,
        ReflectDescriptorType::CombinedImageSampler => vk::DescriptorType::COMBINED_IMAGE_SAMPLER,
        ReflectDescriptorType::SampledImage => vk::DescriptorType::SAMPLED_IMAGE,
        ReflectDescriptorType::StorageImage => vk::DescriptorType::STORAGE_IMAGE,
        ReflectDescriptorType::UniformBuffer => vk::DescriptorType::UNIFORM_BUFFER,
        ReflectDescriptorType::StorageBuffer => vk::DescriptorType::STORAGE_BUFFER,
        other => return Err(format!("descriptors of type {other:?} are not used here")),
    })
}

fn image_format(format: ReflectImageFormat) -> Result<vk::Format, String> {
    Ok(match format {
        ReflectImageFormat::R32_FLOAT => vk::Format::R32_SFLOAT,
        ReflectImageFormat::RG32_FLOAT => vk::Format::R32G32_SFLOAT,
        ReflectImageFormat::RGBA32_FLOAT => vk::Format::R32G32B32A32_SFLOAT,
        ReflectImageFormat::RGBA16_FLOAT => vk::Format::R16G16B16A16_SFLOAT,
        ReflectImageFormat::RGBA32_UINT => vk::Format::R32G32B32A32_UINT,
        ReflectImageFormat::R32_UINT => vk::Format::R32_UINT,
        ReflectImageFormat::RGBA8 => vk::Format::R8G8B8A8_UNORM,
        other => return Err(format!("storage images of format {other:?} are not used here")),
    })
}
