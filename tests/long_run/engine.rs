//! A small engine whose world changes all the time.

use antumbra::scene::{Role, Scene};
use antumbra::{Description, FramePlan, MeshInstance, RetireQueue, Technique};
use antumbra::{LightIndex, Slot, TechniqueIndex};
use antumbra_harness::{
    GBuffer, GBufferPainter, HeadlessDevice, SceneBuffers, Stage, Submitted, View,
};
use antumbra_tests::measure::settings;
use antumbra_tests::random::{Case, Lamp, case, meshes};
use antumbra_tests::rig::Random;
use glam::DVec3;
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use std::collections::VecDeque;

/// Each node is of one of these: its lights, frames in flight and settings.
const NODES: &[(u32, u32, &[&str])] = &[
    (2, 2, &["map=32", "technique=hard map=32"]),
    (1, 3, &["technique=ray-march map=16 rays=4"]),
    (
        3,
        2,
        &["technique=pcss map=16", "receivers=map map=16 receiver_map=16", "technique=hard map=16"],
    ),
    (1, 2, &["technique=occlusion-textures map=16 slices=8"]),
    (2, 3, &["technique=back-projection map=24", "technique=many-lights map=16 samples=2"]),
    (1, 3, &["technique=linear-light map=16 samples=2 lines=1", "technique=hard map=16"]),
    (
        2,
        2,
        &["receivers=map accumulate=blend sides=two map=16 receiver_map=16", "sides=one map=17"],
    ),
    (1, 1, &["technique=ray-march map=17 levels=mip layers=2 projection=centre filter=off"]),
];

/// G-buffers' sizes; the first is home.
const SIZES: &[[u32; 2]] = &[[16, 16], [24, 8], [9, 31], [1, 1], [32, 32]];

/// So many frames share a scene, a size, and a node.
const SCENE: u64 = 7;
const SIZE: u64 = 23;
const NODE: u64 = 200;

/// How often an image is read, and held between 0 and 1.
const READ: u64 = 5;

/// A frame that was submitted.
struct InFlight {
    number: u64,
    submitted: Submitted,
}

pub struct Engine<'d> {
    device: &'d HeadlessDevice,
    stage: Stage,
    painter: GBufferPainter,
    scene: Scene,
    buffers: SceneBuffers,
    gbuffer: GBuffer,
    /// Those that frames in flight may still read.
    old_gbuffers: Vec<GBuffer>,
    retired: RetireQueue,
    in_flight: VecDeque<InFlight>,
    cases: Cases,
    random: Random,
    case: Case,
    instances: Vec<MeshInstance>,
    /// The lights, which of the settings each has, and the host's number for it.
    lamps: Vec<(Lamp, u32, u64)>,
    /// The host's number for what pixels show.
    view: u64,
    revisions: u64,
    node: usize,
    frames: u64,
    passes: u64,
    idle: u64,
    resizes: u64,
    nodes: u64,
    images: u64,
    compared: u64,
}

/// Scenes drawn one after the other.
struct Cases {
    runner: TestRunner,
    strategy: proptest::strategy::BoxedStrategy<Case>,
}

impl Cases {
    fn next(&mut self) -> Case {
        self.strategy.new_tree(&mut self.runner).unwrap().current()
    }
}

fn description(node: usize, extent: [u32; 2], plain: &Description) -> Description {
    let (lights, frames_in_flight, words) = NODES[node];
    let all: Vec<Technique> = words.iter().map(|w| settings(w)).collect();
    Description {
        extent,
        lights,
        frames_in_flight,
        technique: all[0],
        other_techniques: all[1..].to_vec(),
        ..plain.clone()
    }
}

impl<'d> Engine<'d> {
    pub fn new(device: &'d HeadlessDevice, seed: u64) -> Self {
        let random = TestRng::from_seed(RngAlgorithm::ChaCha, &[seed as u8; 32]);
        let runner = TestRunner::new_with_rng(Config::default(), random);
        let mut cases = Cases { runner, strategy: case(6).boxed() };
        let case = cases.next();
        let scene = Scene { meshes: meshes(), ..Scene::default() };
        let buffers = SceneBuffers::new(device, &scene).unwrap();
        let view = View { clip_from_world: case.clip_from_world };
        let stage =
            Stage::new(device, &scene, &view, SIZES[0], settings("map=16"), |_| false).unwrap();
        let mut new = Self {
            device,
            stage,
            painter: GBufferPainter::new(device).unwrap(),
            gbuffer: GBuffer::new(device, SIZES[0]).unwrap(),
            scene,
            buffers,
            old_gbuffers: Vec::new(),
            retired: RetireQueue::default(),
            in_flight: VecDeque::new(),
            cases,
            random: Random(seed),
            instances: Vec::new(),
            lamps: Vec::new(),
            case,
            view: 0,
            revisions: 0,
            node: 0,
            frames: 0,
            passes: 0,
            idle: 0,
            resizes: 0,
            nodes: 0,
            images: 0,
            compared: 0,
        };
        new.set_node(0);
        new.set_scene();
        new
    }

