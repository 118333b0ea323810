//! The figure walks for sixty frames: its vertices are those of a sum in 64 bits, no shadow is that of an earlier pose, the
//! shadows err as those of the figure at rest do, and nothing is allocated on the way.

#![allow(clippy::unwrap_used, reason = "a test says what went wrong by panicking")]

mod counted;
mod error;
mod raster;
mod vertices;

use super::*;
use crate::frames::bytes_of;
use crate::resources::Buffer;
use crate::skin::Stands;
use crate::world::Object;
use allocation_counter::measure;
use antumbra::frame::ImageBarrier;
use antumbra::lent::MeshBounds;
use antumbra::scene::Mesh;
use gpu_allocator::MemoryLocation;

const SIZE: [u32; 2] = [160, 120];

/// The frames of the walk.
const FRAMES: usize = 60;

/// The time of a frame: the figure stands still for four frames on its way.
fn seconds(frame: usize) -> f64 {
    let moving = if frame < 20 { frame } else { 20.max(frame - 4) };
    moving as f64 / 12.0
}

/// The pixels of a frame.
#[derive(Clone, PartialEq)]
struct Shown {
    depth: Vec<f32>,
    visibility: Vec<f32>,
}

/// An engine that draws a world without composing it, two frames in flight.
struct Engine {
    gpu: Gpu,
    posing: PosingPass,
    pass: GBufferPass,
    gbuffer: GBuffer,
    frames: Frames,
    models: Vec<Model>,
    shadows: Shadows,
    world: World,
    number: u64,
    /// Passes of the node in each frame, and how often posing, planning and recording it allocated.
    passes: Vec<usize>,
    allocations: Vec<u64>,
}

fn opened() -> Gpu {
    Gpu::new(std::env::var("ANTUMBRA_VALIDATE").is_ok_and(|value| value == "1")).unwrap()
}

/// The world of the walk, whose figure stands in another way.
fn walk_with(stands: Stands) -> World {
    let mut world = World::walk().unwrap();
    world.objects.last_mut().unwrap().skin.as_mut().unwrap().stands = stands;
    world
}

impl Engine {
    fn new(world: World, technique: &str) -> Self {
        Self::on(opened(), world, technique)
    }

    fn on(mut gpu: Gpu, mut world: World, technique: &str) -> Self {
        let posing = PosingPass::new(&gpu).unwrap();
        let pass = GBufferPass::new(&gpu).unwrap();
        let gbuffer = pass.images(&mut gpu, SIZE).unwrap();
        let frames = Frames::new(&gpu).unwrap();
        let objects = std::mem::take(&mut world.objects).into_iter();
        let models = objects.map(|o| Model::new(&mut gpu, &posing, o).unwrap()).collect();
        let technique = technique.parse().unwrap();
        let shadows = Shadows::new(&mut gpu, SIZE, technique, BorderBarriers::Node).unwrap();
        let (passes, allocations) = (Vec::new(), Vec::new());
        Self {
            gpu,
            posing,
            pass,
            gbuffer,
            frames,
            models,
            shadows,
            world,
            number: 0,
            passes,
            allocations,
        }
    }

    /// Submits a frame, and gives the pixels of the one before last.
    fn frame(&mut self, seconds: f64) -> Option<Shown> {
        self.frame_as(seconds, |revision| revision)
    }

    /// A frame whose revision the engine may lie about.
    fn frame_as(
        &mut self,
        seconds: f64,
        revision: impl Fn(Option<u64>) -> Option<u64>,
    ) -> Option<Shown> {
        let slot = (self.number % FRAMES_IN_FLIGHT as u64) as usize;
        let before = self.wait(slot);
        let light = self.world.light(seconds, false).unwrap();
        let clip_from_world = self.world.clip_from_world(SIZE);
        let cmd = self.frames.begin(&mut self.gpu, slot, SIZE, 2).unwrap();
        let visibility = self.shadows.node.visibility().unwrap().image;
        let color = vk::ImageAspectFlags::COLOR;
        let (gpu, first) = (&self.gpu, self.number == 0);
        let taken = measure(|| {
            self.models.iter_mut().try_for_each(|model| model.pose(slot, seconds)).unwrap();
            let revision = revision(self.world.revision(&self.models));
            let seen = Seen {
                light: &light,
                clip_from_world: &clip_from_world,
                models: &self.models,
                gbuffer: &self.gbuffer,
                seconds,
                slot,
                revision,
            };
            self.shadows.plan(&seen).unwrap();
            self.posing.record(gpu, cmd, slot, &self.models);
            self.pass.record(gpu, cmd, &seen);
            let (before, after) = (COPY_READS, COMPOSE_READS);
            if !first {
                let back =
                    ImageBarrier { image: visibility, layer: 0, aspect: color, before, after };
                gpu.place(cmd, &back);
            }
            self.shadows.record(gpu, cmd, &seen).unwrap();
        });
        self.allocations.push(taken.count_total);
        let passes = self.shadows.planned().unwrap().plan().steps.len();
        self.passes.push(passes);
        let out = [(visibility, color), (self.gbuffer.depth.raw, vk::ImageAspectFlags::DEPTH)];
        for (image, aspect) in out {
            let (before, after) = (COMPOSE_READS, COPY_READS);
            gpu.place(cmd, &ImageBarrier { image, layer: 0, aspect, before, after });
        }
        let (plan, record) = Default::default();
        let notes = FrameNotes { number: self.number, extent: SIZE, plan, record, passes };
        self.frames.submit(gpu, slot, &out, notes).unwrap();
        self.number += 1;
        before
    }

