//! One compute dispatch from SPIR-V and buffers: what a shader's unit test needs.

use crate::module::ShaderModule;
use crate::set::{Bound, BoundSet};
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
    set: Option<BoundSet>,
    layout: vk::PipelineLayout,
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
        let bound: Vec<_> = (0..).zip(buffers.iter().map(|b| Bound::Storage(b))).collect();
        let set = match bound.as_slice() {
            [] => None,
            bound => Some(BoundSet::new(device, vk::ShaderStageFlags::COMPUTE, bound)?),
        };
        let mut new = Self {
            device: device.clone(),
            set,
            layout: vk::PipelineLayout::null(),
            pipeline: vk::Pipeline::null(),
            push_bytes,
        };
        let raw = device.device();
        let set_layouts: Vec<_> = new.set.iter().map(BoundSet::layout).collect();
        let ranges = [vk::PushConstantRange::default()
            .stage_flags(vk::ShaderStageFlags::COMPUTE)
            .size(range_bytes)];
        let info = vk::PipelineLayoutCreateInfo::default()
            .set_layouts(&set_layouts)
            .push_constant_ranges(if range_bytes == 0 { &[] } else { &ranges });
        // SAFETY: the set's layout was made above.
        new.layout = unsafe { raw.create_pipeline_layout(&info, None) }
            .map_err(Error::vulkan("creating a pipeline layout"))?;
        let module = ShaderModule::new(device, spirv, "a compute shader")?;
        let stage = module.stage(vk::ShaderStageFlags::COMPUTE);
        let info = [vk::ComputePipelineCreateInfo::default().stage(stage).layout(new.layout)];
        // SAFETY: module and layout were made above.
        let made = unsafe { raw.create_compute_pipelines(vk::PipelineCache::null(), &info, None) };
        new.pipeline =
            made.map_err(|(_, result)| Error::vulkan("creating a compute pipeline")(result))?[0];
        Ok(new)
    }

    /// Runs one dispatch and waits. The buffers given to [`Self::new`] must live still.
    ///
    /// # Errors
    /// See [`Self::record`]; [`Error::Vulkan`] if the driver refuses.
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
        if let Some(set) = &self.set {
            // SAFETY: as above; the layout was made for this set, and the buffers live by contract.
            unsafe { set.bind(cmd, compute, self.layout) };
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
}

impl Drop for ComputeProgram {
    fn drop(&mut self) {
        let device = self.device.device();
        // SAFETY: made from this device or null; the submit that used it was waited for.
        unsafe { device.destroy_pipeline(self.pipeline, None) };
        // SAFETY: as above.
        unsafe { device.destroy_pipeline_layout(self.layout, None) };
    }
}
