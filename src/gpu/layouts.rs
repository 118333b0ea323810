//! What the passes of a kind are bound by: a descriptor set layout and a pipeline layout.

use super::owner::ObjectOwner;
use crate::Error;
use ash::vk;
use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

/// Both layouts of a pass.
#[derive(Clone, Copy, Default)]
pub(super) struct PassLayouts {
    pub set: vk::DescriptorSetLayout,
    pub pipeline: vk::PipelineLayout,
}

/// What both declare: the bindings of one set, and the push constants' stages and bytes.
pub(super) struct LayoutsInfo<'a> {
    pub bindings: &'a [vk::DescriptorSetLayoutBinding<'a>],
    pub push_stages: vk::ShaderStageFlags,
    pub push_bytes: u32,
}

impl PassLayouts {
    /// Makes both for the pass of this name, and gives them to `owner`.
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
        let set_layouts = [set];
        let mut create = vk::PipelineLayoutCreateInfo::default().set_layouts(&set_layouts);
        if info.push_bytes > 0 {
            create = create.push_constant_ranges(&ranges);
        }
        // SAFETY: the set layout was just made; the range is within the guaranteed 128 bytes.
        let pipeline = unsafe { device.create_pipeline_layout(&create, None) }
            .map_err(Error::vulkan(doing("pipeline layout")))?;
        owner.keep(pipeline);
        Ok(Self { set, pipeline })
    }
}

/// The descriptor set layouts and pipeline layouts of one device, which outlive the nodes made with them: one
/// pair for all passes that are bound alike.
///
/// A host that makes nodes again and again gives this to each of them by [`super::Host::with_layouts`].
/// SwiftShader finds what it has compiled by the identity of the layout besides the shader, so its pipeline
/// cache holds nothing for a node that makes layouts of its own.
#[derive(Default)]
pub struct SharedLayouts(Mutex<(HashMap<Key, PassLayouts>, ObjectOwner)>);

/// Binding, type and stages of each binding; stages and bytes of the push constants.
type Key = (Vec<(u32, vk::DescriptorType, vk::ShaderStageFlags)>, vk::ShaderStageFlags, u32);

impl SharedLayouts {
    /// Finds the layouts that declare this, and makes them where there are none yet; the table owns them.
    pub(super) fn find(
        &self,
        device: &ash::Device,
        info: &LayoutsInfo,
        pass: &str,
    ) -> Result<PassLayouts, Error> {
        let bindings = info.bindings.iter();
        let bindings = bindings.map(|b| (b.binding, b.descriptor_type, b.stage_flags)).collect();
        let key = (bindings, info.push_stages, info.push_bytes);
        let (known, owner) = &mut *self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(&layouts) = known.get(&key) {
            return Ok(layouts);
        }
        let layouts = PassLayouts::new(owner, device, info, pass)?;
        known.insert(key, layouts);
        Ok(layouts)
    }

    /// Destroys all of them.
    ///
    /// # Safety
    /// The device is the one that the nodes were made on, it lives, and those nodes and everything that they
    /// retired are destroyed.
    pub unsafe fn destroy(&self, device: &ash::Device) {
        let mut table = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let (_, owner) = std::mem::take(&mut *table);
        // Layouts have no memory of their own.
        owner.destroy(device, |_| {});
    }
}
