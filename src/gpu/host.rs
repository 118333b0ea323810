//! The device that the host lends, and the requirements that it must meet.

use super::layouts::SharedLayouts;
use crate::Error;
use crate::frame::{Description, Limits};
use crate::graph::{INVOCATIONS, PUSH_BYTES};
use crate::stages::{depth_layers, visibility};
use ash::{ext, vk};
use std::ffi::CStr;
use std::sync::Arc;

/// The host's device and queue family, with what else it lends: a pipeline cache, debug labels, shared layouts.
#[derive(Clone)]
pub struct Host {
    pub(crate) instance: ash::Instance,
    pub(crate) physical_device: vk::PhysicalDevice,
    pub(crate) device: ash::Device,
    pub(crate) queue_family: u32,
    pub(crate) pipeline_cache: vk::PipelineCache,
    pub(super) pipeline_flags: vk::PipelineCreateFlags,
    /// Whether the device counts as a processor; `None` where it says that itself.
    processor: Option<bool>,
    pub(crate) debug_utils: Option<ext::debug_utils::Device>,
    /// The layouts that are shared with other nodes; `None` where each node makes its own.
    pub(super) layouts: Option<Arc<SharedLayouts>>,
}

impl Host {
    /// Borrows a device. Nothing is created, and nothing is destroyed when this goes away.
    ///
    /// `queue_family` is the one that the host's command buffers for the node belong to.
    ///
    /// # Safety
    /// This is the one promise that every later call on the node stands on:
    /// * the handles belong together, and outlive the node and everything it has retired;
    /// * every handle given later (command buffers, images, views, buffers) is valid for this
    ///   device, was created with the usage that the docs name, and stays alive until the commands
    ///   that use it are done;
    /// * command buffers given to `record` are in the recording state, outside a render pass, and
    ///   not used by another thread meanwhile;
    /// * a frame slot is recorded again, and retired objects are destroyed, only when the commands
    ///   recorded with them are done.
    pub unsafe fn borrow(
        instance: ash::Instance,
        physical_device: vk::PhysicalDevice,
        device: ash::Device,
        queue_family: u32,
    ) -> Self {
        Self {
            instance,
            physical_device,
            device,
            queue_family,
            pipeline_cache: vk::PipelineCache::null(),
            pipeline_flags: vk::PipelineCreateFlags::empty(),
            processor: None,
            debug_utils: None,
            layouts: None,
        }
    }

    /// The limits of the device that plans for a description depend on; an error where it lacks what that needs.
    pub(crate) fn limits_for(&self, description: &Description) -> Result<Limits, Error> {
        let requirements = Requirements::of(self);
        requirements.met()?;
        description.check()?;
        requirements.allow(description)?;
        let bits = requirements.sub_pixel_bits.min(16) as i32;
        let processor = self.processor.unwrap_or(requirements.processor);
        Ok(Limits { subpixel_step: 0.5f32.powi(bits), processor })
    }

    /// Makes an allocator on the host's device, for hosts that have none of their own. The caller must drop it before
    /// the device is destroyed.
    ///
    /// # Errors
    /// [`Error::Memory`] where it cannot be made.
    #[cfg(feature = "gpu-allocator")]
    pub fn new_allocator(&self) -> Result<gpu_allocator::vulkan::Allocator, Error> {
        use gpu_allocator::vulkan::{Allocator, AllocatorCreateDesc};
        Allocator::new(&AllocatorCreateDesc {
            instance: self.instance.clone(),
            device: self.device.clone(),
            physical_device: self.physical_device,
            debug_settings: gpu_allocator::AllocatorDebugSettings::default(),
            buffer_device_address: false,
            allocation_sizes: gpu_allocator::AllocationSizes::default(),
        })
        .map_err(|e| Error::Memory {
            resource: "the allocator".into(),
            bytes: 0,
            problem: e.to_string(),
        })
    }

    /// Makes the node create its pipelines with the host's pipeline cache.
    #[must_use]
    pub fn with_pipeline_cache(mut self, cache: vk::PipelineCache) -> Self {
        self.pipeline_cache = cache;
        self
    }

    /// Makes the node create each pipeline with these flags as well, such as CAPTURE_STATISTICS_KHR of
    /// VK_KHR_pipeline_executable_properties, whose extension and feature the device must then have enabled.
    #[must_use]
    pub fn with_pipeline_flags(mut self, flags: vk::PipelineCreateFlags) -> Self {
        self.pipeline_flags = flags;
        self
    }

    /// Makes the node take the device for a processor, or for a GPU, whatever it says of itself. Some passes have a shader for
    /// either, which write the same; by default the device's type chooses ([`Requirements::processor`]).
    #[must_use]
    pub fn as_processor(mut self, processor: bool) -> Self {
        self.processor = Some(processor);
        self
    }

