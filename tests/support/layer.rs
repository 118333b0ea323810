//! Programs under the validation layer, switched on from outside: hosts of their own make their own
//! instance, and must not have to know.

use crate::example::folder;
use crate::skip::validating;
use std::path::Path;
use std::process::Command;

/// What a program did.
#[derive(Debug)]
pub struct Run {
    /// Whether it ended well.
    pub ok: bool,
    /// What it wrote to standard output.
    pub said: String,
    /// What it wrote to standard error.
    pub complained: String,
    /// What the validation layer, synchronization checks included, wrote.
    pub messages: String,
}

/// How closely the layer looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Checks {
    /// Not at all.
    None,
    /// Synchronization within each command buffer.
    Commands,
    /// And between command buffers that are submitted together. (The layer does not follow timeline
    /// semaphores, by which wgpu knows that memory is free again.)
    Submits,
}

impl Checks {
    /// These, where tests run under the layer.
    pub fn if_validating(self) -> Self {
        if validating() { self } else { Self::None }
    }
}

/// Runs a program, under the layer if asked.
///
/// # Panics
/// If it cannot be started.
pub fn run(program: &Path, arguments: &[&str], checks: Checks) -> Run {
    let mut command = Command::new(program);
    command.args(arguments);
    let name = program.file_name().unwrap().to_string_lossy().into_owned();
    let place = folder(&format!("layer-{name}-{:?}", std::thread::current().id()));
    let log = place.join("messages");
    if checks != Checks::None {
        let submits = match checks {
            Checks::Submits => ",VALIDATION_CHECK_ENABLE_SYNCHRONIZATION_VALIDATION_QUEUE_SUBMIT",
            _ => "",
        };
        let settings = place.join("vk_layer_settings.txt");
        let text = format!(
            "khronos_validation.debug_action = VK_DBG_LAYER_ACTION_LOG_MSG\n\
             khronos_validation.report_flags = error,warn,perf\n\
             khronos_validation.log_filename = {}\n\
             khronos_validation.enables = \
             VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT{submits}\n",
            log.display()
        );
        std::fs::write(&settings, text).unwrap();
        command
            .env("VK_INSTANCE_LAYERS", "VK_LAYER_KHRONOS_validation")
            .env("VK_LAYER_SETTINGS_PATH", &settings);
    }
    let output = command.output().unwrap();
    // Made by the layer, even where it has nothing to say; without it the layer was not there.
    let messages = std::fs::read_to_string(&log);
    assert!(checks == Checks::None || messages.is_ok(), "{name}: the validation layer did not run");
    std::fs::remove_dir_all(place).unwrap();
    Run {
        ok: output.status.success(),
        said: String::from_utf8_lossy(&output.stdout).into_owned(),
        complained: String::from_utf8_lossy(&output.stderr).into_owned(),
        messages: messages.unwrap_or_default(),
    }
}
