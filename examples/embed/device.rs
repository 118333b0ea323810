//! The engine's device: Vulkan 1.1, one queue, one allocator, no extension of the device.

use crate::Outcome;
use antumbra::frame::ImageBarrier;
use antumbra::gpu::SharedLayouts;
use ash::{Entry, ext, vk};
use gpu_allocator::vulkan::{Allocator, AllocatorCreateDesc};
use std::ffi::{CStr, c_void};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

const VALIDATION_LAYER: &CStr = c"VK_LAYER_KHRONOS_validation";

/// The number of warnings and errors that the validation layer has reported.
static MESSAGES: AtomicUsize = AtomicUsize::new(0);

/// The number of warnings and errors that the validation layer has reported so far.
pub fn messages() -> usize {
    MESSAGES.load(Ordering::Relaxed)
}

/// Everything that the rest of the engine calls Vulkan with.
pub struct Gpu {
    pub instance: ash::Instance,
    pub physical_device: vk::PhysicalDevice,
    pub name: String,
    pub device: ash::Device,
    pub queue: vk::Queue,
    pub queue_family: u32,
    /// The engine's pipelines and the node's.
    pub pipeline_cache: vk::PipelineCache,
    /// What nodes share, so that the cache serves each of them.
    pub layouts: Arc<SharedLayouts>,
    pub debug_utils: Option<ext::debug_utils::Device>,
    pub allocator: Allocator,
    messenger: Option<(ext::debug_utils::Instance, vk::DebugUtilsMessengerEXT)>,
    /// The loader: unloaded last.
    _entry: Entry,
}

impl Gpu {
    /// Opens the device whose name holds `$ANTUMBRA_DRIVER`, or the fastest kind there is.
    pub fn new(validate: bool) -> Outcome<Self> {
        // SAFETY: the loader is kept in `Gpu`, as long as everything that comes from it.
        let entry = unsafe { Entry::load() }?;
        let instance = create_instance(&entry, validate)?;
        let messenger = if validate { Some(create_messenger(&entry, &instance)?) } else { None };

        let (physical_device, name, queue_family) = choose(&instance)?;
        let priorities = [1.0];
        let queues = [vk::DeviceQueueCreateInfo::default()
            .queue_family_index(queue_family)
            .queue_priorities(&priorities)];
        let create = vk::DeviceCreateInfo::default().queue_create_infos(&queues);
        // SAFETY: the device and the family were listed by this instance.
        let device = unsafe { instance.create_device(physical_device, &create, None) }?;
        // SAFETY: one queue of this family was requested above.
        let queue = unsafe { device.get_device_queue(queue_family, 0) };
        let create = vk::PipelineCacheCreateInfo::default();
        // SAFETY: the device lives. (An engine would start from the bytes of its last run.)
        let pipeline_cache = unsafe { device.create_pipeline_cache(&create, None) }?;
        let debug_utils = validate.then(|| ext::debug_utils::Device::new(&instance, &device));
        let allocator = Allocator::new(&AllocatorCreateDesc {
            instance: instance.clone(),
            device: device.clone(),
            physical_device,
            debug_settings: gpu_allocator::AllocatorDebugSettings::default(),
            buffer_device_address: false,
            allocation_sizes: gpu_allocator::AllocationSizes::default(),
        })?;
        Ok(Self {
            instance,
            physical_device,
            name,
            device,
            queue,
            queue_family,
            pipeline_cache,
            layouts: Arc::default(),
            debug_utils,
            allocator,
            messenger,
            _entry: entry,
        })
    }

    /// A shader module from the bytes of a .spv file.
    pub fn shader(&self, spirv: &[u8]) -> Outcome<vk::ShaderModule> {
        let words = ash::util::read_spv(&mut std::io::Cursor::new(spirv))?;
        let create = vk::ShaderModuleCreateInfo::default().code(&words);
        // SAFETY: the words are SPIR-V that a compiler made.
        Ok(unsafe { self.device.create_shader_module(&create, None) }?)
    }

    /// Records a barrier of a plan.
    pub fn place(&self, cmd: vk::CommandBuffer, barrier: &ImageBarrier) {
        let (before, after) = (barrier.before.stage, barrier.after.stage);
        let none = vk::DependencyFlags::empty();
        let barrier = [barrier.vk()];
        // SAFETY: `cmd` is recording outside a render pass; the image is in the layout that the frame
        // names.
        unsafe {
            self.device.cmd_pipeline_barrier(cmd, before, after, none, &[], &[], &barrier);
        }
    }

    /// Destroys the device, from which everything must be gone, and says how many bytes of its memory
    /// nobody gave back.
    pub fn destroy(self) -> u64 {
        let lost = self.allocator.generate_report().total_allocated_bytes;
        // The allocator gives its memory back first.
        drop(self.allocator);
        // SAFETY: the caller waited for the device and destroyed everything made from it.
        unsafe {
            self.layouts.destroy(&self.device);
            self.device.destroy_pipeline_cache(self.pipeline_cache, None);
            self.device.destroy_device(None);
            if let Some((loader, messenger)) = &self.messenger {
                loader.destroy_debug_utils_messenger(*messenger, None);
            }
            self.instance.destroy_instance(None);
        }
        lost
    }
}

