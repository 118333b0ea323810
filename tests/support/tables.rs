//! Vulkan's functions with others between them and their callers: calls that fail when they are told to, and devices
//! that say they have less than they have.
//!
//! What is told holds for the thread that tells it, and so for a test's own device: everything there calls Vulkan on
//! the thread that calls it.

// Functions in Vulkan's place are unsafe, to be called and to call what they stand for.
#![allow(unsafe_code)]

use antumbra_harness::Tables;
use ash::vk;
use std::cell::{Cell, RefCell};

/// Calls that fail when [`fail`] or [`fail_next`] says so.
pub const FAULTY: Tables = Tables { instance: ash::Instance::clone, device: faulty };
/// A device that is as [`pretend`] says; its calls fail as well.
pub const POORER: Tables = Tables { instance: poorer, device: faulty };

thread_local! {
    /// What the functions here stand for.
    static DEVICE: RefCell<Option<ash::Device>> = const { RefCell::new(None) };
    static INSTANCE: RefCell<Option<ash::Instance>> = const { RefCell::new(None) };
    static FAULT: Cell<Option<Fault>> = const { Cell::new(None) };
    static CALLS: Cell<usize> = const { Cell::new(0) };
    static FAILED: Cell<Option<&'static str>> = const { Cell::new(None) };
    static PRETENCE: Cell<Pretence> = const { Cell::new(Pretence::TRUTH) };
}

#[derive(Clone, Copy)]
struct Fault {
    /// The one call that fails, of those of `only`, or of all.
    nth: usize,
    only: Option<&'static str>,
    result: vk::Result,
}

/// Lets the `nth` call from now on fail, counted from 0 among those that can.
pub fn fail(nth: usize, result: vk::Result) {
    begin(Fault { nth, only: None, result });
}

/// Lets the next call of a name fail.
pub fn fail_next(name: &'static str, result: vk::Result) {
    assert!(FALLIBLE.contains(&name), "{name} is not among {FALLIBLE:?}");
    begin(Fault { nth: 0, only: Some(name), result });
}

fn begin(fault: Fault) {
    CALLS.set(0);
    FAILED.set(None);
    FAULT.set(Some(fault));
}

/// Lets calls through again: which one has failed, and how many there were up to the end.
pub fn end() -> (Option<&'static str>, usize) {
    FAULT.set(None);
    (FAILED.take(), CALLS.get())
}

/// Lets every call through for as long as `run` runs.
pub fn without_faults<T>(run: impl FnOnce() -> T) -> T {
    let fault = FAULT.take();
    let done = run();
    FAULT.set(fault);
    done
}

/// What a call answers instead of being made.
fn fault_of(name: &'static str) -> Option<vk::Result> {
    let fault = FAULT.get().filter(|f| f.only.is_none_or(|only| only == name))?;
    let nth = CALLS.replace(CALLS.get() + 1);
    (nth == fault.nth).then(|| {
        FAILED.set(Some(name));
        fault.result
    })
}

/// A function of the real device's.
fn real<T>(of: impl Fn(&ash::DeviceFnV1_0) -> T) -> T {
    DEVICE.with(|device| of(device.borrow().as_ref().expect("made on this thread").fp_v1_0()))
}

fn faulty(device: &ash::Device) -> ash::Device {
    DEVICE.set(Some(device.clone()));
    let mut table = device.fp_v1_0().clone();
    substitute(&mut table);
    let (one, two, three) = (device.fp_v1_1(), device.fp_v1_2(), device.fp_v1_3());
    ash::Device::from_parts_1_3(device.handle(), table, one.clone(), two.clone(), three.clone())
}

/// Declares functions of Vulkan's that may fail; `first` happens where they do.
macro_rules! fallible {
    ($($name:ident($($arg:ident: $kind:ty),*) $(, first $first:expr)?;)*) => {
        $(
            unsafe extern "system" fn $name($($arg: $kind),*) -> vk::Result {
                match fault_of(stringify!($name)) {
                    Some(result) => {
                        $($first;)?
                        result
                    }
                    // SAFETY: passed on as they came.
                    None => unsafe { real(|table| table.$name)($($arg),*) },
                }
            }
        )*

        fn substitute(table: &mut ash::DeviceFnV1_0) {
            $(table.$name = $name;)*
        }

        /// The calls that can fail, by name.
        pub const FALLIBLE: &[&str] = &[$(stringify!($name)),*];
    };
}

type Callbacks<'a> = *const vk::AllocationCallbacks<'a>;

