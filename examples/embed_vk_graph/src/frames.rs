//! Two frames in flight, and what is read back of the last.

use crate::Outcome;
use crate::device::Gpu;
use crate::targets::Targets;
use ash::vk;
use std::sync::Arc;
use vk_graph::Graph;
use vk_graph::driver::buffer::{Buffer, BufferInfo};
use vk_graph::driver::fence::Fence;
use vk_graph::driver::image::Image;
use vk_graph::driver::sync::AccessType;
use vk_graph::pool::hash::HashPool;

/// The number of frames that are recorded before the device must have completed the first of them.
pub const FRAMES_IN_FLIGHT: u32 = 2;

/// The frames in flight: of each slot, the last frame's number and fence.
pub struct Frames {
    slots: [Option<(u64, Fence)>; FRAMES_IN_FLIGHT as usize],
    /// Command buffers, render passes and descriptors, for graphs to use again.
    pool: HashPool,
    queue_family: u32,
}

impl Frames {
    pub fn new(gpu: &Gpu) -> Self {
        let pool = HashPool::new(&gpu.device);
        Self { slots: [const { None }; _], pool, queue_family: gpu.queue_family }
    }

    /// The slot of a frame: its index among the frames in flight.
    pub fn slot_of(number: u64) -> u32 {
        (number % u64::from(FRAMES_IN_FLIGHT)) as u32
    }

    /// Waits until the frame that last had this one's slot is done, and gives its number back; none
    /// at the start. All frames before it are done then too: a fence waits for everything submitted
    /// earlier.
    pub fn wait(&mut self, number: u64) -> Outcome<Option<u64>> {
        let Some((done, mut fence)) = self.slots[Self::slot_of(number) as usize].take() else {
            return Ok(None);
        };
        fence.wait()?;
        Ok(Some(done))
    }

    /// Records the graph's commands with vk-graph's barriers between them and submits; nothing waits.
    pub fn submit(&mut self, number: u64, graph: Graph) -> Outcome<()> {
        let fence = graph.finalize().queue_submit(&mut self.pool, self.queue_family, 0)?;
        self.slots[Self::slot_of(number) as usize] = Some((number, fence));
        Ok(())
    }
}

/// Copies of a frame's images that the processor can see.
pub struct ReadBack {
    visibility: Arc<Buffer>,
    depth: Arc<Buffer>,
    picture: Arc<Buffer>,
}

impl ReadBack {
    /// Adds the commands that copy.
    pub fn add(gpu: &Gpu, graph: &mut Graph, targets: &Targets) -> Outcome<Self> {
        let pixels = targets.extent.iter().map(|&e| u64::from(e)).product::<u64>();
        let mut copy = |image: &Arc<Image>| -> Outcome<Arc<Buffer>> {
            // All three have four bytes a pixel.
            let info = BufferInfo::host_mem(pixels * 4, vk::BufferUsageFlags::TRANSFER_DST);
            let buffer = Arc::new(Buffer::create(&gpu.device, info)?);
            let (from, to) = (graph.bind_resource(image), graph.bind_resource(&buffer));
            graph.copy_image_to_buffer(from, to);
            // A fence alone does not make writes visible to the processor.
            graph.begin_cmd().resource_access(to, AccessType::HostRead).record_cmd(|_| {});
            Ok(buffer)
        };
        Ok(Self {
            visibility: copy(&targets.visibility)?,
            depth: copy(&targets.depth)?,
            picture: copy(&targets.picture)?,
        })
    }

    /// Visible fractions, row by row; the frame must be done.
    pub fn visibility(&self) -> Vec<f32> {
        bytemuck::pod_collect_to_vec(self.visibility.mapped_slice())
    }

    /// Depth as the G-buffer holds it, row by row; the frame must be done.
    pub fn depth(&self) -> Vec<f32> {
        bytemuck::pod_collect_to_vec(self.depth.mapped_slice())
    }

    /// Red, green, blue and alpha, row by row; the frame must be done.
    pub fn picture(&self) -> &[u8] {
        self.picture.mapped_slice()
    }
}
