//! The device of a test.

use antumbra::gpu::headless::{HeadlessDevice, HeadlessOptions, MessageLog};
use std::ops::Deref;

/// A device that fails its test if the validation layer says anything, up to and including while
/// the device is destroyed.
///
/// It derefs to [`HeadlessDevice`]. Make it before whatever holds a handle to it: locals are dropped
/// in reverse, so the device then goes last and objects that were never freed are seen.
#[derive(Debug)]
pub struct TestDevice {
    /// `None` only while it is dropped.
    device: Option<HeadlessDevice>,
    log: MessageLog,
}

/// The device that `ANTUMBRA_DRIVER` names, or the best there is; under the validation layer if
/// `ANTUMBRA_VALIDATE` is 1.
///
/// # Panics
/// Without such a device, with what to install.
pub fn device() -> TestDevice {
    let validation = std::env::var("ANTUMBRA_VALIDATE").is_ok_and(|value| value == "1");
    TestDevice::new(validation)
}

impl TestDevice {
    /// As [`device`], with or without the validation layer whatever the environment says.
    ///
    /// # Panics
    /// As [`device`].
    pub fn new(validation: bool) -> Self {
        let device = HeadlessDevice::new(&HeadlessOptions { validation, ..Default::default() })
            .unwrap_or_else(|error| panic!("{error}"));
        let log = device.message_log();
        Self { device: Some(device), log }
    }

    /// Ends the test here: drops this handle and checks what was said. Dropping does the same.
    ///
    /// # Panics
    /// If the validation layer said anything.
    pub fn finish(self) {}
}

impl Deref for TestDevice {
    type Target = HeadlessDevice;

    fn deref(&self) -> &HeadlessDevice {
        self.device.as_ref().expect("the device is there until it is dropped")
    }
}

impl Drop for TestDevice {
    fn drop(&mut self) {
        drop(self.device.take());
        let messages = self.log.take();
        // A second panic would abort and hide the first.
        if !std::thread::panicking() {
            let (count, text) = (messages.len(), messages.join("\n\n"));
            assert!(messages.is_empty(), "the validation layer said {count} things:\n\n{text}");
        }
    }
}
