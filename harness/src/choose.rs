//! Chooses one of the machine's devices: a pure function over plain data.

use antumbra::Error;
use ash::vk;

/// The properties of a device that the choice depends on.
#[derive(Clone, Debug)]
pub(crate) struct Candidate {
    pub name: String,
    pub kind: vk::PhysicalDeviceType,
    pub api_version: u32,
    /// The first family with graphics and compute.
    pub queue_family: Option<u32>,
}

impl Candidate {
    /// Lower is better: a GPU of its own before one that shares the processor's memory, and a
    /// processor that plays GPU last.
    fn rank(&self) -> u32 {
        match self.kind {
            vk::PhysicalDeviceType::DISCRETE_GPU => 0,
            vk::PhysicalDeviceType::INTEGRATED_GPU => 1,
            vk::PhysicalDeviceType::VIRTUAL_GPU => 2,
            vk::PhysicalDeviceType::CPU => 3,
            _ => 4,
        }
    }

    fn gaps(&self) -> Vec<String> {
        let mut gaps = Vec::new();
        if self.api_version < vk::API_VERSION_1_1 {
            gaps.push("it must offer Vulkan 1.1".into());
        }
        if self.queue_family.is_none() {
            gaps.push("it must have a queue with graphics and compute".into());
        }
        gaps
    }
}

/// The index of the best device whose name holds `wanted` (in any case), and its queue family.
///
/// The first of equals wins, so the same machine gives the same device each time.
///
/// # Errors
/// [`Error::NoDevice`] with the devices that there are, if none is called so; [`Error::Device`] if
/// the best of them cannot be used.
pub(crate) fn choose(
    candidates: &[Candidate],
    wanted: Option<&str>,
) -> Result<(usize, u32), Error> {
    let wanted = wanted.map(str::to_lowercase).unwrap_or_default();
    let best = candidates
        .iter()
        .enumerate()
        .filter(|(_, c)| c.name.to_lowercase().contains(&wanted))
        .min_by_key(|(_, c)| (!c.gaps().is_empty(), c.rank()));
    let Some((index, device)) = best else {
        let names: Vec<_> = candidates.iter().map(|c| format!("\"{}\"", c.name)).collect();
        return Err(Error::NoDevice(match names.as_slice() {
            [] => "no driver offers a device; `make demo` installs one that needs no GPU \
                   (Debian: mesa-vulkan-drivers)"
                .into(),
            _ => format!("no device's name holds \"{wanted}\"; there are {}", names.join(", ")),
        }));
    };
    match device.queue_family {
        Some(family) if device.gaps().is_empty() => Ok((index, family)),
        _ => Err(Error::Device { device: device.name.clone(), gaps: device.gaps() }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vk::PhysicalDeviceType as Kind;

    fn device(name: &str, kind: Kind) -> Candidate {
        let name = name.into();
        Candidate { name, kind, api_version: vk::API_VERSION_1_1, queue_family: Some(0) }
    }

    fn machine() -> Vec<Candidate> {
        vec![
            device("llvmpipe (LLVM 15.0.6, 256 bits)", Kind::CPU),
            device("Some Integrated", Kind::INTEGRATED_GPU),
            device("Some Discrete", Kind::DISCRETE_GPU),
            device("SwiftShader Device (Subzero)", Kind::CPU),
        ]
    }

    #[test]
    fn prefers_a_gpu_of_its_own() {
        assert_eq!(choose(&machine(), None).unwrap(), (2, 0));
        assert_eq!(choose(&machine()[..2], None).unwrap(), (1, 0));
    }

    #[test]
    fn a_part_of_the_name_in_any_case_decides() {
        assert_eq!(choose(&machine(), Some("swiftshader")).unwrap().0, 3);
        assert_eq!(choose(&machine(), Some("LLVMpipe")).unwrap().0, 0);
        assert_eq!(choose(&machine(), Some("some")).unwrap().0, 2);
    }

    #[test]
    fn an_unknown_name_lists_the_devices() {
        let message = choose(&machine(), Some("voodoo")).unwrap_err().to_string();
        assert!(message.contains("voodoo") && message.contains("Some Integrated"), "{message}");
        assert!(choose(&[], None).unwrap_err().to_string().contains("mesa-vulkan-drivers"));
    }

    #[test]
    fn a_device_with_gaps_comes_last_and_names_all_of_them() {
        let mut machine = machine();
        machine[2].queue_family = None;
        machine[2].api_version = vk::API_VERSION_1_0;
        assert_eq!(choose(&machine, Some("some")).unwrap().0, 1);
        let message = choose(&machine, Some("discrete")).unwrap_err().to_string();
        assert!(message.contains("Vulkan 1.1") && message.contains("queue"), "{message}");
    }
}
