//! The ways in which a pass accesses a resource, with their Vulkan stages, access bits and layouts.

use ash::vk;

/// The access bits that write.
pub(super) const WRITES: vk::AccessFlags = vk::AccessFlags::from_raw(
    vk::AccessFlags::SHADER_WRITE.as_raw()
        | vk::AccessFlags::COLOR_ATTACHMENT_WRITE.as_raw()
        | vk::AccessFlags::DEPTH_STENCIL_ATTACHMENT_WRITE.as_raw()
        | vk::AccessFlags::TRANSFER_WRITE.as_raw()
        | vk::AccessFlags::HOST_WRITE.as_raw()
        | vk::AccessFlags::MEMORY_WRITE.as_raw(),
);

/// One way in which a pass accesses a resource.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Access {
    /// An image fetched by a compute shader, without a sampler.
    SampledCompute,
    /// An image fetched by a fragment shader, without a sampler.
    SampledFragment,
    /// A storage image that a compute shader reads.
    ImageRead,
    /// A storage image that a compute shader writes, every texel once.
    ImageWrite,
    /// A storage image that a compute shader reads and writes, each texel by one invocation.
    ImageUpdate,
    /// A storage buffer that a compute shader reads.
    BufferReadCompute,
    /// A storage buffer that a compute shader writes.
    BufferWriteCompute,
    /// A storage buffer that a compute shader reads and writes, each part by one invocation.
    BufferUpdate,
    /// A storage buffer that a vertex shader reads.
    BufferReadVertex,
    /// A buffer that holds the arguments of an indirect draw or dispatch.
    Indirect,
    /// A buffer that a command writes, without a shader.
    TransferWrite,
    /// A depth attachment, cleared and then tested and written.
    DepthTarget,
    /// A color attachment, cleared and then written or blended.
    ColorTarget,
}

/// Stages and access bits of one use, and the layout an image must be in.
///
/// It is also made from synchronization2's words: `Scope::from((stage2, access2, layout))`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scope {
    /// The pipeline stages that access the resource.
    pub stage: vk::PipelineStageFlags,
    /// The access bits of these stages.
    pub access: vk::AccessFlags,
    /// The image's layout; `UNDEFINED` for buffers.
    pub layout: vk::ImageLayout,
}

/// The uses that hosts have most, each with its stage, access and layout; others are written out.
impl Scope {
    const fn of(
        stage: vk::PipelineStageFlags,
        access: vk::AccessFlags,
        layout: vk::ImageLayout,
    ) -> Self {
        Self { stage, access, layout }
    }

