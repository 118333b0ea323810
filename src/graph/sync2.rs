//! Scopes in the words of Vulkan 1.3's synchronization2.

use super::Scope;
use ash::vk::{self, AccessFlags2, ImageLayout, PipelineStageFlags2};

/// The stages and accesses that both versions have: their bits are the same.
const SHARED: u64 = u32::MAX as u64;

/// Stages that version 1 knows by another name, which covers them.
const STAGES: [(PipelineStageFlags2, vk::PipelineStageFlags); 3] = [
    (
        PipelineStageFlags2::from_raw(
            PipelineStageFlags2::COPY.as_raw()
                | PipelineStageFlags2::RESOLVE.as_raw()
                | PipelineStageFlags2::BLIT.as_raw()
                | PipelineStageFlags2::CLEAR.as_raw(),
        ),
        vk::PipelineStageFlags::TRANSFER,
    ),
    (
        PipelineStageFlags2::from_raw(
            PipelineStageFlags2::INDEX_INPUT.as_raw()
                | PipelineStageFlags2::VERTEX_ATTRIBUTE_INPUT.as_raw(),
        ),
        vk::PipelineStageFlags::VERTEX_INPUT,
    ),
    // Stages by name would need the features that they are of.
    (PipelineStageFlags2::PRE_RASTERIZATION_SHADERS, vk::PipelineStageFlags::ALL_GRAPHICS),
];

/// Accesses that version 1 knows by another name, which covers them.
const ACCESSES: [(AccessFlags2, vk::AccessFlags); 2] = [
    (
        AccessFlags2::from_raw(
            AccessFlags2::SHADER_SAMPLED_READ.as_raw() | AccessFlags2::SHADER_STORAGE_READ.as_raw(),
        ),
        vk::AccessFlags::SHADER_READ,
    ),
    (AccessFlags2::SHADER_STORAGE_WRITE, vk::AccessFlags::SHADER_WRITE),
];

impl From<(PipelineStageFlags2, AccessFlags2, ImageLayout)> for Scope {
    /// Converts into the equal use of version 1, or one that covers it: `COPY` becomes `TRANSFER`,
    /// `SHADER_SAMPLED_READ` becomes `SHADER_READ`, no stage becomes `TOP_OF_PIPE`, and what version 1 has no word for
    /// becomes all stages and all accesses.
    ///
    /// `SYNCHRONIZATION_2`'s layouts `ATTACHMENT_OPTIMAL` and `READ_ONLY_OPTIMAL` stay what they are, and need that
    /// feature of the host's device.
    fn from((stage, access, layout): (PipelineStageFlags2, AccessFlags2, ImageLayout)) -> Self {
        let mut stage_1 = vk::PipelineStageFlags::from_raw((stage.as_raw() & SHARED) as u32);
        let mut rest = stage.as_raw() & !SHARED;
        for (theirs, ours) in STAGES {
            if stage.intersects(theirs) {
                stage_1 |= ours;
                rest &= !theirs.as_raw();
            }
        }
        if rest != 0 {
            stage_1 = vk::PipelineStageFlags::ALL_COMMANDS;
        } else if stage_1.is_empty() {
            stage_1 = vk::PipelineStageFlags::TOP_OF_PIPE;
        }
        let mut access_1 = vk::AccessFlags::from_raw((access.as_raw() & SHARED) as u32);
        let mut rest = access.as_raw() & !SHARED;
        for (theirs, ours) in ACCESSES {
            if access.intersects(theirs) {
                access_1 |= ours;
                rest &= !theirs.as_raw();
            }
        }
        if rest != 0 {
            access_1 |= vk::AccessFlags::MEMORY_READ | vk::AccessFlags::MEMORY_WRITE;
        }
        Self { stage: stage_1, access: access_1, layout }
    }
}

impl Scope {
    /// The stages, as synchronization2 has them.
    pub fn stage2(&self) -> PipelineStageFlags2 {
        PipelineStageFlags2::from_raw(u64::from(self.stage.as_raw()))
    }

    /// The accesses, as synchronization2 has them.
    pub fn access2(&self) -> AccessFlags2 {
        AccessFlags2::from_raw(u64::from(self.access.as_raw()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ash::vk::{AccessFlags as A, ImageLayout as L, PipelineStageFlags as S};

    #[test]
    fn what_both_versions_have_is_the_same_there_and_back() {
        let scopes = [
            Scope::UNUSED,
            Scope::DEPTH_DRAWN,
            Scope::DEPTH_DRAWN_ONLY,
            Scope::COLOR_DRAWN,
            Scope::FRAGMENT_SAMPLED,
            Scope::COMPUTE_WRITTEN,
            Scope::COPIED_FROM,
            Scope::ANY,
        ];
        for scope in scopes {
            assert_eq!(Scope::from((scope.stage2(), scope.access2(), scope.layout)), scope);
        }
    }

    #[test]
    fn what_version_1_lacks_is_covered() {
        use ash::vk::{AccessFlags2 as A2, PipelineStageFlags2 as S2};
        let layout = L::GENERAL;
        for (stage, access, stage_1, access_1) in [
            (S2::COPY | S2::CLEAR, A2::TRANSFER_WRITE, S::TRANSFER, A::TRANSFER_WRITE),
            (S2::FRAGMENT_SHADER, A2::SHADER_SAMPLED_READ, S::FRAGMENT_SHADER, A::SHADER_READ),
            (
                S2::COMPUTE_SHADER,
                A2::SHADER_STORAGE_WRITE | A2::SHADER_STORAGE_READ,
                S::COMPUTE_SHADER,
                A::SHADER_READ | A::SHADER_WRITE,
            ),
            (S2::INDEX_INPUT, A2::INDEX_READ, S::VERTEX_INPUT, A::INDEX_READ),
            (S2::PRE_RASTERIZATION_SHADERS, A2::SHADER_READ, S::ALL_GRAPHICS, A::SHADER_READ),
            (S2::NONE, A2::NONE, S::TOP_OF_PIPE, A::empty()),
            (
                S2::from_raw(1 << 60),
                A2::from_raw(1 << 60),
                S::ALL_COMMANDS,
                A::MEMORY_READ | A::MEMORY_WRITE,
            ),
        ] {
            let made = Scope::from((stage, access, layout));
            assert_eq!(made, Scope { stage: stage_1, access: access_1, layout });
        }
    }
}
