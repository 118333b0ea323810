//! The descriptor set layout and the pipeline layout of a kind of pass.

use super::owner::ObjectOwner;
use crate::Error;
use ash::vk;
use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

/// The descriptor set layout and the pipeline layout of a pass.
#[derive(Clone, Copy, Default)]
pub(super) struct PassLayouts {
    pub set: vk::DescriptorSetLayout,
    /// The layout of set 1, for passes that have one for each mesh; else a null handle.
    pub mesh: vk::DescriptorSetLayout,
    pub pipeline: vk::PipelineLayout,
}

/// The declarations of both layouts: the bindings of one set, and the push constants' stages and bytes.
pub(super) struct LayoutsInfo<'a> {
    pub bindings: &'a [vk::DescriptorSetLayoutBinding<'a>],
    pub push_stages: vk::ShaderStageFlags,
    pub push_bytes: u32,
    /// What set 1 holds of a mesh.
    pub of_mesh: OfMesh,
}

/// What a pass's set 1 holds, which is bound anew for each mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum OfMesh {
    /// There is no set 1.
    Nothing,
    /// The mesh's positions and indices.
    Triangles,
    /// The mesh's texture coordinates, its opacity texture, and its indices.
    CutOut,
}

impl OfMesh {
    fn bindings(self) -> &'static [(vk::DescriptorType, vk::ShaderStageFlags)] {
        use vk::{DescriptorType as Type, ShaderStageFlags as Stage};
        const COMPUTE: Stage = Stage::COMPUTE;
        const VERTEX: Stage = Stage::from_raw(Stage::VERTEX.as_raw() | COMPUTE.as_raw());
        const FRAGMENT: Stage = Stage::from_raw(Stage::FRAGMENT.as_raw() | COMPUTE.as_raw());
        match self {
            Self::Nothing => &[],
            Self::Triangles => &[(Type::STORAGE_BUFFER, COMPUTE); 2],
            Self::CutOut => &[
                (Type::STORAGE_BUFFER, VERTEX),
                (Type::SAMPLED_IMAGE, FRAGMENT),
                (Type::STORAGE_BUFFER, COMPUTE),
            ],
        }
    }
}

impl PassLayouts {
    /// Creates both layouts for the pass of a name, and passes them to `owner`.
    pub fn new(
        owner: &mut ObjectOwner,
        device: &ash::Device,
        info: &LayoutsInfo,
        pass: &str,
    ) -> Result<Self, Error> {
        let doing = |what: &str| format!("creating the {what} of {pass}");
        let create = vk::DescriptorSetLayoutCreateInfo::default().bindings(info.bindings);
        // SAFETY: the device is valid (Host::borrow); a test holds every pass's bindings against its
        // shader.
        let set = unsafe { device.create_descriptor_set_layout(&create, None) }
            .map_err(Error::vulkan(doing("descriptor set layout")))?;
        owner.keep(set);
        let ranges = [vk::PushConstantRange {
            stage_flags: info.push_stages,
            offset: 0,
            size: info.push_bytes,
        }];
        let mut mesh = vk::DescriptorSetLayout::null();
        let of_mesh = info.of_mesh.bindings();
        if !of_mesh.is_empty() {
            let bindings: Vec<_> = (0u32..)
                .zip(of_mesh)
                .map(|(binding, &(kind, stages))| {
                    vk::DescriptorSetLayoutBinding::default()
                        .binding(binding)
                        .descriptor_type(kind)
                        .descriptor_count(1)
                        .stage_flags(stages)
                })
                .collect();
            let create = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
            // SAFETY: as above.
            mesh = unsafe { device.create_descriptor_set_layout(&create, None) }
                .map_err(Error::vulkan(doing("descriptor set layout of the meshes")))?;
            owner.keep(mesh);
        }
        let set_layouts = [set, mesh];
        let set_layouts = &set_layouts[..1 + usize::from(!of_mesh.is_empty())];
        let mut create = vk::PipelineLayoutCreateInfo::default().set_layouts(set_layouts);
        if info.push_bytes > 0 {
            create = create.push_constant_ranges(&ranges);
        }
        // SAFETY: the set layout was just made; the range is within the guaranteed 128 bytes.
        let pipeline = unsafe { device.create_pipeline_layout(&create, None) }
            .map_err(Error::vulkan(doing("pipeline layout")))?;
        owner.keep(pipeline);
        Ok(Self { set, mesh, pipeline })
    }
}

/// The descriptor set layouts and pipeline layouts of one device, which outlive the nodes made with them. Passes with
/// equal bindings and push constants share a pair.
///
/// A host that creates nodes again and again passes this to each of them with [`super::Host::with_layouts`].
/// SwiftShader's pipeline cache looks up compiled code by the layout object as well as the shader, and so finds nothing
/// for a node with layouts of its own.
#[derive(Default)]
pub struct SharedLayouts(Mutex<(HashMap<Key, PassLayouts>, ObjectOwner)>);

/// The key of a pair: number, type and stages of each binding; stages and bytes of the push constants; what there is of a
/// mesh.
type Key =
    (Vec<(u32, vk::DescriptorType, vk::ShaderStageFlags)>, vk::ShaderStageFlags, u32, OfMesh);

impl SharedLayouts {
    /// Finds the layouts with these declarations, or creates them; the table owns them.
    pub(super) fn find(
        &self,
        device: &ash::Device,
        info: &LayoutsInfo,
        pass: &str,
    ) -> Result<PassLayouts, Error> {
        let bindings = info.bindings.iter();
        let bindings = bindings.map(|b| (b.binding, b.descriptor_type, b.stage_flags)).collect();
        let key = (bindings, info.push_stages, info.push_bytes, info.of_mesh);
        let (known, owner) = &mut *self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(&layouts) = known.get(&key) {
            return Ok(layouts);
        }
        let layouts = PassLayouts::new(owner, device, info, pass)?;
        known.insert(key, layouts);
        Ok(layouts)
    }

    /// Destroys all layouts.
    ///
    /// # Safety
    /// The device is alive and the one that the nodes were made on; those nodes and everything that they retired are
    /// destroyed.
    pub unsafe fn destroy(&self, device: &ash::Device) {
        let mut table = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let (_, owner) = std::mem::take(&mut *table);
        // Layouts have no memory to free.
        owner.destroy(device, |_| {});
    }
}
