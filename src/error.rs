//! The crate's one error type: each variant names the file, node, option, pass or resource.

/// An error, as one sentence that says what is wrong and what would be right.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file that cannot be read or is not what it should be.
    #[error("{path}: {problem}")]
    File {
        /// The file as it was named.
        path: String,
        /// The end of the sentence: what is wrong, and what would be right.
        problem: String,
    },
    /// A light that no technique can work with.
    #[error("the light cannot be used: {0}")]
    Light(String),
    /// A scene that parses but cannot be shadowed: names the node or mesh.
    #[error("{0}")]
    Scene(String),
    /// A setting that is unknown or outside its range.
    #[error("setting {key}: {problem}")]
    Setting {
        /// The setting's key, as in `--set key=value`.
        key: String,
        /// The end of the sentence: what is wrong, and which values would be right.
        problem: String,
    },
    /// No device to run on: the loader, a driver, a layer or the named device is missing.
    #[error("no Vulkan device: {0}")]
    NoDevice(String),
    /// A device that lacks something the node needs; the error lists everything.
    #[error("the device {device} cannot run antumbra: {}", gaps.join("; "))]
    Device {
        /// The device's name.
        device: String,
        /// Everything that the device lacks, as short phrases.
        gaps: Vec<String>,
    },
    /// A Vulkan call that failed.
    #[error("{doing} failed: {result:?}")]
    Vulkan {
        /// The action that failed, with the pass or resource it was for.
        doing: String,
        /// The driver's result code.
        result: ash::vk::Result,
    },
    /// The device is gone, and with it everything made from it.
    #[error(
        "the device was lost while {doing}; destroy the node with all else that is the device's, \
         and start anew with another"
    )]
    DeviceLost {
        /// The action during which the loss was detected.
        doing: String,
    },
    /// Memory that could not be allocated.
    #[error("no memory for {resource} ({bytes} bytes): {problem}")]
    Memory {
        /// The resource that needs the memory.
        resource: String,
        /// The bytes that it needs.
        bytes: u64,
        /// The allocator's error.
        problem: String,
    },
    /// A plan that the node does not take any more: plan the frame again, and record that.
    #[error("this plan {0}; plan the frame again")]
    StalePlan(&'static str),
    /// A plan with meshes that the host draws, recorded without a callback that draws them: record it by
    /// [`ShadowNode::record_with`](crate::ShadowNode::record_with).
    #[error("some of this plan's meshes are the host's to draw; use record_with")]
    NeedsHostDraws,
    /// A frame, plan or call that does not fit the node it was given to.
    #[error("{0}")]
    Frame(String),
}

impl Error {
    /// Wraps a Vulkan result code, a lost device apart from the others; `doing` reads as in "creating the
    /// pipeline of {pass}".
    pub fn vulkan(doing: impl Into<String>) -> impl FnOnce(ash::vk::Result) -> Self {
        let doing = doing.into();
        move |result| match result {
            ash::vk::Result::ERROR_DEVICE_LOST => Self::DeviceLost { doing },
            result => Self::Vulkan { doing, result },
        }
    }
}

/// The most characters of a name that a sentence shows.
pub(crate) const NAME_SHOWN: usize = 60;

/// A name from a file or a command line for a sentence: in quotes, on one line, cut after [`NAME_SHOWN`] characters.
pub(crate) fn quoted(name: &str) -> String {
    let shown: String = name.chars().take(NAME_SHOWN).collect();
    let rest = if shown.len() < name.len() { "…" } else { "" };
    format!("{shown:?}{rest}")
}
