//! The device of a test.

use crate::example::root;
use crate::skip::{say, validating};
use antumbra::Error;
use antumbra_harness::{HeadlessDevice, HeadlessOptions, MessageLog, Tables};
use std::ops::Deref;
use std::sync::{Arc, Mutex, PoisonError, Weak};

/// A device that fails its test if the validation layer says anything, up to and including while
/// the device is destroyed.
///
/// It derefs to [`HeadlessDevice`]. Make it before whatever holds a handle to it: locals are dropped
/// in reverse, so the device then goes last and objects that were never freed are seen.
#[derive(Debug)]
pub struct TestDevice {
    /// `None` only while it is dropped.
    device: Option<Arc<HeadlessDevice>>,
    log: MessageLog,
}

/// The device of the tests that run at the moment.
static SHARED: Mutex<Weak<HeadlessDevice>> = Mutex::new(Weak::new());

/// The same without the validation layer.
static UNWATCHED: Mutex<Weak<HeadlessDevice>> = Mutex::new(Weak::new());

/// The device that `ANTUMBRA_DRIVER` names, or the best there is; under the validation layer if
/// `ANTUMBRA_VALIDATE` is 1.
///
/// Tests that run at once share it, so that what a driver compiles for one of them serves the others,
/// and the last of them destroys it. What the validation layer says fails the first of them to end.
///
/// # Panics
/// Without such a device, with what to install.
pub fn device() -> TestDevice {
    shared(&SHARED, validating())
}

/// As [`device`], but never under the validation layer: for laws on thousands of images, which would take half as
/// long again.
///
/// # Panics
/// As [`device`].
pub fn unwatched() -> TestDevice {
    shared(&UNWATCHED, false)
}

fn shared(place: &Mutex<Weak<HeadlessDevice>>, validation: bool) -> TestDevice {
    let mut shared = place.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(device) = shared.upgrade() {
        return TestDevice::of(device);
    }
    let new = TestDevice::new(validation);
    *shared = new.device.as_ref().map_or(Weak::new(), Arc::downgrade);
    new
}

impl TestDevice {
    /// As [`device`], but a test's own, with or without the validation layer whatever the environment
    /// says.
    ///
    /// # Panics
    /// As [`device`].
    pub fn new(validation: bool) -> Self {
        Self::with(&HeadlessOptions { validation, ..Default::default() })
    }

    /// A test's own, on which nodes run the shaders of a GPU, or those of a processor; with the validation layer as for
    /// [`device`].
    ///
    /// # Panics
    /// As [`device`].
    pub fn taken_for(processor: bool) -> Self {
        let validation = validating();
        Self::with(&HeadlessOptions {
            validation,
            processor: Some(processor),
            ..Default::default()
        })
    }

    /// A test's own, under the validation layer, whose calls go through tables.
    ///
    /// # Panics
    /// As [`device`].
    pub fn through(tables: Tables) -> Self {
        let tables = Some(tables);
        Self::with(&HeadlessOptions { validation: true, tables, ..Default::default() })
    }

    fn with(options: &HeadlessOptions) -> Self {
        let device = HeadlessDevice::new(options)
            .unwrap_or_else(|error| panic!("{error}{}", hint(&error, options)));
        Self::of(Arc::new(device))
    }

    fn of(device: Arc<HeadlessDevice>) -> Self {
        let log = device.message_log();
        Self { device: Some(device), log }
    }

    /// Whether this driver is so slow that a test runs less on it; the output says then what is left to
    /// the others, also where the test passes.
    pub fn leaves_to_others(&self, what: &str) -> bool {
        let slow = self.name().contains("SwiftShader");
        if slow {
            say(&format!("left to other drivers than {}: {what}", self.name()));
        }
        slow
    }

    /// Ends the test here: drops this handle and checks what was said. Dropping does the same.
    ///
    /// # Panics
    /// If the validation layer said anything.
    pub fn finish(self) {}
}

/// What makes SwiftShader found where it was asked for and is not: it is in a folder that the loader does not know.
fn hint(error: &Error, options: &HeadlessOptions) -> String {
    let named = options.driver.clone().or_else(|| std::env::var("ANTUMBRA_DRIVER").ok());
    let wanted = named.unwrap_or_default().to_lowercase();
    if !matches!(error, Error::NoDevice(_)) || !wanted.contains("swift") {
        return String::new();
    }
    let folder = root().canonicalize().unwrap_or_else(|_| root());
    let description = folder.join(".drivers/vk_swiftshader_icd.json");
    let set = format!(
        "set VK_ADD_DRIVER_FILES={}, or run make function F=TEST DRIVER=SwiftShader",
        description.display()
    );
    match description.exists() {
        true => format!("; {set}"),
        false => format!("; make test unpacks SwiftShader into .drivers; then {set}"),
    }
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
