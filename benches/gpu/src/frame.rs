//! A default frame at 1920×1080, planned and not run: how many waves each of its passes launches, and the bytes that it reads
//! and writes.

use antumbra::frame::{Limits, plan};
use antumbra::graph::{Access, Graph, Pass, Shape, Work};
use antumbra::scene::{Role, Scene};
use antumbra::shaders::Module;
use antumbra::{Description, Frame, FramePlan, Geometry, HostImage, MeshBuffers, MeshInstance};
use antumbra::{Scope, Slot, Technique};
use antumbra_harness::{View, bytes_per_texel};
use ash::vk::{self, Handle};
use glam::DMat4;

/// The frame's size.
pub const EXTENT: [u32; 2] = [1920, 1080];

/// The techniques of the table, at their defaults.
pub const TECHNIQUES: [&str; 9] = [
    "hard",
    "pcss",
    "back-projection",
    "many-lights",
    "soft-shadow-map",
    "ray-march",
    "occlusion-textures",
    "linear-light",
    "traced",
];

/// The work of a pass of the frame.
#[derive(Clone, Debug, PartialEq)]
pub enum Launch {
    /// As many invocations in each of the steps, the fewest and the most.
    Waves {
        /// The fewest waves of 64 that a step launches.
        least: u64,
        /// The most.
        most: u64,
    },
    /// As many as a list holds, which the device fills.
    Listed,
    /// As many as the meshes have triangles or texels.
    Meshes,
    /// A draw.
    Draw,
    /// A write by a command.
    Command,
}

/// All steps of one kind of pass.
#[derive(Clone, Debug, PartialEq)]
pub struct FramePass {
    /// The pass's name.
    pub name: &'static str,
    /// Its compute shader.
    pub shader: Option<&'static str>,
    /// How often it runs.
    pub times: usize,
    /// What it launches.
    pub launch: Launch,
    /// Bytes of what it reads, each resource once a step; an array image of which a step sees a layer once.
    pub read: u64,
    /// Bytes of what it writes.
    pub written: u64,
    /// The words that an invocation reads where all work is one workgroup's, shared evenly: those of the worst step.
    pub serial_words: Option<u64>,
}

/// The passes of a default frame of a technique over a scene, whose meshes block and receive.
///
/// # Errors
/// What planning refuses.
pub fn frame_of(name: &str, scene: &Scene) -> Result<Vec<FramePass>, antumbra::Error> {
    let technique: Technique = name.parse()?;
    let triangles = scene.triangles() as u32;
    let capacity = antumbra::frame::Capacity { triangles, ..Default::default() };
    let description = Description { technique, capacity, ..Description::new(EXTENT) };
    let planned = planned(&description, scene)?;
    let graph = &planned.plan().graph;
    let mut passes: Vec<FramePass> = Vec::new();
    for step in &planned.plan().steps {
        let pass = &graph.passes()[step.pass];
        let launch = launch_of(pass);
        let again = passes.iter_mut().find(|known| known.name == pass.name);
        let read = bytes(graph, pass, again.is_none(), Access::reads);
        let written = bytes(graph, pass, again.is_none(), Access::writes);
        let serial_words = match pass.work {
            Work::Dispatch { shader, groups: [1, 1, 1] } => Some(read / 4 / invocations(shader)),
            _ => None,
        };
        match again {
            Some(known) => {
                known.times += 1;
                known.launch = with(&known.launch, &launch);
                known.read += read;
                known.written += written;
                known.serial_words = known.serial_words.max(serial_words);
            }
            None => passes.push(FramePass {
                name: pass.name,
                shader: pass.work.compute_shader().map(|module| module.path),
                times: 1,
                launch,
                read,
                written,
                serial_words,
            }),
        }
    }
    Ok(passes)
}

/// The plan of a frame with a scene's meshes, in buffers that need not be there.
fn planned(description: &Description, scene: &Scene) -> Result<FramePlan, antumbra::Error> {
    let light = scene.light(None)?.light;
    let mut buffer = 1;
    let mut handle = || {
        buffer += 1;
        vk::Buffer::from_raw(buffer)
    };
    let meshes: Vec<MeshInstance> = scene
        .instances
        .iter()
        .map(|instance| {
            let mesh = &scene.meshes[instance.mesh];
            let buffers = MeshBuffers::indexed(handle(), 12, handle(), mesh.indices.len() as u32);
            let geometry = Geometry::Buffers(buffers);
            let place = instance.world_from_mesh;
            MeshInstance::new(geometry, place, mesh.bounds(), Role::Both)
        })
        .collect();
    let camera = scene.camera.ok_or_else(|| antumbra::Error::Frame("no camera".into()))?;
    let world_from_clip: DMat4 = View::of(&camera, EXTENT).clip_from_world.inverse();
    let usage = vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT | vk::ImageUsageFlags::SAMPLED;
    let depth = HostImage::new(
        (vk::Image::from_raw(1), vk::ImageView::from_raw(1)),
        description.depth_format,
        EXTENT,
        usage,
        Scope::DEPTH_DRAWN,
        Scope::FRAGMENT_SAMPLED,
    );
    let frame = Frame::new(Slot(0), light, world_from_clip, &meshes, depth);
    plan(description, Limits::default(), &frame)
}

fn launch_of(pass: &Pass) -> Launch {
    match pass.work {
        Work::Dispatch { shader, groups } => {
            let groups = groups.iter().map(|&n| u64::from(n)).product::<u64>();
            let waves = groups * invocations(shader).div_ceil(64);
            Launch::Waves { least: waves, most: waves }
        }
        Work::Indirect { .. } => Launch::Listed,
        Work::EachMesh { .. } | Work::EachCutOut { .. } => Launch::Meshes,
        Work::Raster { .. } => Launch::Draw,
        Work::Constants { .. } | Work::FrameNumber | Work::CutOuts => Launch::Command,
    }
}

/// What two steps of a kind launch.
fn with(a: &Launch, b: &Launch) -> Launch {
    match (a, b) {
        (&Launch::Waves { least, most }, &Launch::Waves { least: l, most: m }) => {
            Launch::Waves { least: least.min(l), most: most.max(m) }
        }
        _ => a.clone(),
    }
}

/// The invocations of a workgroup, as the module's execution mode `LocalSize` has them.
fn invocations(module: Module) -> u64 {
    const EXECUTION_MODE: u32 = 16;
    const LOCAL_SIZE: u32 = 17;
    let words = module.words();
    let mut at = 5;
    while at < words.len() {
        let (operation, length) = (words[at] & 0xffff, (words[at] >> 16).max(1) as usize);
        if operation == EXECUTION_MODE && words.get(at + 2) == Some(&LOCAL_SIZE) {
            return words[at + 3..at + 6].iter().map(|&n| u64::from(n)).product();
        }
        at += length;
    }
    1
}

/// The bytes of the resources that a pass accesses in a way; `first` for its first step, which has the arrays.
fn bytes(graph: &Graph, pass: &Pass, first: bool, which: impl Fn(Access) -> bool) -> u64 {
    let of = |shape| match shape {
        Shape::Image { layers: Some(_), .. } if !first => 0,
        Shape::Image { format, width, height, layers } => {
            let texels = u64::from(width) * u64::from(height) * u64::from(layers.unwrap_or(1));
            texels * u64::from(bytes_per_texel(format).unwrap_or(4))
        }
        Shape::Buffer { bytes } => bytes,
    };
    let uses = pass.uses.iter().filter(|u| which(u.access));
    uses.map(|u| match u.access {
        Access::Indirect => 16,
        _ => of(graph.resource(u.resource).shape),
    })
    .sum()
}
