//! A device of RADV's without hardware, on which pipelines can be compiled and nothing else be done: images, command buffers
//! and waits crash it.

use antumbra::{Error, Host};
use ash::{Entry, khr, vk};
use std::ffi::CStr;

const STATISTICS: &CStr = khr::pipeline_executable_properties::NAME;

/// What the driver tells about a shader: its name, and figures by their names.
pub type Told = (String, Vec<(String, u64)>);

/// A device that tells what it made of each pipeline.
pub struct NullDevice {
    /// The device.
    pub raw: ash::Device,
    /// The host that lends it; its pipelines keep their statistics.
    pub host: Host,
    /// The statistics of pipelines.
    pub statistics: khr::pipeline_executable_properties::Device,
    /// The driver's name and version.
    pub driver: String,
    _entry: Entry,
}

impl NullDevice {
    /// Opens the one device that the environment leaves the loader. It is never destroyed: the process ends after it.
    ///
    /// # Errors
    /// A sentence where there is no loader or no device, or where the device tells nothing about its pipelines.
    pub fn open() -> Result<Self, String> {
        let vulkan = |doing: &'static str| move |e: vk::Result| format!("{doing}: {e}");
        // SAFETY: the loader is kept as long as what comes from it.
        let entry = unsafe { Entry::load() }.map_err(|e| format!("no Vulkan loader: {e}"))?;
        let application = vk::ApplicationInfo::default().api_version(vk::API_VERSION_1_1);
        let create = vk::InstanceCreateInfo::default().application_info(&application);
        // SAFETY: the create info lives until the end of the call.
        let instance = unsafe { entry.create_instance(&create, None) }
            .map_err(vulkan("creating the instance"))?;
        // SAFETY: the instance is alive, here and below.
        let devices = unsafe { instance.enumerate_physical_devices() }
            .map_err(vulkan("listing the devices"))?;
        let &[physical] = devices.as_slice() else {
            return Err(format!("{} devices where there should be one", devices.len()));
        };
        // SAFETY: as above.
        let extensions = unsafe { instance.enumerate_device_extension_properties(physical) }
            .map_err(vulkan("listing the device's extensions"))?;
        if !extensions.iter().any(|e| e.extension_name_as_c_str() == Ok(STATISTICS)) {
            return Err("the device has no VK_KHR_pipeline_executable_properties".into());
        }
        let mut driver = vk::PhysicalDeviceDriverProperties::default();
        let mut properties = vk::PhysicalDeviceProperties2::default().push_next(&mut driver);
        // SAFETY: as above; a device of Vulkan 1.2 has the driver's properties, and others leave them empty.
        unsafe { instance.get_physical_device_properties2(physical, &mut properties) };
        let driver = format!(
            "{}, {}",
            text(driver.driver_name_as_c_str()),
            text(driver.driver_info_as_c_str())
        );
        let queues =
            [vk::DeviceQueueCreateInfo::default().queue_family_index(0).queue_priorities(&[1.0])];
        let names = [STATISTICS.as_ptr()];
        let mut told = vk::PhysicalDevicePipelineExecutablePropertiesFeaturesKHR::default()
            .pipeline_executable_info(true);
        let create = vk::DeviceCreateInfo::default()
            .queue_create_infos(&queues)
            .enabled_extension_names(&names)
            .push_next(&mut told);
        // SAFETY: the extension is there, and everything that the create info points to lives until the end of the call.
        let device = unsafe { instance.create_device(physical, &create, None) }
            .map_err(vulkan("creating the device"))?;
        let statistics = khr::pipeline_executable_properties::Device::new(&instance, &device);
        // SAFETY: the handles belong together and live until the process ends.
        let host = unsafe { Host::borrow(instance, physical, device.clone(), 0) }
            .with_pipeline_flags(vk::PipelineCreateFlags::CAPTURE_STATISTICS_KHR);
        Ok(Self { raw: device, host, statistics, driver, _entry: entry })
    }

    /// What the driver tells about each of a pipeline's shaders.
    ///
    /// # Errors
    /// What the driver returns, and the pipelines' own: see [`antumbra::gpu::Pipelines::new`].
    pub fn told(&self, pipeline: vk::Pipeline) -> Result<Vec<Told>, Error> {
        let doing = || Error::vulkan("asking for a pipeline's statistics");
        let info = vk::PipelineInfoKHR::default().pipeline(pipeline);
        // SAFETY: the pipeline is alive and was made to keep its statistics, here and below.
        let shaders = unsafe { self.statistics.get_pipeline_executable_properties(&info) };
        let shaders = shaders.map_err(doing())?;
        let of = |(index, shader): (u32, vk::PipelineExecutablePropertiesKHR)| {
            let info =
                vk::PipelineExecutableInfoKHR::default().pipeline(pipeline).executable_index(index);
            // SAFETY: as above; there are as many shaders as were listed.
            let figures = unsafe { self.statistics.get_pipeline_executable_statistics(&info) };
            let figures = figures.map_err(doing())?.into_iter().map(|f| {
                use vk::PipelineExecutableStatisticFormatKHR as Format;
                // SAFETY: the format says which of the union's members was written.
                let value = unsafe {
                    match f.format {
                        Format::BOOL32 => u64::from(f.value.b32),
                        Format::INT64 => f.value.i64.max(0) as u64,
                        Format::UINT64 => f.value.u64,
                        _ => f.value.f64 as u64,
                    }
                };
                (text(f.name_as_c_str()), value)
            });
            Ok((text(shader.name_as_c_str()), figures.collect()))
        };
        (0..).zip(shaders).map(of).collect()
    }
}

fn text<E>(name: Result<&CStr, E>) -> String {
    name.map_or_else(|_| String::new(), |name| name.to_string_lossy().into_owned())
}