fn create_instance(entry: &Entry, validate: bool) -> Outcome<ash::Instance> {
    let application =
        vk::ApplicationInfo::default().application_name(c"embed").api_version(vk::API_VERSION_1_1);
    let mut layers = Vec::new();
    let mut extensions = Vec::new();
    if validate {
        layers.push(VALIDATION_LAYER.as_ptr());
        extensions.push(ext::debug_utils::NAME.as_ptr());
        extensions.push(ext::validation_features::NAME.as_ptr());
    }
    let enabled = [vk::ValidationFeatureEnableEXT::SYNCHRONIZATION_VALIDATION];
    let mut features = vk::ValidationFeaturesEXT::default().enabled_validation_features(&enabled);
    let mut messenger = messenger_info();
    let mut create = vk::InstanceCreateInfo::default()
        .application_info(&application)
        .enabled_layer_names(&layers)
        .enabled_extension_names(&extensions);
    if validate {
        create = create.push_next(&mut features).push_next(&mut messenger);
    }
    // SAFETY: everything that `create` points to lives until the end of this call.
    unsafe { entry.create_instance(&create, None) }.map_err(|e| match e {
        vk::Result::ERROR_LAYER_NOT_PRESENT => {
            "--validate: the layer VK_LAYER_KHRONOS_validation is not installed \
             (Debian: vulkan-validationlayers)"
                .into()
        }
        e => format!("creating the Vulkan instance: {e}").into(),
    })
}

fn create_messenger(
    entry: &Entry,
    instance: &ash::Instance,
) -> Outcome<(ext::debug_utils::Instance, vk::DebugUtilsMessengerEXT)> {
    let loader = ext::debug_utils::Instance::new(entry, instance);
    // SAFETY: the extension is on, and the callback uses nothing but a static.
    let messenger = unsafe { loader.create_debug_utils_messenger(&messenger_info(), None) }?;
    Ok((loader, messenger))
}

fn messenger_info() -> vk::DebugUtilsMessengerCreateInfoEXT<'static> {
    use vk::DebugUtilsMessageSeverityFlagsEXT as Severity;
    use vk::DebugUtilsMessageTypeFlagsEXT as Type;
    vk::DebugUtilsMessengerCreateInfoEXT::default()
        .message_severity(Severity::WARNING | Severity::ERROR)
        .message_type(Type::VALIDATION | Type::PERFORMANCE)
        .pfn_user_callback(Some(on_message))
}

unsafe extern "system" fn on_message(
    _severity: vk::DebugUtilsMessageSeverityFlagsEXT,
    _types: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    _user: *mut c_void,
) -> vk::Bool32 {
    // SAFETY: Vulkan hands a valid structure whose strings live as long as this call.
    let text = unsafe { (*data).message_as_c_str() };
    eprintln!("{}", text.unwrap_or_default().to_string_lossy());
    MESSAGES.fetch_add(1, Ordering::Relaxed);
    vk::FALSE
}

/// The device, its name, and its first family for both graphics and compute.
fn choose(instance: &ash::Instance) -> Outcome<(vk::PhysicalDevice, String, u32)> {
    let wanted = std::env::var("ANTUMBRA_DRIVER").unwrap_or_default().to_lowercase();
    let mut names = Vec::new();
    let mut best: Option<(u32, vk::PhysicalDevice, String, u32)> = None;
    // SAFETY: the instance lives.
    for physical_device in unsafe { instance.enumerate_physical_devices() }? {
        // SAFETY: listed by this instance.
        let (properties, families) = unsafe {
            (
                instance.get_physical_device_properties(physical_device),
                instance.get_physical_device_queue_family_properties(physical_device),
            )
        };
        let name = properties.device_name_as_c_str().unwrap_or_default().to_string_lossy();
        names.push(name.clone().into_owned());
        let both = vk::QueueFlags::GRAPHICS | vk::QueueFlags::COMPUTE;
        let family = families.iter().position(|f| f.queue_flags.contains(both));
        let Some(family) = family.filter(|_| name.to_lowercase().contains(&wanted)) else {
            continue;
        };
        let rank = match properties.device_type {
            vk::PhysicalDeviceType::DISCRETE_GPU => 0,
            vk::PhysicalDeviceType::INTEGRATED_GPU => 1,
            vk::PhysicalDeviceType::VIRTUAL_GPU => 2,
            _ => 3,
        };
        if best.as_ref().is_none_or(|&(least, ..)| rank < least) {
            best = Some((rank, physical_device, name.into_owned(), family as u32));
        }
    }
    let (_, physical_device, name, family) =
        best.ok_or_else(|| format!("no device's name holds \"{wanted}\"; there are {names:?}"))?;
    Ok((physical_device, name, family))
}