    /// A new image that nothing has used: `TOP_OF_PIPE`, no access, `UNDEFINED`. For `before`, where the content does
    /// not matter.
    pub const UNUSED: Self = Self::of(
        vk::PipelineStageFlags::TOP_OF_PIPE,
        vk::AccessFlags::empty(),
        vk::ImageLayout::UNDEFINED,
    );
    /// Whatever comes next, in whatever layout the node leaves the image: `ALL_COMMANDS`, no access, `UNDEFINED`. For
    /// `after`, where the host's next use clears the image or places a barrier of its own. What comes next waits for
    /// the node, and may not read what the node wrote without that barrier.
    pub const ANY: Self = Self::of(
        vk::PipelineStageFlags::ALL_COMMANDS,
        vk::AccessFlags::empty(),
        vk::ImageLayout::UNDEFINED,
    );
    /// A depth attachment that was drawn to: `LATE_FRAGMENT_TESTS`, `DEPTH_STENCIL_ATTACHMENT_WRITE`,
    /// `DEPTH_STENCIL_ATTACHMENT_OPTIMAL`.
    pub const DEPTH_DRAWN: Self = Self::of(
        vk::PipelineStageFlags::LATE_FRAGMENT_TESTS,
        vk::AccessFlags::DEPTH_STENCIL_ATTACHMENT_WRITE,
        vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
    );
    /// A depth attachment without stencil that was drawn to: `LATE_FRAGMENT_TESTS`, `DEPTH_STENCIL_ATTACHMENT_WRITE`,
    /// `DEPTH_ATTACHMENT_OPTIMAL`, which is Vulkan 1.2's `separateDepthStencilLayouts`.
    pub const DEPTH_DRAWN_ONLY: Self = Self::of(
        vk::PipelineStageFlags::LATE_FRAGMENT_TESTS,
        vk::AccessFlags::DEPTH_STENCIL_ATTACHMENT_WRITE,
        vk::ImageLayout::DEPTH_ATTACHMENT_OPTIMAL,
    );
    /// A color attachment that was drawn to: `COLOR_ATTACHMENT_OUTPUT`, `COLOR_ATTACHMENT_WRITE`,
    /// `COLOR_ATTACHMENT_OPTIMAL`.
    pub const COLOR_DRAWN: Self = Self::of(
        vk::PipelineStageFlags::COLOR_ATTACHMENT_OUTPUT,
        vk::AccessFlags::COLOR_ATTACHMENT_WRITE,
        vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
    );
    /// Sampled or fetched by fragment shaders: `FRAGMENT_SHADER`, `SHADER_READ`, `SHADER_READ_ONLY_OPTIMAL`.
    pub const FRAGMENT_SAMPLED: Self = Self::of(
        vk::PipelineStageFlags::FRAGMENT_SHADER,
        vk::AccessFlags::SHADER_READ,
        vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL,
    );
    /// Sampled or fetched by compute shaders: `COMPUTE_SHADER`, `SHADER_READ`, `SHADER_READ_ONLY_OPTIMAL`.
    pub const COMPUTE_SAMPLED: Self = Self::of(
        vk::PipelineStageFlags::COMPUTE_SHADER,
        vk::AccessFlags::SHADER_READ,
        vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL,
    );
    /// A storage image that compute shaders wrote: `COMPUTE_SHADER`, `SHADER_WRITE`, `GENERAL`.
    pub const COMPUTE_WRITTEN: Self = Self::of(
        vk::PipelineStageFlags::COMPUTE_SHADER,
        vk::AccessFlags::SHADER_WRITE,
        vk::ImageLayout::GENERAL,
    );
    /// Memory that the host reads once the device has completed the commands: `HOST`, `HOST_READ`.
    pub(crate) const HOST_READ: Self = Self::of(
        vk::PipelineStageFlags::HOST,
        vk::AccessFlags::HOST_READ,
        vk::ImageLayout::UNDEFINED,
    );
    /// The source of a copy: `TRANSFER`, `TRANSFER_READ`, `TRANSFER_SRC_OPTIMAL`.
    pub const COPIED_FROM: Self = Self::of(
        vk::PipelineStageFlags::TRANSFER,
        vk::AccessFlags::TRANSFER_READ,
        vk::ImageLayout::TRANSFER_SRC_OPTIMAL,
    );

    /// Whether any access of the scope writes.
    pub fn writes(&self) -> bool {
        self.access.intersects(WRITES)
    }

    /// The scope with another layout.
    #[must_use]
    pub const fn in_layout(self, layout: vk::ImageLayout) -> Self {
        Self { layout, ..self }
    }

    /// The scope with the layout `UNDEFINED`, which discards the image's content.
    #[must_use]
    pub const fn forgotten(self) -> Self {
        self.in_layout(vk::ImageLayout::UNDEFINED)
    }
}

impl Access {
    /// Every access, in the order of the variants.
    pub const ALL: [Self; 13] = [
        Self::SampledCompute,
        Self::SampledFragment,
        Self::ImageRead,
        Self::ImageWrite,
        Self::ImageUpdate,
        Self::BufferReadCompute,
        Self::BufferWriteCompute,
        Self::BufferUpdate,
        Self::BufferReadVertex,
        Self::Indirect,
        Self::TransferWrite,
        Self::DepthTarget,
        Self::ColorTarget,
    ];

    /// Whether the access writes.
    pub fn writes(self) -> bool {
        matches!(
            self,
            Self::ImageWrite
                | Self::ImageUpdate
                | Self::BufferWriteCompute
                | Self::BufferUpdate
                | Self::TransferWrite
                | Self::DepthTarget
                | Self::ColorTarget
        )
    }

    /// Whether the access depends on the present content, which an earlier pass of the frame must have written.
    pub fn reads(self) -> bool {
        matches!(self, Self::ImageUpdate | Self::BufferUpdate) || !self.writes()
    }