    /// The pixels of the last frame of a slot, once it is done.
    fn wait(&mut self, slot: usize) -> Option<Shown> {
        let notes = self.frames.wait(&self.gpu, slot).unwrap()?;
        let copy = |number| self.frames.copy(slot, &notes, number).unwrap();
        let [visibility, depth] = [0, 1].map(|number| bytemuck::pod_collect_to_vec(copy(number)));
        assert_eq!(copy(0).len(), bytes_of(SIZE));
        Some(Shown { depth, visibility })
    }

    /// The pixels of the frames in flight, the oldest first.
    fn rest(&mut self) -> Vec<Shown> {
        let slots = [self.number, self.number + 1].map(|n| (n % FRAMES_IN_FLIGHT as u64) as usize);
        slots.into_iter().filter_map(|slot| self.wait(slot)).collect()
    }

    /// The pixels of a number of frames.
    fn frames(&mut self, times: impl Iterator<Item = f64>) -> Vec<Shown> {
        let mut shown: Vec<_> = times.filter_map(|seconds| self.frame(seconds)).collect();
        shown.extend(self.rest());
        shown
    }

    /// The pixels of one frame.
    fn one(&mut self, seconds: f64) -> Shown {
        self.frames([seconds].into_iter()).remove(0)
    }

    /// The vertices of the last model as the device has posed them, position and normal; no frame may be in flight.
    fn vertices(&mut self) -> Vec<[f32; 6]> {
        let model = self.models.last().unwrap();
        let (posed, bytes) = (model.vertices.raw, 24 * model.object.mesh.positions.len());
        let (usage, location) = (vk::BufferUsageFlags::TRANSFER_DST, MemoryLocation::GpuToCpu);
        let copy = Buffer::new(&mut self.gpu, "copy", bytes as u64, usage, location).unwrap();
        let device = &self.gpu.device;
        let create = vk::CommandPoolCreateInfo::default().queue_family_index(self.gpu.queue_family);
        let written = [vk::MemoryBarrier::default()
            .src_access_mask(vk::AccessFlags::SHADER_WRITE)
            .dst_access_mask(vk::AccessFlags::TRANSFER_READ)];
        let to_host = [vk::MemoryBarrier::default()
            .src_access_mask(vk::AccessFlags::TRANSFER_WRITE)
            .dst_access_mask(vk::AccessFlags::HOST_READ)];
        let (none, copied) = (vk::DependencyFlags::empty(), vk::PipelineStageFlags::TRANSFER);
        let posing = vk::PipelineStageFlags::COMPUTE_SHADER;
        let host = vk::PipelineStageFlags::HOST;
        // SAFETY: the commands are waited for before anything that they use is destroyed.
        unsafe {
            let pool = device.create_command_pool(&create, None).unwrap();
            let allocate =
                vk::CommandBufferAllocateInfo::default().command_pool(pool).command_buffer_count(1);
            let cmds = device.allocate_command_buffers(&allocate).unwrap();
            device.begin_command_buffer(cmds[0], &Default::default()).unwrap();
            device.cmd_pipeline_barrier(cmds[0], posing, copied, none, &written, &[], &[]);
            let region = [vk::BufferCopy::default().size(bytes as u64)];
            device.cmd_copy_buffer(cmds[0], posed, copy.raw, &region);
            device.cmd_pipeline_barrier(cmds[0], copied, host, none, &to_host, &[], &[]);
            device.end_command_buffer(cmds[0]).unwrap();
            let submit = [vk::SubmitInfo::default().command_buffers(&cmds)];
            device.queue_submit(self.gpu.queue, &submit, vk::Fence::null()).unwrap();
            device.queue_wait_idle(self.gpu.queue).unwrap();
            device.destroy_command_pool(pool, None);
        }
        let vertices = bytemuck::pod_collect_to_vec(&copy.read().unwrap()[..bytes]);
        copy.destroy(&mut self.gpu);
        vertices
    }

    /// Another engine on the device of this one, whose compiled pipelines it finds.
    fn again(self, world: World, technique: &str) -> Self {
        Self::on(self.close(), world, technique)
    }

    /// Destroys everything but the device; no memory may be left over.
    fn close(mut self) -> Gpu {
        self.rest();
        self.shadows.destroy(&mut self.gpu);
        self.models.into_iter().for_each(|model| model.destroy(&mut self.gpu));
        self.frames.destroy(&mut self.gpu);
        self.gbuffer.destroy(&mut self.gpu);
        self.pass.destroy(&self.gpu);
        self.posing.destroy(&self.gpu);
        let bytes = self.gpu.allocator.generate_report().total_allocated_bytes;
        assert_eq!(bytes, 0, "bytes that nobody gave back");
        self.gpu
    }

