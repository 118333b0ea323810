//! The engine's device: vk-graph's, chosen by name.

use crate::Outcome;
use ash::vk;
use vk_graph::driver::device::Device;
use vk_graph::driver::instance::{Instance, InstanceInfo};
use vk_graph::driver::physical_device::PhysicalDevice;

/// A device and the queue that frames are submitted to.
pub struct Gpu {
    pub device: Device,
    /// The first family for both graphics and compute; its first queue is the engine's.
    pub queue_family: u32,
}

impl Gpu {
    /// Opens the device whose name holds `$ANTUMBRA_DRIVER`, or the fastest kind there is.
    ///
    /// vk-graph turns on what it wants of the device. The node wants nothing beyond.
    pub fn open() -> Outcome<Self> {
        let instance = Instance::create(InstanceInfo::default())
            .map_err(|e| format!("there is no Vulkan 1.3 loader and driver ({e})"))?;
        let wanted = std::env::var("ANTUMBRA_DRIVER").unwrap_or_default().to_lowercase();
        let mut names = Vec::new();
        let mut best: Option<(u32, PhysicalDevice, u32)> = None;
        // Listed here are those that offer Vulkan 1.3, which vk-graph requires.
        for found in Instance::physical_devices(&instance)? {
            let name = found.properties_v1_0.device_name.clone();
            let both = vk::QueueFlags::GRAPHICS | vk::QueueFlags::COMPUTE;
            let family = found.queue_families.iter().position(|f| f.queue_flags.contains(both));
            let called_so = name.to_lowercase().contains(&wanted);
            names.push(name);
            let Some(family) = family.filter(|_| called_so) else { continue };
            let rank = match found.properties_v1_0.device_type {
                vk::PhysicalDeviceType::DISCRETE_GPU => 0,
                vk::PhysicalDeviceType::INTEGRATED_GPU => 1,
                vk::PhysicalDeviceType::VIRTUAL_GPU => 2,
                _ => 3,
            };
            if best.as_ref().is_none_or(|&(least, ..)| rank < least) {
                best = Some((rank, found, family as u32));
            }
        }
        let (_, physical, queue_family) = best.ok_or_else(|| {
            format!("no Vulkan 1.3 device's name holds \"{wanted}\"; there are {names:?}")
        })?;
        let device = Device::try_from_physical_device(physical)
            .map_err(|e| format!("vk-graph does not get its device ({e})"))?;
        Ok(Self { device, queue_family })
    }

    /// The device's name.
    pub fn name(&self) -> &str {
        &self.device.physical.properties_v1_0.device_name
    }
}