    /// One frame of all its lights, behind whatever has changed since the last.
    pub fn frame(&mut self) {
        self.frames += 1;
        if self.frames.is_multiple_of(NODE) {
            // In turn, so that a driver has seen all of them before the second lap ends.
            self.set_node((self.frames / NODE) as usize % NODES.len());
        }
        if self.frames.is_multiple_of(SIZE) {
            let size = SIZES[self.random.below(SIZES.len())];
            self.set_size(size);
        }
        if self.frames.is_multiple_of(SCENE) {
            self.case = self.cases.next();
            self.set_scene();
        }
        // Every third frame moves a light.
        if self.random.unit() < 0.33 {
            let light = self.random.below(self.lamps.len());
            self.set_lamp(light);
        }
        self.submit();
        if self.frames.is_multiple_of(READ) {
            self.images();
        }
    }

    fn next_revision(&mut self) -> u64 {
        self.revisions += 1;
        self.revisions
    }

    /// Other settings, lights and frames in flight: the node is made anew, and the old one retired.
    fn set_node(&mut self, node: usize) {
        self.node = node;
        self.nodes += 1;
        let extent = self.gbuffer.depth.extent();
        let stage_node = self.stage.node().unwrap();
        let description = description(node, extent, stage_node.description());
        let mut allocator = self.device.allocator().lock().unwrap();
        let retired = stage_node.reconfigure(&mut *allocator, description).unwrap();
        self.retired.push(self.frames, retired);
        drop(allocator);
        self.set_lamps();
    }

    /// Another size: the node's images that depend on it, and the G-buffer.
    fn set_size(&mut self, extent: [u32; 2]) {
        self.resizes += 1;
        let mut allocator = self.device.allocator().lock().unwrap();
        let retired = self.stage.node().unwrap().resize(&mut *allocator, extent).unwrap();
        self.retired.push(self.frames, retired);
        drop(allocator);
        let gbuffer = GBuffer::new(self.device, extent).unwrap();
        self.old_gbuffers.push(std::mem::replace(&mut self.gbuffer, gbuffer));
        self.paint();
    }

    /// Another scene, and lights in it.
    fn set_scene(&mut self) {
        self.scene.instances = self.case.instances();
        self.instances = self.buffers.instances(&self.scene);
        self.paint();
        self.set_lamps();
    }

    /// What the pixels show is painted once nobody looks at it.
    fn paint(&mut self) {
        self.drain();
        let Self { painter, gbuffer, scene, buffers, case, .. } = self;
        painter.paint(gbuffer, scene, buffers, &case.view(), |i| i.role != Role::Occluder).unwrap();
        self.view = self.next_revision();
    }

    fn set_lamps(&mut self) {
        self.lamps = vec![(self.case.lamp, 0, 0); NODES[self.node].0 as usize];
        (0..self.lamps.len()).for_each(|light| self.set_lamp(light));
    }

    /// A light elsewhere, of another size, with other settings.
    fn set_lamp(&mut self, light: usize) {
        let words = NODES[self.node].2;
        let mut chosen = self.random.below(words.len());
        let [x, y, z] = [(); 3].map(|()| self.random.unit() - 0.5);
        let mut lamp = self.case.lamp.moved(DVec3::new(x, y, z));
        let share = 0.5 + self.random.unit();
        lamp.half_u *= share;
        if lamp.line {
            let takes =
                |w: &&str| ["hard", "many-lights", "linear-light"].iter().any(|t| w.contains(t));
            match words.iter().position(takes) {
                Some(place) => chosen = place,
                // An area instead.
                None => {
                    let across = lamp.half_v.cross(lamp.half_u).normalize();
                    (lamp.line, lamp.half_v) = (false, across * 0.01);
                }
            }
        }
        self.lamps[light] = (lamp, chosen as u32, self.next_revision());
    }

    fn plan(&mut self, light: usize, slot: u32, number: [Option<u64>; 2]) -> FramePlan {
        let (lamp, technique_index, _) = self.lamps[light];
        let world_from_ndc = self.case.clip_from_world.inverse();
        let Self { stage, instances, gbuffer, .. } = self;
        let planned = stage.plan_with(lamp.light(), |frame| {
            frame.light_index = LightIndex(light as u32);
            frame.technique_index = TechniqueIndex(technique_index);
            frame.meshes = instances;
            frame.world_from_ndc = world_from_ndc;
            frame.depth = gbuffer.depth_for_node();
            frame.mask = Some(gbuffer.mask_for_node());
            frame.slot = Slot(slot);
            [frame.revision, frame.view_revision] = number;
        });
        planned.unwrap_or_else(|e| panic!("{e}: {lamp:?}"))
    }

