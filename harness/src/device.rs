//! The device, its one queue and its allocator.

use crate::choose::{Candidate, choose};
use crate::instance::Instance;
use crate::messages::MessageLog;
use antumbra::gpu::SharedLayouts;
use antumbra::{Error, Host};
use ash::{ext, vk};
use gpu_allocator::vulkan::{Allocator, AllocatorCreateDesc};
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

/// The environment variable that picks a device by a part of its name.
const DRIVER_VARIABLE: &str = "ANTUMBRA_DRIVER";

/// The options of a [`HeadlessDevice`].
#[derive(Clone, Debug, Default)]
pub struct HeadlessOptions {
    /// Whether to run under the Khronos validation layer with synchronization checks; off by default.
    pub validation: bool,
    /// A part of the wanted device's name, in any case. `None` leaves it to the environment
    /// variable `ANTUMBRA_DRIVER`, and without that to the kind: discrete GPU, integrated GPU,
    /// virtual GPU, processor.
    pub driver: Option<String>,
    /// Whether to enable pipeline statistics where the device has them, for [`HeadlessDevice::count`]; off by default.
    pub statistics: bool,
    /// Whether nodes take the device for a processor ([`Host::as_processor`]); `None`, the default, leaves it to the
    /// device's type.
    pub processor: Option<bool>,
    /// Other tables of Vulkan functions to call through; none by default.
    pub tables: Option<Tables>,
}

/// Replacements for Vulkan's functions, for tests: a device on which calls fail, or that reports fewer abilities than
/// it has.
///
/// Each function gets the table that Vulkan loaded and returns the table that is called instead, for the same objects.
#[derive(Clone, Copy, Debug)]
pub struct Tables {
    /// Replaces the instance's functions, and so the queries of the physical device.
    pub instance: fn(&ash::Instance) -> ash::Instance,
    /// Replaces the functions of the device, its queue and its command buffers.
    pub device: fn(&ash::Device) -> ash::Device,
}

/// A device of Vulkan 1.1 with one graphics and compute queue, no device extension and no optional feature
/// but the one that [`HeadlessOptions::statistics`] enables.
///
/// A clone is another handle to the same device; the last one destroys it. Buffers and images made
/// from it hold a handle each, so they may be dropped in any order. Objects made through
/// [`Self::device`] must be destroyed before the last handle is dropped.
#[derive(Clone)]
pub struct HeadlessDevice(Arc<Shared>);

/// Fields drop from the top: the allocator's memory, then the device, then the instance.
struct Shared {
    allocator: Mutex<Allocator>,
    device: Device,
    physical_device: vk::PhysicalDevice,
    properties: vk::PhysicalDeviceProperties,
    processor: Option<bool>,
    statistics: bool,
    name: String,
    queue: vk::Queue,
    queue_family: u32,
    /// Held while the queue is used, which Vulkan wants from one thread at a time.
    queue_lock: Mutex<()>,
    debug_utils: Option<ext::debug_utils::Device>,
    instance: Instance,
}

impl Drop for Shared {
    fn drop(&mut self) {
        // SAFETY: the device lives. A lost device leaves nothing to wait for, so the answer is of
        // no use.
        let _ = unsafe { self.device.0.device_wait_idle() };
    }
}

/// Destroys the device where its fields' order says so. The cache makes a node's pipelines cheap where an
/// earlier one had the same, with the same layouts.
struct Device(ash::Device, vk::PipelineCache, Arc<SharedLayouts>);

impl Drop for Device {
    fn drop(&mut self) {
        // SAFETY: made by this device; no pipeline is being made any more.
        unsafe { self.0.destroy_pipeline_cache(self.1, None) };
        // SAFETY: as above; the nodes are gone by contract, as is all that was made on the device.
        unsafe { self.2.destroy(&self.0) };
        // SAFETY: idle (`Shared` waits first), and all that came from it is gone by contract.
        unsafe { self.0.destroy_device(None) };
    }
}

impl fmt::Debug for HeadlessDevice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("HeadlessDevice").field(&self.name()).finish()
    }
}

