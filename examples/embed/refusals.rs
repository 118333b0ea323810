//! The node's errors for an engine that gets something wrong: one sentence each, in the engine's
//! words, with nothing recorded and nothing lost.

#![allow(clippy::unwrap_used, reason = "a test says what went wrong by panicking")]

use super::*;
use antumbra::frame::HostAccess;
use antumbra::{
    Description, Error, Frame, Host, HostImage, Requirements, Scope, ShadowNode, Slot, Visibility,
};
use std::cell::Cell;

/// An engine with a G-buffer and a node, but for one thing.
struct Bench {
    gpu: Gpu,
    pass: GBufferPass,
    gbuffer: GBuffer,
    world: World,
}

const SIZE: [u32; 2] = [64, 48];

impl Bench {
    fn new() -> Self {
        let validate = std::env::var("ANTUMBRA_VALIDATE").is_ok_and(|value| value == "1");
        let mut gpu = Gpu::new(validate).unwrap();
        let pass = GBufferPass::new(&gpu).unwrap();
        let gbuffer = pass.images(&mut gpu, SIZE).unwrap();
        Self { gpu, pass, gbuffer, world: World::built_in() }
    }

    fn host(&self, device: &ash::Device, queue_family: u32) -> Host {
        let gpu = &self.gpu;
        // SAFETY: the handles belong together and outlive the node; no test submits anything.
        unsafe {
            Host::borrow(gpu.instance.clone(), gpu.physical_device, device.clone(), queue_family)
        }
    }

    fn node(&mut self) -> ShadowNode {
        let host = self.host(&self.gpu.device, self.gpu.queue_family);
        let description = Description::new(SIZE);
        ShadowNode::new(host, &mut self.gpu.allocator, description).unwrap()
    }

    fn depth(&self) -> HostImage {
        let image = &self.gbuffer.depth;
        HostImage {
            image: image.raw,
            view: image.view,
            format: image.format,
            extent: image.extent,
            usage: image.usage,
            before: Scope::DEPTH_DRAWN,
            after: Scope::COMPUTE_SAMPLED,
        }
    }

    fn frame(&self, depth: HostImage) -> Frame<'static> {
        let light = self.world.light(0.0, false).unwrap();
        Frame::new(Slot(0), light, self.world.clip_from_world(SIZE).inverse(), &[], depth)
    }

    /// Destroys everything; nothing may be left over, and the layer may have said nothing.
    fn finish(mut self, node: Option<ShadowNode>) {
        if let Some(node) = node {
            node.destroy(&mut self.gpu.allocator);
        }
        self.gbuffer.destroy(&mut self.gpu);
        self.pass.destroy(&self.gpu);
        assert_eq!(self.gpu.destroy(), 0, "bytes that nobody gave back");
        assert_eq!(device::messages(), 0);
    }
}

fn says(error: &Error, words: &[&str]) {
    let sentence = error.to_string();
    println!("{sentence}");
    assert!(words.iter().all(|w| sentence.contains(w)), "{words:?}: {sentence}");
    assert!(!sentence.contains('\n'), "more than one line: {sentence}");
}

#[test]
fn a_device_without_what_is_needed() {
    let mut bench = Bench::new();
    let host = bench.host(&bench.gpu.device, 99);
    let gaps = Requirements::of(&host).met().unwrap_err();
    says(&gaps, &["cannot run antumbra", "queue family 99"]);
    let made = ShadowNode::new(host, &mut bench.gpu.allocator, Description::new(SIZE));
    says(&made.err().unwrap(), &["queue family 99"]);
    bench.finish(None);
}

#[test]
fn a_wrong_layout_a_missing_usage_and_another_size() {
    let mut bench = Bench::new();
    let node = bench.node();
    let depth = bench.depth();
    let refused = |depth| node.plan(&bench.frame(depth)).unwrap_err();
    let wrong = refused(HostImage { before: Scope::COLOR_DRAWN, ..depth });
    says(&wrong, &["gbuffer.depth", "COLOR_ATTACHMENT_OPTIMAL"]);
    let wrong = refused(HostImage { before: Scope::UNUSED, ..depth });
    says(&wrong, &["gbuffer.depth", "UNDEFINED", "which layout"]);
    let drawn_only = vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT;
    says(&refused(HostImage { usage: drawn_only, ..depth }), &["created without SAMPLED"]);
    says(&refused(HostImage { extent: [32, 32], ..depth }), &["32×32", "64×48"]);
    node.plan(&bench.frame(depth)).unwrap();
    bench.finish(Some(node));
}