    /// Plans every light, records them and submits, once the frame that had the slot before is done.
    fn submit(&mut self) {
        let in_flight = NODES[self.node].1;
        while self.in_flight.len() >= in_flight as usize {
            self.wait_for_one();
        }
        let slot = (self.frames % u64::from(in_flight)) as u32;
        // A host that gives its numbers now and then.
        let numbered = self.random.unit() < 0.8;
        let plans: Vec<_> = (0..self.lamps.len())
            .map(|light| {
                let (scene, view) = (self.lamps[light].2, self.view);
                let numbers = if numbered { [Some(scene), Some(view)] } else { [None, None] };
                self.plan(light, slot, numbers)
            })
            .collect();
        let steps: usize = plans.iter().map(|p| p.plan().steps.len()).sum();
        self.passes += steps as u64;
        self.idle += u64::from(steps == 0);
        let node = self.stage.node().unwrap();
        let record = |cmd| plans.iter().try_for_each(|plan| node.record(cmd, plan));
        let ((), submitted) = self.device.submit(record).unwrap();
        self.in_flight.push_back(InFlight { number: self.frames, submitted });
    }

    fn wait_for_one(&mut self) {
        let Some(InFlight { number, submitted }) = self.in_flight.pop_front() else { return };
        submitted.wait().unwrap();
        let mut allocator = self.device.allocator().lock().unwrap();
        self.retired.done(number, &mut *allocator);
    }

    /// Waits for every frame; then nothing that was retired is in use.
    fn drain(&mut self) {
        while !self.in_flight.is_empty() {
            self.wait_for_one();
        }
        let mut allocator = self.device.allocator().lock().unwrap();
        self.retired.done(self.frames, &mut *allocator);
        // They give their memory back themselves.
        drop(allocator);
        self.old_gbuffers.clear();
    }

    /// The visible fractions under every light, each between 0 and 1.
    fn images(&mut self) -> Vec<Vec<f32>> {
        self.drain();
        let lights = 0..self.lamps.len() as u32;
        let images: Vec<_> =
            lights.map(|l| self.stage.visibility_under(LightIndex(l)).unwrap()).collect();
        for image in &images {
            let bad = image.iter().find(|v| !(0.0..=1.0).contains(*v));
            assert!(bad.is_none(), "{bad:?} in frame {}, {:?}", self.frames, NODES[self.node]);
        }
        self.images += images.len() as u64;
        images
    }

    /// The last frame's bits are those of a node that has seen no other.
    pub fn compare_with_a_fresh_node(&mut self) {
        let images = self.images();
        let extent = self.gbuffer.depth.extent();
        let view = self.case.view();
        let mut fresh =
            Stage::new(self.device, &self.scene, &view, extent, settings("map=16"), |_| false)
                .unwrap();
        fresh
            .configure_with(Technique::default(), |d| *d = description(self.node, extent, d))
            .unwrap();
        std::mem::swap(&mut self.stage, &mut fresh);
        let plans: Vec<_> = (0..images.len()).map(|l| self.plan(l, 0, [None, None])).collect();
        self.stage.run_all(&plans).unwrap();
        let other = self.images();
        std::mem::swap(&mut self.stage, &mut fresh);
        assert!(images == other, "frame {} is not what a fresh node gives", self.frames);
        self.compared += images.len() as u64;
    }

    /// Back to the first node and size, with a frame of theirs and nothing in flight.
    pub fn home(&mut self) {
        self.set_node(0);
        self.set_size(SIZES[0]);
        self.submit();
        self.drain();
    }

    /// The node's objects; blocks and bytes that the device's allocator has given out; and bytes that it holds.
    pub fn held(&mut self) -> (usize, usize, u64, u64) {
        let objects = self.stage.node().unwrap().object_count();
        let report = self.device.allocator().lock().unwrap().generate_report();
        let (allocated, reserved) = (report.total_allocated_bytes, report.total_capacity_bytes);
        (objects, report.allocations.len(), allocated, reserved)
    }

    pub fn report(&self) -> String {
        let Self { frames, passes, idle, nodes, resizes, images, compared, .. } = self;
        format!(
            "{frames} frames, {passes} passes, {idle} frames without any, {nodes} nodes, {resizes} resizes, \
             {images} images between 0 and 1, {compared} compared with a fresh node's"
        )
    }

    pub fn finish(mut self) {
        self.drain();
    }
}