    /// The stages, access bits and layout of the access.
    pub fn scope(self) -> Scope {
        use vk::{AccessFlags as A, ImageLayout as L, PipelineStageFlags as S};
        let (stage, access, layout) = match self {
            Self::SampledCompute => {
                (S::COMPUTE_SHADER, A::SHADER_READ, L::SHADER_READ_ONLY_OPTIMAL)
            }
            Self::SampledFragment => {
                (S::FRAGMENT_SHADER, A::SHADER_READ, L::SHADER_READ_ONLY_OPTIMAL)
            }
            Self::ImageRead => (S::COMPUTE_SHADER, A::SHADER_READ, L::GENERAL),
            Self::ImageWrite => (S::COMPUTE_SHADER, A::SHADER_WRITE, L::GENERAL),
            Self::ImageUpdate => (S::COMPUTE_SHADER, A::SHADER_READ | A::SHADER_WRITE, L::GENERAL),
            Self::BufferReadCompute => (S::COMPUTE_SHADER, A::SHADER_READ, L::UNDEFINED),
            Self::BufferWriteCompute => (S::COMPUTE_SHADER, A::SHADER_WRITE, L::UNDEFINED),
            Self::BufferUpdate => {
                (S::COMPUTE_SHADER, A::SHADER_READ | A::SHADER_WRITE, L::UNDEFINED)
            }
            Self::BufferReadVertex => (S::VERTEX_SHADER, A::SHADER_READ, L::UNDEFINED),
            Self::Indirect => (S::DRAW_INDIRECT, A::INDIRECT_COMMAND_READ, L::UNDEFINED),
            Self::TransferWrite => (S::TRANSFER, A::TRANSFER_WRITE, L::UNDEFINED),
            Self::DepthTarget => (
                S::EARLY_FRAGMENT_TESTS | S::LATE_FRAGMENT_TESTS,
                A::DEPTH_STENCIL_ATTACHMENT_READ | A::DEPTH_STENCIL_ATTACHMENT_WRITE,
                L::DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
            ),
            Self::ColorTarget => (
                S::COLOR_ATTACHMENT_OUTPUT,
                A::COLOR_ATTACHMENT_READ | A::COLOR_ATTACHMENT_WRITE,
                L::COLOR_ATTACHMENT_OPTIMAL,
            ),
        };
        Scope { stage, access, layout }
    }

    /// The usage that an image needs for the access; empty for an access to buffers.
    pub fn image_usage(self) -> vk::ImageUsageFlags {
        match self {
            Self::SampledCompute | Self::SampledFragment => vk::ImageUsageFlags::SAMPLED,
            Self::ImageRead | Self::ImageWrite | Self::ImageUpdate => vk::ImageUsageFlags::STORAGE,
            Self::DepthTarget => vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT,
            Self::ColorTarget => vk::ImageUsageFlags::COLOR_ATTACHMENT,
            _ => vk::ImageUsageFlags::empty(),
        }
    }

    /// The usage that a buffer needs for the access; empty for an access to images.
    pub fn buffer_usage(self) -> vk::BufferUsageFlags {
        match self {
            Self::BufferReadCompute
            | Self::BufferWriteCompute
            | Self::BufferUpdate
            | Self::BufferReadVertex => vk::BufferUsageFlags::STORAGE_BUFFER,
            Self::Indirect => vk::BufferUsageFlags::INDIRECT_BUFFER,
            Self::TransferWrite => vk::BufferUsageFlags::TRANSFER_DST,
            _ => vk::BufferUsageFlags::empty(),
        }
    }

    /// The type of descriptor that a shader accesses the resource through; `None` for attachments and indirect
    /// arguments.
    pub fn descriptor(self) -> Option<vk::DescriptorType> {
        match self {
            Self::SampledCompute | Self::SampledFragment => Some(vk::DescriptorType::SAMPLED_IMAGE),
            Self::ImageRead | Self::ImageWrite | Self::ImageUpdate => {
                Some(vk::DescriptorType::STORAGE_IMAGE)
            }
            Self::BufferReadCompute
            | Self::BufferWriteCompute
            | Self::BufferUpdate
            | Self::BufferReadVertex => Some(vk::DescriptorType::STORAGE_BUFFER),
            Self::Indirect | Self::TransferWrite | Self::DepthTarget | Self::ColorTarget => None,
        }
    }

    /// The shader stage that the access's descriptor must be visible to.
    pub fn shader_stage(self) -> vk::ShaderStageFlags {
        match self {
            Self::SampledFragment => vk::ShaderStageFlags::FRAGMENT,
            Self::BufferReadVertex => vk::ShaderStageFlags::VERTEX,
            _ => vk::ShaderStageFlags::COMPUTE,
        }
    }
}
