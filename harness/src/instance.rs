//! The Vulkan instance: loader, validation layer, debug messenger.

use crate::messages::MessageLog;
use antumbra::Error;
use ash::{ext, vk};
use std::ffi::CStr;

const VALIDATION_LAYER: &CStr = c"VK_LAYER_KHRONOS_validation";

/// An instance and its messenger, destroyed together.
pub(crate) struct Instance {
    pub entry: ash::Entry,
    pub raw: ash::Instance,
    /// Whether `VK_EXT_debug_utils` is on.
    pub debug_utils: bool,
    messenger: Option<(ext::debug_utils::Instance, vk::DebugUtilsMessengerEXT)>,
    pub log: MessageLog,
}

impl Instance {
    /// Loads the loader and creates an instance of Vulkan 1.1; with `validation`, under the Khronos
    /// layer with its synchronization checks.
    pub fn new(validation: bool) -> Result<Self, Error> {
        // SAFETY: the loader is kept in `entry`, which lives as long as every object made from it.
        let entry = unsafe { ash::Entry::load() }.map_err(|problem| {
            Error::NoDevice(format!(
                "the Vulkan loader was not found ({problem}); `make demo` installs it \
                 (Debian: libvulkan1 mesa-vulkan-drivers)"
            ))
        })?;
        // SAFETY: the loader is loaded; no layer is named.
        let extensions = unsafe { entry.enumerate_instance_extension_properties(None) }
            .map_err(Error::vulkan("listing the instance extensions"))?;
        let debug_utils =
            extensions.iter().any(|e| e.extension_name_as_c_str() == Ok(ext::debug_utils::NAME));
        if validation {
            check_validation_layer(&entry, debug_utils)?;
        }

        let log = MessageLog::default();
        let raw = create(&entry, validation, debug_utils, &log)?;
        let mut instance = Self { entry, raw, debug_utils, messenger: None, log };
        if validation {
            let loader = ext::debug_utils::Instance::new(&instance.entry, &instance.raw);
            let info = instance.log.messenger();
            // SAFETY: the extension is on, and the log outlives the messenger (see Drop).
            let messenger = unsafe { loader.create_debug_utils_messenger(&info, None) }
                .map_err(Error::vulkan("creating the debug messenger"))?;
            instance.messenger = Some((loader, messenger));
        }
        Ok(instance)
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        if let Some((loader, messenger)) = self.messenger.take() {
            // SAFETY: created from this instance, destroyed once.
            unsafe { loader.destroy_debug_utils_messenger(messenger, None) };
        }
        // SAFETY: the device that came from it is destroyed (its owner drops it first); the log,
        // which the instance reports to while it is destroyed, is dropped after this.
        unsafe { self.raw.destroy_instance(None) };
    }
}

fn check_validation_layer(entry: &ash::Entry, debug_utils: bool) -> Result<(), Error> {
    // SAFETY: the loader is loaded.
    let layers = unsafe { entry.enumerate_instance_layer_properties() }
        .map_err(Error::vulkan("listing the instance layers"))?;
    if debug_utils && layers.iter().any(|l| l.layer_name_as_c_str() == Ok(VALIDATION_LAYER)) {
        return Ok(());
    }
    Err(Error::NoDevice(
        "validation was asked for, but the layer VK_LAYER_KHRONOS_validation is not installed; \
         `make test` installs it (Debian: vulkan-validationlayers)"
            .into(),
    ))
}

fn create(
    entry: &ash::Entry,
    validation: bool,
    debug_utils: bool,
    log: &MessageLog,
) -> Result<ash::Instance, Error> {
    let application = vk::ApplicationInfo::default()
        .application_name(c"antumbra headless")
        .engine_name(c"antumbra")
        .api_version(vk::API_VERSION_1_1);
    let mut layers = Vec::new();
    let mut extensions = Vec::new();
    if debug_utils {
        extensions.push(ext::debug_utils::NAME.as_ptr());
    }
    if validation {
        layers.push(VALIDATION_LAYER.as_ptr());
        extensions.push(ext::validation_features::NAME.as_ptr());
    }
    let enabled = [vk::ValidationFeatureEnableEXT::SYNCHRONIZATION_VALIDATION];
    let mut features = vk::ValidationFeaturesEXT::default().enabled_validation_features(&enabled);
    // In the chain too, so that messages about creating and destroying the instance are kept.
    let mut messenger = log.messenger();
    let mut info = vk::InstanceCreateInfo::default()
        .application_info(&application)
        .enabled_layer_names(&layers)
        .enabled_extension_names(&extensions);
    if validation {
        info = info.push_next(&mut features).push_next(&mut messenger);
    }
    // SAFETY: every pointer in `info` is to a local that outlives the call, except the log, which
    // the caller keeps longer than the instance.
    unsafe { entry.create_instance(&info, None) }.map_err(|result| match result {
        vk::Result::ERROR_INCOMPATIBLE_DRIVER => Error::NoDevice(
            "the Vulkan loader found no driver; `make demo` installs one that needs no GPU \
             (Debian: mesa-vulkan-drivers)"
                .into(),
        ),
        _ => Error::vulkan("creating the Vulkan instance")(result),
    })
}
