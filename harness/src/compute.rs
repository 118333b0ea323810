//! One compute dispatch from SPIR-V and buffers: what a shader's unit test needs.

use crate::{HeadlessDevice, HostBuffer};
use antumbra::Error;
use ash::vk;

/// Runs `spirv`'s entry point `main` once over `groups` workgroups and waits.
///
/// The buffers are bound as storage buffers at set 0, bindings 0, 1, 2 … and must have been made
/// with `STORAGE_BUFFER`. `push` is the push constant block from offset 0; empty means none.
///
/// # Errors
/// [`Error::Frame`] if `groups` or `push` exceed the device's limits or `push` is not a multiple of
/// 4 bytes; [`Error::Vulkan`] if the driver refuses.
pub fn run_compute(
    device: &HeadlessDevice,
    spirv: &[u32],
    push: &[u8],
    buffers: &[&HostBuffer],
    groups: [u32; 3],
) -> Result<(), Error> {
    ComputeProgram::new(device, spirv, push.len(), buffers)?.run(push, groups)
}

/// A compute pipeline with its buffers bound, to be dispatched as often as one likes.
// Starts as nulls, so that dropping it half made is right too.
#[derive(Debug)]
pub struct ComputeProgram {
    device: HeadlessDevice,
    module: vk::ShaderModule,
    set_layout: vk::DescriptorSetLayout,
    layout: vk::PipelineLayout,
    pool: vk::DescriptorPool,
    set: vk::DescriptorSet,
    pipeline: vk::Pipeline,
    push_bytes: usize,
}

impl ComputeProgram {
    /// A pipeline of `spirv`'s entry point `main`, with `push_bytes` bytes of push constants and
    /// the buffers as storage buffers at set 0, bindings 0, 1, 2 ….
    ///
    /// # Errors
    /// [`Error::Frame`] if `push_bytes` exceeds the device's limit or is not a multiple of 4;
    /// [`Error::Vulkan`] if the driver refuses.
    pub fn new(
        device: &HeadlessDevice,
        spirv: &[u32],
        push_bytes: usize,
        buffers: &[&HostBuffer],
    ) -> Result<Self, Error> {
        let most = device.limits().max_push_constants_size;
        let Some(range_bytes) =
            u32::try_from(push_bytes).ok().filter(|b| *b <= most && b.is_multiple_of(4))
        else {
            return Err(Error::Frame(format!(
                "{push_bytes} bytes of push constants; they must be a multiple of 4 up to {most}"
            )));
        };
        let mut new = Self {
            device: device.clone(),
            module: vk::ShaderModule::null(),
            set_layout: vk::DescriptorSetLayout::null(),
            layout: vk::PipelineLayout::null(),
            pool: vk::DescriptorPool::null(),
            set: vk::DescriptorSet::null(),
            pipeline: vk::Pipeline::null(),
            push_bytes,
        };
        let device = device.device();
        let info = vk::ShaderModuleCreateInfo::default().code(spirv);
        // SAFETY: the device lives; the words are the caller's to get right, as for any shader.
        new.module = unsafe { device.create_shader_module(&info, None) }
            .map_err(Error::vulkan("creating a shader module"))?;

        let bindings: Vec<_> = (0u32..)
            .zip(buffers)
            .map(|(binding, _)| {
                vk::DescriptorSetLayoutBinding::default()
                    .binding(binding)
                    .descriptor_type(vk::DescriptorType::STORAGE_BUFFER)
                    .descriptor_count(1)
                    .stage_flags(vk::ShaderStageFlags::COMPUTE)
            })
            .collect();
        let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
        // SAFETY: the device lives; the bindings are distinct.
        new.set_layout = unsafe { device.create_descriptor_set_layout(&info, None) }
            .map_err(Error::vulkan("creating a descriptor set layout"))?;

        let set_layouts = [new.set_layout];
        let ranges = [vk::PushConstantRange::default()
            .stage_flags(vk::ShaderStageFlags::COMPUTE)
            .size(range_bytes)];
        let info = vk::PipelineLayoutCreateInfo::default()
            .set_layouts(&set_layouts)
            .push_constant_ranges(if range_bytes == 0 { &[] } else { &ranges });
        // SAFETY: the set layout was made above.
        new.layout = unsafe { device.create_pipeline_layout(&info, None) }
            .map_err(Error::vulkan("creating a pipeline layout"))?;

        if !buffers.is_empty() {
            new.write_set(buffers)?;
        }

        let stage = vk::PipelineShaderStageCreateInfo::default()
            .stage(vk::ShaderStageFlags::COMPUTE)
            .module(new.module)
            .name(c"main");
        let info = [vk::ComputePipelineCreateInfo::default().stage(stage).layout(new.layout)];
        // SAFETY: module and layout were made above.
        let made =
            unsafe { device.create_compute_pipelines(vk::PipelineCache::null(), &info, None) };
        new.pipeline =
            made.map_err(|(_, result)| Error::vulkan("creating a compute pipeline")(result))?[0];
        Ok(new)
    }