impl HeadlessDevice {
    /// Opens a device.
    ///
    /// # Errors
    /// [`Error::NoDevice`] if the loader, every driver, the validation layer or a device of that
    /// name is missing, with what to install or which devices there are; [`Error::Device`] if the
    /// device lacks Vulkan 1.1 or the queue; [`Error::Vulkan`] and [`Error::Memory`] if the driver
    /// refuses.
    pub fn new(options: &HeadlessOptions) -> Result<Self, Error> {
        let mut instance = Instance::new(options.validation)?;
        if let Some(tables) = options.tables {
            instance.raw = (tables.instance)(&instance.raw);
        }
        // SAFETY: the instance lives.
        let physical_devices = unsafe { instance.raw.enumerate_physical_devices() }
            .map_err(Error::vulkan("listing the devices"))?;
        let candidates: Vec<_> =
            physical_devices.iter().map(|&device| describe(&instance.raw, device)).collect();
        let wanted = options
            .driver
            .clone()
            .or_else(|| std::env::var(DRIVER_VARIABLE).ok())
            .filter(|name| !name.is_empty());
        let (index, queue_family) = choose(&candidates, wanted.as_deref())?;
        let physical_device = physical_devices[index];
        let name = candidates[index].name.clone();

        let queue_info = [vk::DeviceQueueCreateInfo::default()
            .queue_family_index(queue_family)
            .queue_priorities(&[1.0])];
        // SAFETY: reported by this instance.
        let has = unsafe { instance.raw.get_physical_device_features(physical_device) };
        let statistics = options.statistics && has.pipeline_statistics_query == vk::TRUE;
        let features = vk::PhysicalDeviceFeatures::default().pipeline_statistics_query(statistics);
        let info = vk::DeviceCreateInfo::default()
            .queue_create_infos(&queue_info)
            .enabled_features(&features);
        // SAFETY: the family was reported by this device, and so was the one feature that `info` may name.
        let device = unsafe { instance.raw.create_device(physical_device, &info, None) }
            .map_err(Error::vulkan(format!("creating the device {name}")))?;
        let device = options.tables.map_or(device.clone(), |tables| (tables.device)(&device));
        let mut device = Device(device, vk::PipelineCache::null(), Arc::default());
        let empty = vk::PipelineCacheCreateInfo::default();
        // SAFETY: the device was just made. `Device` destroys the cache, a null one too.
        device.1 = unsafe { device.0.create_pipeline_cache(&empty, None) }
            .map_err(Error::vulkan("creating the pipeline cache"))?;
        // SAFETY: one queue of this family was requested above.
        let queue = unsafe { device.0.get_device_queue(queue_family, 0) };
        let debug_utils =
            instance.debug_utils.then(|| ext::debug_utils::Device::new(&instance.raw, &device.0));
        let allocator = Allocator::new(&AllocatorCreateDesc {
            instance: instance.raw.clone(),
            device: device.0.clone(),
            physical_device,
            debug_settings: gpu_allocator::AllocatorDebugSettings::default(),
            buffer_device_address: false,
            allocation_sizes: gpu_allocator::AllocationSizes::default(),
        })
        .map_err(|problem| Error::Memory {
            resource: "the allocator".into(),
            bytes: 0,
            problem: problem.to_string(),
        })?;
        // SAFETY: reported by this instance.
        let properties = unsafe { instance.raw.get_physical_device_properties(physical_device) };
        Ok(Self(Arc::new(Shared {
            allocator: Mutex::new(allocator),
            device,
            physical_device,
            properties,
            statistics,
            processor: options.processor,
            name,
            queue,
            queue_family,
            queue_lock: Mutex::new(()),
            debug_utils,
            instance,
        })))
    }

    /// The loader.
    pub fn entry(&self) -> &ash::Entry {
        &self.0.instance.entry
    }

    /// The instance.
    pub fn instance(&self) -> &ash::Instance {
        &self.0.instance.raw
    }

    /// The physical device.
    pub fn physical_device(&self) -> vk::PhysicalDevice {
        self.0.physical_device
    }

    /// The device. A clone of it must not be used once the last [`HeadlessDevice`] is dropped.
    pub fn device(&self) -> &ash::Device {
        &self.0.device.0
    }

    /// The one queue, for graphics and compute. [`Self::submit_and_wait`] submits to it under a
    /// lock; whoever submits by other means must not do so from another thread at the same time.
    pub fn queue(&self) -> vk::Queue {
        self.0.queue
    }