    /// Makes the node name its objects and label its passes, as `antumbra.<room>.<pass>`.
    #[must_use]
    pub fn with_debug_utils(mut self, debug_utils: ext::debug_utils::Device) -> Self {
        self.debug_utils = Some(debug_utils);
        self
    }

    /// Makes the node share its passes' layouts with other nodes on this device, so that a driver which looks up
    /// compiled pipelines by their layout finds those of an earlier node. Call [`SharedLayouts::destroy`] after all of
    /// these nodes are destroyed and before the device is.
    #[must_use]
    pub fn with_layouts(mut self, layouts: Arc<SharedLayouts>) -> Self {
        self.layouts = Some(layouts);
        self
    }
}

/// What a device lacks for the node, and which of its abilities the node may use.
#[derive(Clone, Debug, PartialEq)]
pub struct Requirements {
    /// The device's name.
    pub device: String,
    /// Everything that the device lacks, as short phrases; empty where the node runs.
    pub gaps: Vec<String>,
    /// Whether R32_SFLOAT can be blended: `accumulate=blend` needs it.
    pub blends_f32: bool,
    /// The largest side of an image in pixels; every device has at least 4096, enough for the largest maps.
    pub image_side: u32,
    /// The number of sub-pixel bits that the rasterizer rounds vertices to.
    pub sub_pixel_bits: u32,
    /// Whether passes can be timed on the queue family.
    pub timestamps: bool,
    /// Whether the device is a processor (`VK_PHYSICAL_DEVICE_TYPE_CPU`).
    pub processor: bool,
}

impl Requirements {
    /// Queries a physical device, before a device is created from it, and lists **everything** that it lacks.
    ///
    /// # Safety
    /// The instance is alive, and the physical device belongs to it.
    pub unsafe fn check(instance: &ash::Instance, physical_device: vk::PhysicalDevice) -> Self {
        Self::look(instance, physical_device, None)
    }

    /// Queries a host's device, including its queue family; see [`Self::check`].
    pub fn of(host: &Host) -> Self {
        Self::look(&host.instance, host.physical_device, Some(host.queue_family))
    }

    fn look(instance: &ash::Instance, physical: vk::PhysicalDevice, family: Option<u32>) -> Self {
        // SAFETY: the promise of `check` or of Host::borrow: the handles belong together.
        let properties = unsafe { instance.get_physical_device_properties(physical) };
        // SAFETY: as above.
        let families = unsafe { instance.get_physical_device_queue_family_properties(physical) };
        let features = |format| {
            // SAFETY: as above.
            unsafe { instance.get_physical_device_format_properties(physical, format) }
                .optimal_tiling_features
        };
        Self::judge(&properties, &families, family, features)
    }

    /// The requirements that follow from a device's properties and features.
    fn judge(
        properties: &vk::PhysicalDeviceProperties,
        families: &[vk::QueueFamilyProperties],
        family: Option<u32>,
        features: impl Fn(vk::Format) -> vk::FormatFeatureFlags,
    ) -> Self {
        let mut gaps = Vec::new();
        if properties.api_version < vk::API_VERSION_1_1 {
            let (major, minor) = (
                vk::api_version_major(properties.api_version),
                vk::api_version_minor(properties.api_version),
            );
            gaps.push(format!("Vulkan {major}.{minor}, where 1.1 is needed"));
        }
        let limits = &properties.limits;
        if limits.max_push_constants_size < PUSH_BYTES as u32 {
            gaps.push(format!(
                "{} bytes of push constants, where {PUSH_BYTES} are needed",
                limits.max_push_constants_size
            ));
        }
        if limits.max_compute_work_group_invocations < INVOCATIONS {
            gaps.push(format!("compute workgroups of fewer than {INVOCATIONS} invocations"));
        }
        let wanted = vk::QueueFlags::GRAPHICS | vk::QueueFlags::COMPUTE;
        let serves = |f: &vk::QueueFamilyProperties| f.queue_flags.contains(wanted);
        let chosen = match family {
            Some(index) => families.get(index as usize).filter(|f| serves(f)),
            None => families.iter().find(|f| serves(f)),
        };
        match (chosen, family) {
            (None, Some(index)) => {
                gaps.push(format!("queue family {index} is not one for both graphics and compute"));
            }
            (None, None) => gaps.push("no queue family for both graphics and compute".into()),
            (Some(_), _) => {}
        }
        use vk::FormatFeatureFlags as F;
        let layer = F::DEPTH_STENCIL_ATTACHMENT | F::SAMPLED_IMAGE;
        if !features(depth_layers::FORMAT).contains(layer) {
            gaps.push("D32_SFLOAT cannot be both drawn to and sampled".into());
        }
        let single = features(visibility::FORMAT);
        if !single.contains(F::STORAGE_IMAGE | F::SAMPLED_IMAGE) {
            gaps.push("R32_SFLOAT cannot be both written by compute shaders and sampled".into());
        }
        Self {
            device: name_of(properties),
            gaps,
            blends_f32: single.contains(F::COLOR_ATTACHMENT_BLEND),
            image_side: limits.max_image_dimension2_d,
            sub_pixel_bits: limits.sub_pixel_precision_bits,
            timestamps: limits.timestamp_period > 0.0
                && chosen.is_some_and(|f| f.timestamp_valid_bits > 0),
            processor: properties.device_type == vk::PhysicalDeviceType::CPU,
        }
    }