    /// Runs one dispatch and waits. The buffers given to [`Self::new`] must live still.
    ///
    /// # Errors
    /// As [`Self::record`]; [`Error::Vulkan`] if the driver refuses.
    pub fn run(&self, push: &[u8], groups: [u32; 3]) -> Result<(), Error> {
        self.device.submit_and_wait(|cmd| {
            // SAFETY: `cmd` records outside a render pass; the program lives until
            // `submit_and_wait` has waited; it is the only dispatch, so there is nothing to order.
            unsafe { self.record(cmd, push, groups) }
        })
    }

    /// Records one dispatch.
    ///
    /// # Errors
    /// [`Error::Frame`] if `groups` exceeds the device's limits or `push` is not as long as was
    /// said; then nothing is recorded.
    ///
    /// # Safety
    /// `cmd` is recording on this device, outside a render pass; the program and its buffers outlive
    /// its execution; barriers order this dispatch after whatever it depends on.
    pub unsafe fn record(
        &self,
        cmd: vk::CommandBuffer,
        push: &[u8],
        groups: [u32; 3],
    ) -> Result<(), Error> {
        let most = self.device.limits().max_compute_work_group_count;
        if groups.iter().zip(&most).any(|(count, most)| *count == 0 || count > most) {
            let problem = format!("{groups:?} workgroups; each count must be 1 to {most:?}");
            return Err(Error::Frame(problem));
        }
        if push.len() != self.push_bytes {
            let (given, said) = (push.len(), self.push_bytes);
            let problem = format!("{given} bytes of push constants where {said} were said");
            return Err(Error::Frame(problem));
        }
        let compute = vk::PipelineBindPoint::COMPUTE;
        let raw = self.device.device();
        // SAFETY: `cmd` is recording and the objects live, by contract.
        unsafe { raw.cmd_bind_pipeline(cmd, compute, self.pipeline) };
        if self.set != vk::DescriptorSet::null() {
            // SAFETY: as above; the set was written for this layout.
            unsafe {
                raw.cmd_bind_descriptor_sets(cmd, compute, self.layout, 0, &[self.set], &[]);
            }
        }
        if !push.is_empty() {
            let stage = vk::ShaderStageFlags::COMPUTE;
            // SAFETY: as above; the layout has a range of this length from offset 0.
            unsafe { raw.cmd_push_constants(cmd, self.layout, stage, 0, push) };
        }
        // SAFETY: as above; the counts are within the limits.
        unsafe { raw.cmd_dispatch(cmd, groups[0], groups[1], groups[2]) };
        Ok(())
    }

    fn write_set(&mut self, buffers: &[&HostBuffer]) -> Result<(), Error> {
        let sizes = [vk::DescriptorPoolSize::default()
            .ty(vk::DescriptorType::STORAGE_BUFFER)
            .descriptor_count(buffers.len() as u32)];
        let info = vk::DescriptorPoolCreateInfo::default().max_sets(1).pool_sizes(&sizes);
        // SAFETY: the device lives.
        self.pool = unsafe { self.device.device().create_descriptor_pool(&info, None) }
            .map_err(Error::vulkan("creating a descriptor pool"))?;
        let set_layouts = [self.set_layout];
        let info = vk::DescriptorSetAllocateInfo::default()
            .descriptor_pool(self.pool)
            .set_layouts(&set_layouts);
        // SAFETY: the pool has room for just this set.
        let sets = unsafe { self.device.device().allocate_descriptor_sets(&info) }
            .map_err(Error::vulkan("allocating a descriptor set"))?;
        self.set = sets[0];

        let infos: Vec<_> = buffers
            .iter()
            .map(|b| [vk::DescriptorBufferInfo::default().buffer(b.raw()).range(vk::WHOLE_SIZE)])
            .collect();
        let writes: Vec<_> = (0u32..)
            .zip(&infos)
            .map(|(binding, info)| {
                vk::WriteDescriptorSet::default()
                    .dst_set(self.set)
                    .dst_binding(binding)
                    .descriptor_type(vk::DescriptorType::STORAGE_BUFFER)
                    .buffer_info(info)
            })
            .collect();
        // SAFETY: the set has these bindings and is not in use; the buffers live.
        unsafe { self.device.device().update_descriptor_sets(&writes, &[]) };
        Ok(())
    }
}

impl Drop for ComputeProgram {
    fn drop(&mut self) {
        let device = self.device.device();
        // SAFETY: made from this device or null; the submit that used them was waited for. The same
        // holds for each call below.
        unsafe { device.destroy_pipeline(self.pipeline, None) };
        // SAFETY: as above.
        unsafe { device.destroy_descriptor_pool(self.pool, None) };
        // SAFETY: as above.
        unsafe { device.destroy_pipeline_layout(self.layout, None) };
        // SAFETY: as above.
        unsafe { device.destroy_descriptor_set_layout(self.set_layout, None) };
        // SAFETY: as above.
        unsafe { device.destroy_shader_module(self.module, None) };
    }
}
