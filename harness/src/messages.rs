//! A log of the messages of the validation layer and the driver.

use ash::vk;
use std::ffi::{CStr, c_void};
use std::sync::{Arc, Mutex, PoisonError};

/// The warnings and errors of one device, shared by every handle to it.
///
/// Kept: every message of severity warning or error whose type is validation or performance.
/// Ignored: severities information and verbose (the layer's own settings, object life times), and
/// messages that are only of type general: there the loader and the drivers talk about themselves,
/// such as a driver that is installed for hardware this machine lacks. None of those is about a call
/// that the program made.
///
/// A log outlives its device, so what is said while the device is destroyed (an object that was
/// never freed) can be read afterwards.
#[derive(Clone, Debug, Default)]
pub struct MessageLog(Arc<Mutex<Vec<String>>>);

impl MessageLog {
    /// Every message so far, oldest first.
    pub fn messages(&self) -> Vec<String> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Every message so far, oldest first; the log is empty afterwards.
    pub fn take(&self) -> Vec<String> {
        std::mem::take(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// The create info of a messenger that reports to this log. The log must outlive the messenger and the instance.
    pub(crate) fn messenger(&self) -> vk::DebugUtilsMessengerCreateInfoEXT<'static> {
        use vk::DebugUtilsMessageSeverityFlagsEXT as Severity;
        use vk::DebugUtilsMessageTypeFlagsEXT as Type;
        vk::DebugUtilsMessengerCreateInfoEXT::default()
            .message_severity(Severity::WARNING | Severity::ERROR)
            .message_type(Type::VALIDATION | Type::PERFORMANCE)
            .pfn_user_callback(Some(on_message))
            .user_data(Arc::as_ptr(&self.0).cast_mut().cast())
    }
}

unsafe extern "system" fn on_message(
    severity: vk::DebugUtilsMessageSeverityFlagsEXT,
    _types: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    log: *mut c_void,
) -> vk::Bool32 {
    // SAFETY: `log` is the pointer that `messenger` took from an Arc which outlives the instance.
    let log = unsafe { &*log.cast_const().cast::<Mutex<Vec<String>>>() };
    // SAFETY: Vulkan hands a valid structure for the length of the call.
    let data = unsafe { &*data };
    // SAFETY: null, or a string that is valid for the length of the call.
    let id = unsafe { data.message_id_name_as_c_str() };
    // SAFETY: as above.
    let text = unsafe { data.message_as_c_str() };
    let lossy = |s: Option<&CStr>| s.map(CStr::to_string_lossy).unwrap_or_default().into_owned();
    let line = format!("{severity:?} {}: {}", lossy(id), lossy(text));
    log.lock().unwrap_or_else(PoisonError::into_inner).push(line);
    vk::FALSE // the call that caused the message goes on
}