fallible! {
    allocate_memory(device: vk::Device, info: *const vk::MemoryAllocateInfo<'_>, callbacks: Callbacks<'_>, memory: *mut vk::DeviceMemory);
    create_image(device: vk::Device, info: *const vk::ImageCreateInfo<'_>, callbacks: Callbacks<'_>, image: *mut vk::Image);
    bind_image_memory(device: vk::Device, image: vk::Image, memory: vk::DeviceMemory, offset: vk::DeviceSize);
    create_image_view(device: vk::Device, info: *const vk::ImageViewCreateInfo<'_>, callbacks: Callbacks<'_>, view: *mut vk::ImageView);
    create_buffer(device: vk::Device, info: *const vk::BufferCreateInfo<'_>, callbacks: Callbacks<'_>, buffer: *mut vk::Buffer);
    bind_buffer_memory(device: vk::Device, buffer: vk::Buffer, memory: vk::DeviceMemory, offset: vk::DeviceSize);
    create_descriptor_set_layout(device: vk::Device, info: *const vk::DescriptorSetLayoutCreateInfo<'_>, callbacks: Callbacks<'_>, layout: *mut vk::DescriptorSetLayout);
    create_pipeline_layout(device: vk::Device, info: *const vk::PipelineLayoutCreateInfo<'_>, callbacks: Callbacks<'_>, layout: *mut vk::PipelineLayout);
    create_shader_module(device: vk::Device, info: *const vk::ShaderModuleCreateInfo<'_>, callbacks: Callbacks<'_>, module: *mut vk::ShaderModule);
    create_render_pass(device: vk::Device, info: *const vk::RenderPassCreateInfo<'_>, callbacks: Callbacks<'_>, pass: *mut vk::RenderPass);
    create_framebuffer(device: vk::Device, info: *const vk::FramebufferCreateInfo<'_>, callbacks: Callbacks<'_>, framebuffer: *mut vk::Framebuffer);
    create_compute_pipelines(device: vk::Device, cache: vk::PipelineCache, count: u32, infos: *const vk::ComputePipelineCreateInfo<'_>, callbacks: Callbacks<'_>, pipelines: *mut vk::Pipeline),
        // SAFETY: there is room for as many as were asked for.
        first unsafe { pipelines.write_bytes(0, count as usize) };
    create_graphics_pipelines(device: vk::Device, cache: vk::PipelineCache, count: u32, infos: *const vk::GraphicsPipelineCreateInfo<'_>, callbacks: Callbacks<'_>, pipelines: *mut vk::Pipeline),
        // SAFETY: as above.
        first unsafe { pipelines.write_bytes(0, count as usize) };
    create_descriptor_pool(device: vk::Device, info: *const vk::DescriptorPoolCreateInfo<'_>, callbacks: Callbacks<'_>, pool: *mut vk::DescriptorPool);
    allocate_descriptor_sets(device: vk::Device, info: *const vk::DescriptorSetAllocateInfo<'_>, sets: *mut vk::DescriptorSet);
    create_query_pool(device: vk::Device, info: *const vk::QueryPoolCreateInfo<'_>, callbacks: Callbacks<'_>, pool: *mut vk::QueryPool);
    get_query_pool_results(device: vk::Device, pool: vk::QueryPool, first: u32, count: u32, bytes: usize, data: *mut std::ffi::c_void, stride: vk::DeviceSize, flags: vk::QueryResultFlags);
    create_command_pool(device: vk::Device, info: *const vk::CommandPoolCreateInfo<'_>, callbacks: Callbacks<'_>, pool: *mut vk::CommandPool);
    allocate_command_buffers(device: vk::Device, info: *const vk::CommandBufferAllocateInfo<'_>, buffers: *mut vk::CommandBuffer);
    create_fence(device: vk::Device, info: *const vk::FenceCreateInfo<'_>, callbacks: Callbacks<'_>, fence: *mut vk::Fence);
    begin_command_buffer(buffer: vk::CommandBuffer, info: *const vk::CommandBufferBeginInfo<'_>);
    end_command_buffer(buffer: vk::CommandBuffer);
    queue_submit(queue: vk::Queue, count: u32, infos: *const vk::SubmitInfo<'_>, fence: vk::Fence);
    wait_for_fences(device: vk::Device, count: u32, fences: *const vk::Fence, all: vk::Bool32, timeout: u64),
        // The device is not lost in truth: what was submitted must be done before it is destroyed.
        // SAFETY: passed on as they came.
        first _ = unsafe { real(|table| table.wait_for_fences)(device, count, fences, all, timeout) };
}

/// How a device is poorer than it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pretence {
    /// R32_SFLOAT is not blended.
    pub no_blending: bool,
    /// Every limit is the least that Vulkan 1.1 allows, there are no features and no timestamps.
    pub least: bool,
    /// Sub-pixel bits; its own where there are none.
    pub sub_pixel_bits: Option<u32>,
}

impl Pretence {
    /// As it is.
    pub const TRUTH: Self = Self { no_blending: false, least: false, sub_pixel_bits: None };
}

/// What devices of [`POORER`] say from now on.
pub fn pretend(pretence: Pretence) {
    PRETENCE.set(pretence);
}

fn poorer(instance: &ash::Instance) -> ash::Instance {
    INSTANCE.set(Some(instance.clone()));
    let mut table = instance.fp_v1_0().clone();
    table.get_physical_device_properties = properties;
    table.get_physical_device_features = features;
    table.get_physical_device_format_properties = format_properties;
    table.get_physical_device_queue_family_properties = queue_families;
    let (one, three) = (instance.fp_v1_1().clone(), instance.fp_v1_3().clone());
    ash::Instance::from_parts_1_3(instance.handle(), table, one, three)
}

/// A function of the real instance's.
fn told<T>(of: impl Fn(&ash::InstanceFnV1_0) -> T) -> T {
    INSTANCE.with(|instance| of(instance.borrow().as_ref().expect("made on this thread").fp_v1_0()))
}

unsafe extern "system" fn properties(
    device: vk::PhysicalDevice,
    properties: *mut vk::PhysicalDeviceProperties,
) {
    // SAFETY: passed on as they came.
    unsafe { told(|table| table.get_physical_device_properties)(device, properties) };
    // SAFETY: it was just filled.
    let properties = unsafe { &mut *properties };
    let Pretence { least, sub_pixel_bits, .. } = PRETENCE.get();
    if least {
        properties.api_version = vk::API_VERSION_1_1;
        properties.limits = least_of(&properties.limits);
    }
    if let Some(bits) = sub_pixel_bits {
        properties.limits.sub_pixel_precision_bits = bits;
    }
}

unsafe extern "system" fn features(
    device: vk::PhysicalDevice,
    features: *mut vk::PhysicalDeviceFeatures,
) {
    // SAFETY: passed on as they came.
    unsafe { told(|table| table.get_physical_device_features)(device, features) };
    if PRETENCE.get().least {
        // SAFETY: it was just filled.
        unsafe { *features = vk::PhysicalDeviceFeatures::default() };
    }
}

unsafe extern "system" fn format_properties(
    device: vk::PhysicalDevice,
    format: vk::Format,
    properties: *mut vk::FormatProperties,
) {
    // SAFETY: passed on as they came.
    unsafe {
        told(|table| table.get_physical_device_format_properties)(device, format, properties);
    };
    let Pretence { no_blending, least, .. } = PRETENCE.get();
    // No device need blend 32-bit floats.
    if (no_blending || least) && format == vk::Format::R32_SFLOAT {
        // SAFETY: it was just filled.
        let optimal = unsafe { &mut (*properties).optimal_tiling_features };
        *optimal &= !vk::FormatFeatureFlags::COLOR_ATTACHMENT_BLEND;
    }
}

unsafe extern "system" fn queue_families(
    device: vk::PhysicalDevice,
    count: *mut u32,
    families: *mut vk::QueueFamilyProperties,
) {
    // SAFETY: passed on as they came.
    unsafe {
        told(|table| table.get_physical_device_queue_family_properties)(device, count, families);
    };
    if PRETENCE.get().least && !families.is_null() {
        // SAFETY: as many as it says were just filled.
        let families = unsafe { std::slice::from_raw_parts_mut(families, *count as usize) };
        families.iter_mut().for_each(|family| family.timestamp_valid_bits = 0);
    }
}

/// The least that Vulkan 1.1 allows, of what a program of its kind may look at ("Required Limits", the table behind
/// VkPhysicalDeviceLimits).
fn least_of(own: &vk::PhysicalDeviceLimits) -> vk::PhysicalDeviceLimits {
    vk::PhysicalDeviceLimits {
        max_image_dimension1_d: 4096,
        max_image_dimension2_d: 4096,
        max_image_dimension3_d: 256,
        max_image_array_layers: 256,
        max_uniform_buffer_range: 16_384,
        max_storage_buffer_range: 1 << 27,
        max_push_constants_size: 128,
        max_memory_allocation_count: 4096,
        max_bound_descriptor_sets: 4,
        max_per_stage_descriptor_samplers: 16,
        max_per_stage_descriptor_uniform_buffers: 12,
        max_per_stage_descriptor_storage_buffers: 4,
        max_per_stage_descriptor_sampled_images: 16,
        max_per_stage_descriptor_storage_images: 4,
        max_per_stage_resources: 128,
        max_compute_shared_memory_size: 16_384,
        max_compute_work_group_count: [65_535; 3],
        max_compute_work_group_invocations: 128,
        max_compute_work_group_size: [128, 128, 64],
        sub_pixel_precision_bits: 4,
        max_draw_indirect_count: 1,
        max_viewport_dimensions: [4096; 2],
        min_storage_buffer_offset_alignment: 256,
        max_framebuffer_width: 4096,
        max_framebuffer_height: 4096,
        max_framebuffer_layers: 256,
        max_color_attachments: 4,
        timestamp_compute_and_graphics: vk::FALSE,
        timestamp_period: 0.0,
        // What a program must keep to is as the driver has it.
        ..*own
    }
}
