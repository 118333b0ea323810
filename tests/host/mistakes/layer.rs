//! What only the validation layer can know: handles and times.

use super::*;
use antumbra::scene::{Scene, generate};
use antumbra::{ShadowNode, Visibility};
use antumbra_harness::{HeadlessDevice, HeadlessOptions, Stage, View};
use antumbra_tests::measure::settings;

fn scene() -> Scene {
    generate::card(generate::square_light(0.4).unwrap())
}

fn device() -> HeadlessDevice {
    HeadlessDevice::new(&HeadlessOptions { validation: true, ..Default::default() }).unwrap()
}

fn stage(device: &HeadlessDevice) -> Stage {
    let view = View::map_of_ground(1.5, 8.0);
    let settings = settings("technique=hard map=16");
    let stage = Stage::new(device, &scene(), &view, [24, 16], settings, |_| true).unwrap();
    assert_eq!(device.take_messages(), Vec::<String>::new());
    stage
}

#[track_caller]
fn layer_says(messages: &[String], words: &[&str]) {
    println!("{}", messages.join("\n"));
    let found = messages.iter().any(|m| words.iter().all(|word| m.contains(word)));
    assert!(found, "{words:?}: {messages:?}");
}

#[test]
fn mistake_14_another_layout_before_than_was_said() {
    let device = device();
    let mut stage = stage(&device);
    let depth = stage.gbuffer().depth_for_node();
    let before = depth.before.in_layout(vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL);
    let lie = HostImage { before, ..depth };
    let plan = stage.plan_with(scene().lights[0].light, |f| f.depth = lie).unwrap();
    stage.run(&plan).unwrap();
    layer_says(&device.take_messages(), &["layout", "SHADER_READ_ONLY_OPTIMAL"]);
}

#[test]
fn mistake_15_the_result_read_in_another_layout_than_was_said() {
    let device = device();
    let mut stage = stage(&device);
    let after = Scope::FRAGMENT_SAMPLED;
    let own = Visibility::Own { before: Scope::UNUSED, after };
    let plan = stage.plan_with(scene().lights[0].light, |f| f.visibility = own).unwrap();
    stage.run(&plan).unwrap();
    assert_eq!(device.take_messages(), Vec::<String>::new());
    // It is copied out of TRANSFER_SRC_OPTIMAL.
    stage.visibility().unwrap();
    layer_says(&device.take_messages(), &["antumbra.visibility", "layout"]);
}

#[test]
fn mistake_16_always_the_same_slot() {
    let device = device();
    let mut stage = stage(&device);
    let plan = stage.plan(scene().lights[0].light, None).unwrap();
    // Two frames of one slot, the second recorded before the first is done.
    stage.run_all(&[plan.clone(), plan]).unwrap();
    layer_says(&device.take_messages(), &["VkDescriptorSet", "updated"]);
    documented(&["**Always the same `slot`.**"]);
}

#[test]
fn mistake_17_a_node_that_is_dropped_and_not_destroyed() {
    let device = device();
    // SAFETY: the node is never recorded, and leaks on purpose.
    let host = unsafe { device.host() };
    let made = {
        let mut allocator = device.allocator().lock().unwrap();
        ShadowNode::new(host, &mut *allocator, Description::new(EXTENT)).unwrap()
    };
    let log = device.message_log();
    drop(made);
    assert_eq!(log.take(), Vec::<String>::new());
    drop(device);
    layer_says(&log.take(), &["VkPipeline", "has not been destroyed"]);
}

/// The layer has nothing against depth that is cleared next, and a result that nobody had used before.
#[test]
fn scopes_that_say_nothing_are_no_mistake() {
    let device = device();
    let mut stage = stage(&device);
    let own = Visibility::Own { before: Scope::UNUSED, after: Scope::COPIED_FROM };
    let change = |f: &mut Frame| {
        f.depth.after = Scope::ANY;
        f.visibility = own;
    };
    let plan = stage.plan_with(scene().lights[0].light, change).unwrap();
    stage.run(&plan).unwrap();
    assert!(stage.visibility().unwrap().contains(&0.0));
    assert_eq!(device.take_messages(), Vec::<String>::new());
}