    /// The queue's family.
    pub fn queue_family(&self) -> u32 {
        self.0.queue_family
    }

    /// A cache of the device's pipelines, for [`antumbra::Host::with_pipeline_cache`].
    pub fn pipeline_cache(&self) -> vk::PipelineCache {
        self.0.device.1
    }

    /// The host that lends this device to a node, with its pipeline cache, layouts that its nodes share, and names and
    /// labels where the instance supports them.
    ///
    /// # Safety
    /// The promises of [`Host::borrow`]; the first of them holds while a handle to the device lives.
    pub unsafe fn host(&self) -> Host {
        let Shared { instance, physical_device, device, queue_family, .. } = &*self.0;
        // SAFETY: the handles belong together; the rest is the caller's promise.
        let mut host = unsafe {
            Host::borrow(instance.raw.clone(), *physical_device, device.0.clone(), *queue_family)
        };
        host = host.with_pipeline_cache(device.1).with_layouts(Arc::clone(&device.2));
        if let Some(processor) = self.0.processor {
            host = host.as_processor(processor);
        }
        match self.debug_utils() {
            Some(debug_utils) => host.with_debug_utils(debug_utils.clone()),
            None => host,
        }
    }

    /// Names and labels, where the instance has `VK_EXT_debug_utils`.
    pub fn debug_utils(&self) -> Option<&ext::debug_utils::Device> {
        self.0.debug_utils.as_ref()
    }

    /// The device's name as the driver gives it.
    pub fn name(&self) -> &str {
        &self.0.name
    }

    /// Whether pipeline statistics were requested and are supported.
    pub(crate) fn has_statistics(&self) -> bool {
        self.0.statistics
    }

    /// The device's properties.
    pub fn properties(&self) -> &vk::PhysicalDeviceProperties {
        &self.0.properties
    }

    /// The device's limits.
    pub fn limits(&self) -> &vk::PhysicalDeviceLimits {
        &self.0.properties.limits
    }

    /// The allocator that buffers and images here come from; others may borrow it.
    pub fn allocator(&self) -> &Mutex<Allocator> {
        &self.0.allocator
    }

    /// Warnings and errors so far, oldest first (see [`MessageLog`]); none without validation.
    pub fn messages(&self) -> Vec<String> {
        self.0.instance.log.messages()
    }

    /// The messages so far, which are removed from the log; see [`Self::messages`].
    pub fn take_messages(&self) -> Vec<String> {
        self.0.instance.log.take()
    }

    /// The log itself, which outlives the device: what is said while the device is destroyed ends
    /// up there too.
    pub fn message_log(&self) -> MessageLog {
        self.0.instance.log.clone()
    }

    /// Submits command buffers, one thread at a time.
    pub(crate) fn submit_to_queue(
        &self,
        cmds: &[vk::CommandBuffer],
        fence: vk::Fence,
    ) -> Result<(), Error> {
        let submit = [vk::SubmitInfo::default().command_buffers(cmds)];
        let _held = self.0.queue_lock.lock().unwrap_or_else(PoisonError::into_inner);
        // SAFETY: the lock keeps other threads off the queue; command buffers and fence are the caller's, recorded
        // and new.
        unsafe { self.device().queue_submit(self.0.queue, &submit, fence) }
            .map_err(Error::vulkan("submitting a command buffer"))
    }
}

fn describe(instance: &ash::Instance, device: vk::PhysicalDevice) -> Candidate {
    // SAFETY: the device was reported by this instance.
    let properties = unsafe { instance.get_physical_device_properties(device) };
    // SAFETY: as above.
    let families = unsafe { instance.get_physical_device_queue_family_properties(device) };
    let wanted = vk::QueueFlags::GRAPHICS | vk::QueueFlags::COMPUTE;
    let name = properties.device_name_as_c_str().unwrap_or(c"a device without a name");
    Candidate {
        name: name.to_string_lossy().into_owned(),
        kind: properties.device_type,
        api_version: properties.api_version,
        queue_family: (0u32..)
            .zip(&families)
            .find(|(_, family)| family.queue_flags.contains(wanted))
            .map(|(index, _)| index),
    }
}