    /// Destroys everything; the layer may have said nothing.
    fn finish(self) {
        self.close().destroy();
        assert_eq!(device::messages(), 0);
    }
}

/// Vertices, position and normal, and the box that the node is given.
type Posed = (Vec<[f32; 6]>, MeshBounds);

/// The figure as an engine poses it at some times: its vertices, and the box that the node is given.
fn posed(stands: Option<Stands>, times: &[f64]) -> (Engine, Vec<Posed>) {
    let world = stands.map_or_else(|| World::walk().unwrap(), walk_with);
    let mut engine = Engine::new(world, "hard");
    let posed = times
        .iter()
        .map(|&seconds| {
            engine.one(seconds);
            (engine.vertices(), engine.models.last().unwrap().bounds)
        })
        .collect();
    (engine, posed)
}

/// The walk's world with a figure of these vertices, which stay.
fn still_world(vertices: &[[f32; 6]]) -> World {
    let mut world = World::walk().unwrap();
    let figure = world.objects.pop().unwrap();
    let mesh = Mesh {
        positions: vertices.iter().map(|&[x, y, z, ..]| [x, y, z]).collect(),
        normals: vertices.iter().map(|&[.., x, y, z]| [x, y, z]).collect(),
        ..figure.mesh
    };
    world.objects.push(Object { mesh, skin: None, ..figure });
    world
}

/// The pixels that a new engine with a new node, on the device of another, shows of these vertices, uploaded as they are and
/// never posed.
fn fresh(engine: Engine, (vertices, bounds): &Posed, technique: &str) -> (Engine, Shown) {
    let mut engine = engine.again(still_world(vertices), technique);
    // The same box: the node fits its maps to it.
    engine.models.last_mut().unwrap().bounds = *bounds;
    let shown = engine.one(0.0);
    (engine, shown)
}

/// Frames at the walk's begin and end, within the halt and right behind it. Each takes a node more of each technique.
const LOOKED_AT: [usize; 4] = [1, 22, 25, 59];

/// With two frames in flight and maps, images and hierarchies that the node keeps from frame to frame, every bit is that of
/// a node which has seen nothing before: nothing is drawn of an earlier pose. Techniques with maps keep these by the
/// revision, and `traced` its hierarchy by the buffers.
#[test]
fn no_shadow_is_stale() {
    let (mut engine, posed) = posed(None, &LOOKED_AT.map(seconds));
    for technique in ["soft-shadow-map", "pcss", "occlusion-textures", "ray-march", "traced"] {
        engine = engine.again(World::walk().unwrap(), technique);
        let shown = engine.frames((0..FRAMES).map(seconds));
        assert_eq!(shown.len(), FRAMES);
        let passes = std::mem::take(&mut engine.passes);
        for (frame, posed) in LOOKED_AT.into_iter().zip(&posed) {
            let fresh;
            (engine, fresh) = self::fresh(engine, posed, technique);
            let differ = |a: &[f32], b: &[f32]| {
                a.iter().zip(b).filter(|(a, b)| a.to_bits() != b.to_bits()).count()
            };
            let depths = differ(&shown[frame].depth, &fresh.depth);
            let pixels = differ(&shown[frame].visibility, &fresh.visibility);
            assert_eq!([depths, pixels], [0, 0], "{technique}, frame {frame}");
            assert!(fresh.visibility.iter().any(|v| *v < 0.5), "{technique}: no shadow");
        }
        // What could have been stale: the shadow moves from frame to frame, but for the halt, in which passes are left out.
        for frame in 1..FRAMES {
            let halted = seconds(frame) == seconds(frame - 1);
            let same = shown[frame].visibility == shown[frame - 1].visibility;
            assert_eq!(same, halted, "{technique}, frame {frame}");
        }
        let [moving, halted] = [&passes[1..=20], &passes[21..=24]];
        println!("{technique}: {moving:?} passes on the way, {halted:?} at the halt");
        assert!(halted.iter().max() < moving.iter().min(), "{technique}: nothing is reused");
    }
    engine.finish();
}

/// An engine whose revision stays the same though the figure walks on gets the shadow of an earlier pose, and the
/// comparison notices.
#[test]
fn a_revision_that_stays_is_noticed() {
    let (engine, posed) = posed(None, &[seconds(12)]);
    let mut engine = engine.again(World::walk().unwrap(), "soft-shadow-map");
    engine.frame_as(seconds(0), |_| Some(1));
    engine.frame_as(seconds(12), |_| Some(1));
    let stale = engine.rest().pop().unwrap();
    let (engine, fresh) = fresh(engine, &posed[0], "soft-shadow-map");
    assert!(stale.depth == fresh.depth, "the G-buffer is drawn in each frame");
    let differ = stale.visibility.iter().zip(&fresh.visibility).filter(|(a, b)| a != b).count();
    println!("{differ} pixels have the shadow of another pose");
    assert!(differ > 100);
    engine.finish();
}