#[test]
fn use_after_a_resize() {
    let mut bench = Bench::new();
    let mut node = bench.node();
    let frame = bench.frame(bench.depth());
    let plan = node.plan(&frame).unwrap();
    let before = node.visibility().unwrap();
    let retired = node.resize(&mut bench.gpu.allocator, [32, 32]).unwrap();
    // The old G-buffer does not fit, and the old plan is not recorded (the command buffer that it is
    // given does not even exist).
    says(&node.plan(&frame).unwrap_err(), &["64×48", "32×32", "resize the node"]);
    says(&node.record(vk::CommandBuffer::null(), &plan).unwrap_err(), &["before a resize"]);
    // Nor is it when the old size comes back: the image behind it is another.
    let again = node.resize(&mut bench.gpu.allocator, SIZE).unwrap();
    assert_ne!(node.visibility().unwrap().image, before.image);
    says(&node.record(vk::CommandBuffer::null(), &plan).unwrap_err(), &["plan the frame again"]);
    let plan = node.plan(&frame).unwrap();
    let image = |a: &HostAccess| (a.name == "visibility").then_some(a.image);
    assert_eq!(plan.accesses().iter().find_map(image), Some(node.visibility().unwrap().image));
    retired.destroy(&mut bench.gpu.allocator);
    again.destroy(&mut bench.gpu.allocator);
    bench.finish(Some(node));
}

#[test]
fn what_is_lent_is_not_what_was_described() {
    let mut bench = Bench::new();
    let node = bench.node();
    let frame = bench.frame(bench.depth());
    let lent = Visibility::Lent(bench.depth());
    says(&node.plan(&Frame { visibility: lent, ..frame }).unwrap_err(), &["lent_visibility"]);
    says(
        &node.plan(&Frame { slot: Slot(5), ..frame }).unwrap_err(),
        &["slot 5", "2 frames in flight"],
    );
    bench.finish(Some(node));
}

thread_local! {
    /// Whether this test's device is lost, and how it makes images while it is not.
    static LOST: Cell<bool> = const { Cell::new(false) };
    static CREATE_IMAGE: Cell<Option<vk::PFN_vkCreateImage>> = const { Cell::new(None) };
}

/// Answers as a driver does once its device is lost.
unsafe extern "system" fn create_image(
    device: vk::Device,
    info: *const vk::ImageCreateInfo<'_>,
    callbacks: *const vk::AllocationCallbacks<'_>,
    image: *mut vk::Image,
) -> vk::Result {
    match CREATE_IMAGE.get().filter(|_| !LOST.get()) {
        // SAFETY: passed on as they came.
        Some(real) => unsafe { real(device, info, callbacks, image) },
        None => vk::Result::ERROR_DEVICE_LOST,
    }
}

/// A lost device shows when something is made: the node says so, goes on as it was, and can still be
/// destroyed.
#[test]
fn a_lost_device() {
    let mut bench = Bench::new();
    let real = &bench.gpu.device;
    let mut table = real.fp_v1_0().clone();
    CREATE_IMAGE.set(Some(table.create_image));
    table.create_image = create_image;
    let device = ash::Device::from_parts_1_3(
        real.handle(),
        table,
        real.fp_v1_1().clone(),
        real.fp_v1_2().clone(),
        real.fp_v1_3().clone(),
    );
    let host = bench.host(&device, bench.gpu.queue_family);
    let allocator = &mut bench.gpu.allocator;
    let mut node = ShadowNode::new(host.clone(), allocator, Description::new(SIZE)).unwrap();
    let held = allocator.generate_report().total_allocated_bytes;
    LOST.set(true);
    let resized = node.resize(allocator, [32, 32]).err().unwrap();
    says(&resized, &["the device was lost while creating visibility", "start anew"]);
    assert_eq!(node.description().extent, SIZE);
    let made = ShadowNode::new(host, allocator, Description::new(SIZE)).err().unwrap();
    says(&made, &["the device was lost while creating"]);
    assert_eq!(allocator.generate_report().total_allocated_bytes, held, "nothing left behind");
    bench.finish(Some(node));
}
