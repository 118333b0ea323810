//! What the rows of a kind are bound by: a descriptor set layout and a pipeline layout.

use crate::Error;
use ash::vk;
use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

/// Both layouts of a row.
#[derive(Clone, Copy, Default)]
pub(super) struct RowLayouts {
    pub set: vk::DescriptorSetLayout,
    pub pipeline: vk::PipelineLayout,
}

/// What they say: the bindings of one set, and the push constants' stages and bytes.
pub(super) struct LayoutsInfo<'a> {
    pub bindings: &'a [vk::DescriptorSetLayoutBinding<'a>],
    pub push_stages: vk::ShaderStageFlags,
    pub push_bytes: u32,
}

impl RowLayouts {
    /// Makes both for the row of this name; nothing is left behind where that fails.
    pub fn new(device: &ash::Device, info: &LayoutsInfo, row: &str) -> Result<Self, Error> {
        let mut made = Self::default();
        match made.make(device, info, row) {
            Ok(()) => Ok(made),
            Err(e) => {
                made.destroy(device);
                Err(e)
            }
        }
    }

    fn make(&mut self, device: &ash::Device, info: &LayoutsInfo, row: &str) -> Result<(), Error> {
        let doing = |what: &str| format!("creating the {what} of {row}");
        let create = vk::DescriptorSetLayoutCreateInfo::default().bindings(info.bindings);
        // SAFETY: the device is valid (Host::borrow); a test holds every row's bindings against its
        // shader.
        self.set = unsafe { device.create_descriptor_set_layout(&create, None) }
            .map_err(Error::vulkan(doing("descriptor set layout")))?;
        let ranges = [vk::PushConstantRange {
            stage_flags: info.push_stages,
            offset: 0,
            size: info.push_bytes,
        }];
        let set_layouts = [self.set];
        let mut create = vk::PipelineLayoutCreateInfo::default().set_layouts(&set_layouts);
        if info.push_bytes > 0 {
            create = create.push_constant_ranges(&ranges);
        }
        // SAFETY: the set layout was just made; the range is within the guaranteed 128 bytes.
        self.pipeline = unsafe { device.create_pipeline_layout(&create, None) }
            .map_err(Error::vulkan(doing("pipeline layout")))?;
        Ok(())
    }

    /// Destroys both; nothing may use them any more.
    pub fn destroy(self, device: &ash::Device) {
        // SAFETY: made by this device; Host::borrow's promise: no command uses them any more. Null
        // handles are legal to destroy.
        unsafe { device.destroy_pipeline_layout(self.pipeline, None) };
        // SAFETY: as above.
        unsafe { device.destroy_descriptor_set_layout(self.set, None) };
    }
}

/// The descriptor set layouts and pipeline layouts of one device, which outlive the nodes made with them: one
/// pair for all passes that are bound alike.
///
/// A host that makes nodes again and again gives this to each of them by [`super::Host::with_layouts`].
/// SwiftShader finds what it has compiled by the identity of the layout besides the shader, so its pipeline
/// cache holds nothing for a node that makes layouts of its own.
#[derive(Default)]
pub struct SharedLayouts(Mutex<HashMap<Key, RowLayouts>>);

/// Binding, type and stages of each binding; stages and bytes of the push constants.
type Key = (Vec<(u32, vk::DescriptorType, vk::ShaderStageFlags)>, vk::ShaderStageFlags, u32);

impl SharedLayouts {
    /// Those that say this, made where there are none yet; they stay the table's.
    pub(super) fn find(
        &self,
        device: &ash::Device,
        info: &LayoutsInfo,
        row: &str,
    ) -> Result<RowLayouts, Error> {
        let bindings = info.bindings.iter();
        let bindings = bindings.map(|b| (b.binding, b.descriptor_type, b.stage_flags)).collect();
        let key = (bindings, info.push_stages, info.push_bytes);
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(&layouts) = known.get(&key) {
            return Ok(layouts);
        }
        let layouts = RowLayouts::new(device, info, row)?;
        known.insert(key, layouts);
        Ok(layouts)
    }

    /// Destroys all of them.
    ///
    /// # Safety
    /// The device is the one that the nodes were made on, it lives, and those nodes and everything that they
    /// retired are destroyed.
    pub unsafe fn destroy(&self, device: &ash::Device) {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        known.drain().for_each(|(_, layouts)| layouts.destroy(device));
    }
}