    /// Checks that the device lacks nothing.
    ///
    /// # Errors
    /// [`Error::Device`] with everything that it lacks.
    pub fn met(&self) -> Result<(), Error> {
        if self.gaps.is_empty() {
            return Ok(());
        }
        Err(Error::Device { device: self.device.clone(), gaps: self.gaps.clone() })
    }

    /// Checks that the device has what a description needs beyond every node's requirements.
    ///
    /// # Errors
    /// [`Error::Setting`] for settings that the device cannot run; [`Error::Frame`] for a G-buffer larger than its images.
    pub fn allow(&self, description: &Description) -> Result<(), Error> {
        let blends = description.all_techniques().any(|technique| technique.room().blends_f32());
        if blends && !self.blends_f32 {
            return Err(Error::Setting {
                key: "accumulate".into(),
                problem: format!("{} cannot blend R32_SFLOAT; set accumulate=gather", self.device),
            });
        }
        let [width, height] = description.extent;
        if width.max(height) > self.image_side {
            return Err(Error::Frame(format!(
                "a G-buffer of {width}×{height} pixels is more than {} has; its images have up to {} a side",
                self.device, self.image_side
            )));
        }
        Ok(())
    }
}

fn name_of(properties: &vk::PhysicalDeviceProperties) -> String {
    properties
        .device_name_as_c_str()
        .map_or_else(|_| "(unnamed)".into(), |n: &CStr| n.to_string_lossy().into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use vk::{FormatFeatureFlags as F, QueueFlags};

    fn family(queue_flags: QueueFlags) -> vk::QueueFamilyProperties {
        vk::QueueFamilyProperties { queue_flags, timestamp_valid_bits: 64, ..Default::default() }
    }

    /// The limits of a device with no more than Vulkan 1.1 guarantees.
    fn modest() -> vk::PhysicalDeviceProperties {
        let mut properties =
            vk::PhysicalDeviceProperties { api_version: vk::API_VERSION_1_1, ..Default::default() };
        properties.limits.max_push_constants_size = 128;
        properties.limits.max_compute_work_group_invocations = 128;
        properties.limits.max_image_dimension2_d = 4096;
        properties.limits.sub_pixel_precision_bits = 4;
        properties.limits.timestamp_period = 1.0;
        properties
    }

    fn guaranteed(_: vk::Format) -> F {
        F::SAMPLED_IMAGE | F::STORAGE_IMAGE | F::DEPTH_STENCIL_ATTACHMENT | F::COLOR_ATTACHMENT
    }

    #[test]
    fn the_least_device_of_vulkan_1_1_is_enough() {
        let both = family(QueueFlags::GRAPHICS | QueueFlags::COMPUTE);
        let found = Requirements::judge(&modest(), &[both], Some(0), guaranteed);
        found.met().unwrap();
        assert!(!found.blends_f32 && found.timestamps);
        assert_eq!(found.sub_pixel_bits, 4);
    }

    #[test]
    fn what_it_has_not_is_refused_by_name() {
        let both = family(QueueFlags::GRAPHICS | QueueFlags::COMPUTE);
        let found = Requirements::judge(&modest(), &[both], Some(0), guaranteed);
        let mut description = Description::new([4096, 4096]);
        found.allow(&description).unwrap();
        let refuse = |d: &Description| found.allow(d).unwrap_err().to_string();
        description.extent = [1, 4097];
        assert!(refuse(&description).contains("1×4097"), "{}", refuse(&description));
        let blend = "soft-shadow-map receivers=map accumulate=blend".parse().unwrap();
        description.other_techniques.push(blend);
        assert!(refuse(&description).contains("set accumulate=gather"));
    }

    #[test]
    fn every_gap_is_listed_at_once() {
        let mut poor = modest();
        poor.api_version = vk::API_VERSION_1_0;
        poor.limits.max_push_constants_size = 64;
        poor.limits.max_compute_work_group_invocations = 32;
        let transfer = family(QueueFlags::TRANSFER);
        let found = Requirements::judge(&poor, &[transfer], Some(0), |_| F::empty());
        let sentence = found.met().unwrap_err().to_string();
        for gap in
            ["1.0", "64 bytes", "128 invocations", "queue family 0", "D32_SFLOAT", "R32_SFLOAT"]
        {
            assert!(sentence.contains(gap), "{gap}: {sentence}");
        }
        assert_eq!(found.gaps.len(), 6);
        let nowhere = Requirements::judge(&modest(), &[transfer], None, guaranteed);
        assert_eq!(nowhere.gaps, ["no queue family for both graphics and compute"]);
    }
}
