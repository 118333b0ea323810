//! What a host says wrongly of its own handles nobody can check: Vulkan does not tell usage, layout or size of one. The
//! validation layer knows them, and says this.

use antumbra::graph::Scope;
use antumbra::scene::{Scene, generate};
use antumbra::{Error, FramePlan, Geometry, HostImage};
use antumbra_harness::{HeadlessDevice, HeadlessOptions, HostBuffer, OwnedImage, Stage, View};
use antumbra_tests::measure::settings;
use ash::vk;

const EXTENT: [u32; 2] = [24, 16];

fn scene() -> Scene {
    generate::card(generate::square_light(0.4).unwrap())
}

fn stage() -> (HeadlessDevice, Stage) {
    let device =
        HeadlessDevice::new(&HeadlessOptions { validation: true, ..Default::default() }).unwrap();
    let view = View::map_of_ground(1.5, 8.0);
    let settings = settings("technique=hard map=16");
    let stage = Stage::new(&device, &scene(), &view, EXTENT, settings, |_| true).unwrap();
    assert_eq!(device.take_messages(), Vec::<String>::new());
    (device, stage)
}

/// Records a plan, which is all that these lies take, and runs nothing.
fn record(device: &HeadlessDevice, stage: &mut Stage, plan: &FramePlan) {
    let node = stage.node().unwrap();
    let kept = device.submit_and_wait(|cmd| {
        node.record(cmd, plan)?;
        Err::<(), _>(Error::Frame("recorded, and not submitted".into()))
    });
    assert!(kept.unwrap_err().to_string().contains("not submitted"));
}

fn says(device: &HeadlessDevice, word: &str) {
    let messages = device.take_messages();
    println!("{}", messages.join("\n"));
    assert!(messages.iter().any(|m| m.contains(word)), "{word}: {messages:?}");
}

#[test]
fn a_depth_image_that_was_not_created_to_be_sampled() {
    let (device, mut stage) = stage();
    let usage = vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT;
    let depth =
        OwnedImage::new(&device, "unsampled", vk::Format::D32_SFLOAT, EXTENT, usage).unwrap();
    let lent = depth.lend(Scope::DEPTH_DRAWN, Scope::DEPTH_DRAWN);
    let light = scene().lights[0].light;
    // Said as it is, the plan is refused.
    let refused = stage.plan_with(light, |frame| frame.depth = lent).unwrap_err();
    assert!(refused.to_string().contains("created without SAMPLED"), "{refused}");
    let lie = HostImage { usage: usage | vk::ImageUsageFlags::SAMPLED, ..lent };
    let plan = stage.plan_with(light, |frame| frame.depth = lie).unwrap();
    record(&device, &mut stage, &plan);
    says(&device, "VUID-VkWriteDescriptorSet-descriptorType-00337");
}

#[test]
fn positions_that_are_no_vertex_buffer() {
    let (device, mut stage) = stage();
    let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
    let buffer = HostBuffer::new(&device, "no vertices", 4096, usage).unwrap();
    let mut meshes = stage.instances().to_vec();
    for mesh in &mut meshes {
        let Geometry::Buffers(buffers) = &mut mesh.geometry else { unreachable!() };
        buffers.positions = buffer.raw();
    }
    let light = scene().lights[0].light;
    let plan = stage.plan_with(light, |frame| frame.meshes = &meshes).unwrap();
    record(&device, &mut stage, &plan);
    says(&device, "VUID-vkCmdBindVertexBuffers-pBuffers-00627");
}

#[test]
fn an_image_that_is_in_another_layout() {
    let (device, mut stage) = stage();
    let light = scene().lights[0].light;
    let depth = stage.gbuffer().depth_for_node();
    let layout = vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL;
    assert_ne!(depth.before.layout, layout);
    let lie = HostImage { before: depth.before.in_layout(layout), ..depth };
    let plan = stage.plan_with(light, |frame| frame.depth = lie).unwrap();
    // Layouts are followed from submit to submit.
    stage.run(&plan).unwrap();
    says(&device, "layout");
}
