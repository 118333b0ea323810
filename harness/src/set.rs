//! A descriptor set with its layout, written once.

use crate::{HeadlessDevice, HostBuffer};
use antumbra::Error;
use ash::vk;

/// The object that a binding of the set reads or writes. It must live as long as the set is used.
pub(crate) enum Bound<'a> {
    /// A storage buffer, whole.
    Storage(&'a HostBuffer),
    /// A uniform buffer, whole.
    Uniform(&'a HostBuffer),
    /// An image that is fetched from, and the layout that it is in then.
    Fetched(vk::ImageView, vk::ImageLayout),
}

impl Bound<'_> {
    fn kind(&self) -> vk::DescriptorType {
        match self {
            Self::Storage(_) => vk::DescriptorType::STORAGE_BUFFER,
            Self::Uniform(_) => vk::DescriptorType::UNIFORM_BUFFER,
            Self::Fetched(..) => vk::DescriptorType::SAMPLED_IMAGE,
        }
    }
}

/// Set 0 of a pipeline, the only one that it has.
#[derive(Debug)]
pub(crate) struct BoundSet {
    device: HeadlessDevice,
    layout: vk::DescriptorSetLayout,
    pool: vk::DescriptorPool,
    set: vk::DescriptorSet,
}

impl BoundSet {
    /// Makes the set and writes its bindings, which shaders of these stages see.
    ///
    /// # Errors
    /// [`Error::Vulkan`] where the driver refuses.
    pub fn new(
        device: &HeadlessDevice,
        stages: vk::ShaderStageFlags,
        bound: &[(u32, Bound)],
    ) -> Result<Self, Error> {
        // Dropping it cleans up from here on; null handles are legal to destroy.
        let mut new = Self {
            device: device.clone(),
            layout: vk::DescriptorSetLayout::null(),
            pool: vk::DescriptorPool::null(),
            set: vk::DescriptorSet::null(),
        };
        let raw = device.device();
        let binding = |(binding, bound): &(u32, Bound)| {
            vk::DescriptorSetLayoutBinding::default()
                .binding(*binding)
                .descriptor_type(bound.kind())
                .descriptor_count(1)
                .stage_flags(stages)
        };
        let bindings: Vec<_> = bound.iter().map(binding).collect();
        let create = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
        // SAFETY: the device lives; callers give each binding once.
        new.layout = unsafe { raw.create_descriptor_set_layout(&create, None) }
            .map_err(Error::vulkan("creating a descriptor set layout"))?;
        let size = |(_, bound): &(u32, Bound)| vk::DescriptorPoolSize {
            ty: bound.kind(),
            descriptor_count: 1,
        };
        let sizes: Vec<_> = bound.iter().map(size).collect();
        let create = vk::DescriptorPoolCreateInfo::default().max_sets(1).pool_sizes(&sizes);
        // SAFETY: the device lives.
        new.pool = unsafe { raw.create_descriptor_pool(&create, None) }
            .map_err(Error::vulkan("creating a descriptor pool"))?;
        let layouts = [new.layout];
        let allocate = vk::DescriptorSetAllocateInfo::default()
            .descriptor_pool(new.pool)
            .set_layouts(&layouts);
        // SAFETY: the pool was made for this one set.
        new.set = unsafe { raw.allocate_descriptor_sets(&allocate) }
            .map_err(Error::vulkan("allocating a descriptor set"))?[0];
        new.write(bound);
        Ok(new)
    }

    fn write(&self, bound: &[(u32, Bound)]) {
        let whole = |b: &HostBuffer| {
            [vk::DescriptorBufferInfo::default().buffer(b.raw()).range(vk::WHOLE_SIZE)]
        };
        for (binding, bound) in bound {
            let write = vk::WriteDescriptorSet::default()
                .dst_set(self.set)
                .dst_binding(*binding)
                .descriptor_type(bound.kind());
            let raw = self.device.device();
            match bound {
                Bound::Storage(buffer) | Bound::Uniform(buffer) => {
                    let info = whole(buffer);
                    // SAFETY: the set is new and has this binding; the buffer lives.
                    unsafe { raw.update_descriptor_sets(&[write.buffer_info(&info)], &[]) };
                }
                Bound::Fetched(view, layout) => {
                    let info = vk::DescriptorImageInfo::default();
                    let info = [info.image_view(*view).image_layout(*layout)];
                    // SAFETY: as above; the view lives.
                    unsafe { raw.update_descriptor_sets(&[write.image_info(&info)], &[]) };
                }
            }
        }
    }

    /// The set itself.
    pub fn raw(&self) -> vk::DescriptorSet {
        self.set
    }

    /// The set's layout, for the pipeline's.
    pub fn layout(&self) -> vk::DescriptorSetLayout {
        self.layout
    }

    /// Binds it for pipelines of this layout.
    ///
    /// # Safety
    /// `cmd` is recording on this device, what is bound lives until it is done, and the pipeline layout has
    /// this set's layout alone.
    pub unsafe fn bind(
        &self,
        cmd: vk::CommandBuffer,
        point: vk::PipelineBindPoint,
        layout: vk::PipelineLayout,
    ) {
        let raw = self.device.device();
        // SAFETY: the caller's promise; the set was written.
        unsafe { raw.cmd_bind_descriptor_sets(cmd, point, layout, 0, &[self.set], &[]) };
    }
}

impl Drop for BoundSet {
    fn drop(&mut self) {
        let raw = self.device.device();
        // SAFETY: made from this device; every submit that used it was waited for; null is allowed.
        unsafe { raw.destroy_descriptor_pool(self.pool, None) };
        // SAFETY: as above; pipeline layouts may outlive their set layouts.
        unsafe { raw.destroy_descriptor_set_layout(self.layout, None) };
    }
}
