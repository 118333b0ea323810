//! A host around a node, for tests of what fails: memory that can be refused, and a scene to be shadowed.

// A host is borrowed through the unsafe door; its block says why it may.
#![allow(unsafe_code)]

use crate::measure::settings;
use antumbra::gpu::{MemoryBlock, MemoryRequest};
use antumbra::graph::Scope;
use antumbra::scene::{Scene, generate};
use antumbra::{
    Allocator, Description, Error, Frame, FramePlan, Host, ShadowNode, Slot, Visibility,
};
use antumbra_harness::{HeadlessDevice, ImageSource, Stage, View, read_image};
use ash::vk;

/// Settings as words, and what else a description has.
pub type Described<'a> = (&'a str, fn(&mut Description));

/// Each technique on a map of 16², and each way through one that has passes or resources of its own; but for blending
/// 32-bit floats, which not every device does.
pub const SMALLEST: [&str; 12] = [
    "technique=hard map=16",
    "technique=pcss map=16",
    "technique=back-projection map=16",
    "technique=many-lights map=16 samples=3",
    "map=16",
    "map=16 receivers=map receiver_map=16 sides=two",
    "map=16 receivers=map receiver_map=16 accumulate=blend-fp16 sides=one",
    "technique=ray-march map=16 rays=4",
    "technique=ray-march map=16 rays=4 layers=4 filter=off levels=mip",
    "technique=occlusion-textures map=16",
    "technique=occlusion-textures map=16 slices=8 prefilter=n-buffer combine=product",
    "technique=linear-light map=16 samples=2 lines=1",
];

/// The G-buffer's size.
pub const EXTENT: [u32; 2] = [24, 16];
/// What a node is resized to.
pub const OTHER_EXTENT: [u32; 2] = [16, 40];

/// Memory of a device's, from which the nth piece cannot be had.
pub struct Memory<'a> {
    device: &'a HeadlessDevice,
    /// Pieces asked for since `fail_at` was set.
    pub asked: usize,
    fail_at: Option<usize>,
    /// Pieces that were handed out and have not come back.
    pub out: usize,
    /// What the last piece that was refused was for.
    pub refused: Option<String>,
}

impl<'a> Memory<'a> {
    /// All of it.
    pub fn new(device: &'a HeadlessDevice) -> Self {
        Self { device, asked: 0, fail_at: None, out: 0, refused: None }
    }

    /// Refuses the nth piece from now on, counted from 0, or none.
    pub fn fail_at(&mut self, nth: Option<usize>) {
        (self.asked, self.fail_at, self.refused) = (0, nth, None);
    }
}

impl Allocator for Memory<'_> {
    fn allocate(&mut self, request: &MemoryRequest) -> Result<MemoryBlock, Error> {
        let nth = self.asked;
        self.asked += 1;
        if self.fail_at == Some(nth) {
            self.refused = Some(request.name.into());
            return Err(Error::Memory {
                resource: request.name.into(),
                bytes: request.requirements.size,
                problem: "the test has none left".into(),
            });
        }
        let block = Allocator::allocate(&mut *self.device.allocator().lock().unwrap(), request)?;
        self.out += 1;
        Ok(block)
    }

    fn free(&mut self, block: MemoryBlock) {
        self.out -= 1;
        Allocator::free(&mut *self.device.allocator().lock().unwrap(), block);
    }
}

/// What a node needs around it: a G-buffer of a card over a ground, and the card's buffers.
pub struct Bench {
    /// Its own node is the cheapest there is, and looks on.
    pub stage: Stage,
    /// What the stage shows.
    pub scene: Scene,
    view: View,
}

impl Bench {
    /// Uploads and paints the scene.
    ///
    /// # Errors
    /// As [`Stage::new`].
    pub fn new(device: &HeadlessDevice) -> Result<Self, Error> {
        let scene = generate::card(generate::square_light(0.4)?);
        let view = View::map_of_ground(1.5, 8.0);
        let words = "technique=hard map=16";
        let stage = Stage::new(device, &scene, &view, EXTENT, settings(words), |_| true)?;
        Ok(Self { stage, scene, view })
    }

    /// A description that fits the G-buffer.
    pub fn description(words: &str, change: fn(&mut Description)) -> Description {
        let mut description = Description {
            technique: settings(words),
            frames_in_flight: 1,
            mask_format: Some(vk::Format::R8_UNORM),
            ..Description::new(EXTENT)
        };
        change(&mut description);
        description
    }

    /// The plan of a frame, where this description needs nothing lent but a G-buffer.
    ///
    /// # Panics
    /// If the frame fails.
    pub fn plan(&self, node: &ShadowNode) -> Option<FramePlan> {
        self.plan_as(node, |_| {})
    }

    /// As [`Self::plan`], of a frame that `change` has changed.
    ///
    /// # Panics
    /// If the frame fails.
    pub fn plan_as(&self, node: &ShadowNode, change: impl FnOnce(&mut Frame)) -> Option<FramePlan> {
        if node.description().light_texture.is_some() {
            return None;
        }
        let gbuffer = self.stage.gbuffer();
        let light = self.scene.lights[0].light;
        let world_from_ndc = self.view.clip_from_world.inverse();
        let (instances, depth) = (self.stage.instances(), gbuffer.depth_for_node());
        let own = Frame::new(Slot(0), light, world_from_ndc, instances, depth);
        let (before, after) = (Scope::COPIED_FROM, Scope::COPIED_FROM);
        let visibility = Visibility::Own { before, after };
        let mask = Some(gbuffer.mask_for_node());
        let mut frame = Frame { background: Some(0.0), mask, visibility, ..own };
        change(&mut frame);
        Some(node.plan(&frame).unwrap())
    }

    /// The bits of what a plan writes.
    ///
    /// # Panics
    /// If the frame fails.
    pub fn run(&self, device: &HeadlessDevice, node: &ShadowNode, plan: &FramePlan) -> Vec<u32> {
        device.submit_and_wait(|cmd| node.record(cmd, plan)).unwrap();
        let format = vk::Format::R32_SFLOAT;
        let result = node.visibility().unwrap();
        let source = ImageSource { image: result.image, format, extent: result.extent, layer: 0 };
        let read: Vec<f32> = read_image(device, &source, Scope::COPIED_FROM.layout).unwrap();
        assert!(read.iter().any(|v| *v < 1.0), "nothing is shadowed");
        read.iter().map(|v| v.to_bits()).collect()
    }

    /// The bits of a frame.
    ///
    /// # Panics
    /// If the frame fails.
    pub fn bits(&self, device: &HeadlessDevice, node: &ShadowNode) -> Option<Vec<u32>> {
        self.plan(node).map(|plan| self.run(device, node, &plan))
    }
}

/// A host with the device's cache; its nodes share their layouts where `shared`.
pub fn host(device: &HeadlessDevice, shared: bool) -> Host {
    // SAFETY: every test keeps its device longer than its nodes, lends what its stage keeps, and waits
    // for each frame.
    unsafe {
        if shared {
            return device.host();
        }
        Host::borrow(
            device.instance().clone(),
            device.physical_device(),
            device.device().clone(),
            device.queue_family(),
        )
    }
    .with_pipeline_cache(device.pipeline_cache())
}
