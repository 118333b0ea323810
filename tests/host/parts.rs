//! A plan that is recorded in two parts writes the bits of one that is recorded whole, and parts out of order are refused.

use antumbra::frame::Part;
use antumbra::graph::Scope;
use antumbra::{Error, FramePlan, LightIndex, ShadowNode, Slot};
use antumbra_harness::{HeadlessDevice, ImageSource, Submitted, read_image};
use antumbra_tests::bench::{Bench, Memory, SMALLEST, host};
use antumbra_tests::device;
use ash::vk;

/// Submits one part, and waits for nothing.
fn submit(
    device: &HeadlessDevice,
    node: &ShadowNode,
    plan: &FramePlan,
    part: Part,
) -> Result<Submitted, Error> {
    device.submit(|cmd| node.record_part(cmd, plan, part, &mut |_| {})).map(|(_, done)| done)
}

fn bits_of(device: &HeadlessDevice, node: &ShadowNode) -> Vec<u32> {
    let result = node.visibility().unwrap();
    let format = vk::Format::R32_SFLOAT;
    let source = ImageSource { image: result.image, format, extent: result.extent, layer: 0 };
    let read: Vec<f32> = read_image(device, &source, Scope::COPIED_FROM.layout).unwrap();
    read.iter().map(|v| v.to_bits()).collect()
}

#[test]
fn two_parts_write_the_bits_of_the_whole() {
    let device = device();
    let bench = Bench::new(&device).unwrap();
    let mut memory = Memory::new(&device);
    for words in SMALLEST.into_iter().chain(["technique=traced"]) {
        let description = Bench::description(words, |_| {});
        let make = |memory: &mut Memory| {
            ShadowNode::new(host(&device, true), memory, description.clone()).unwrap()
        };
        let node = make(&mut memory);
        let whole = bench.bits(&device, &node).unwrap();
        node.destroy(&mut memory);

        let node = make(&mut memory);
        // The second frame draws over what the first one reads, with nothing but the plans' own barriers between them.
        for _ in 0..2 {
            let plan = bench.plan(&node).unwrap();
            let (first, all) = (plan.light_steps(), plan.plan().steps.len());
            assert!(first < all, "{words}");
            let of_pixels = ["hard", "pcss", "soft-shadow-map", "ray-march"];
            let maps =
                of_pixels.iter().any(|name| words.contains(name)) || words.starts_with("map");
            assert!(!maps || first > 1, "{words}: {first} of {all} steps need no G-buffer");
            let light = submit(&device, &node, &plan, Part::Light).unwrap();
            let pixels = submit(&device, &node, &plan, Part::Pixels).unwrap();
            light.wait().unwrap();
            pixels.wait().unwrap();
            assert!(bits_of(&device, &node) == whole, "{words}");
            let times = node.timings(Slot(0), LightIndex(0)).unwrap();
            assert_eq!(times.len(), plan.plan().runs().len(), "{words}");
            assert!(
                times.iter().all(|pass| (0.0..10_000.0).contains(&pass.ms)),
                "{words}: {times:?}"
            );
        }
        node.destroy(&mut memory);
    }
    assert_eq!(memory.out, 0);
}

#[test]
fn parts_out_of_order_are_refused() {
    let device = device();
    let bench = Bench::new(&device).unwrap();
    let mut memory = Memory::new(&device);
    let description = Bench::description("map=16", |_| {});
    let node = ShadowNode::new(host(&device, true), &mut memory, description).unwrap();
    let plan = bench.plan(&node).unwrap();
    let refused = |part| match submit(&device, &node, &plan, part) {
        Err(error @ Error::StalePlan(_)) => error.to_string(),
        other => panic!("{part:?}: {:?}", other.err()),
    };
    let run = |part| submit(&device, &node, &plan, part).unwrap().wait().unwrap();
    assert!(refused(Part::Pixels).contains("first part"));
    run(Part::Light);
    // A whole plan draws over the same maps.
    let whole = bench.run(&device, &node, &plan);
    refused(Part::Pixels);
    run(Part::Light);
    run(Part::Light);
    run(Part::Pixels);
    assert!(bits_of(&device, &node) == whole);
    refused(Part::Pixels);
    node.destroy(&mut memory);
}

/// Maps that a first part has drawn over are no longer those that an earlier plan counts on.
#[test]
fn a_first_part_alone_leaves_no_maps_to_reuse() {
    let device = device();
    let bench = Bench::new(&device).unwrap();
    let mut memory = Memory::new(&device);
    let description = Bench::description("map=16", |_| {});
    let node = ShadowNode::new(host(&device, true), &mut memory, description).unwrap();
    let plan = |revision| bench.plan_as(&node, |frame| frame.revision = Some(revision)).unwrap();
    let first = plan(1);
    let whole = bench.run(&device, &node, &first);
    let reuses = plan(1);
    assert!(reuses.plan().steps.len() < first.plan().steps.len(), "no map is reused");
    assert!(reuses.light_steps() < first.light_steps());
    let other = plan(2);
    submit(&device, &node, &other, Part::Light).unwrap().wait().unwrap();
    let error = submit(&device, &node, &reuses, Part::Light).err().unwrap();
    assert!(matches!(error, Error::StalePlan(_)), "{error}");
    submit(&device, &node, &other, Part::Pixels).unwrap().wait().unwrap();
    // Now the maps are those of the second revision.
    let reuses = plan(2);
    assert!(reuses.plan().steps.len() < other.plan().steps.len(), "no map is reused");
    submit(&device, &node, &reuses, Part::Light).unwrap().wait().unwrap();
    submit(&device, &node, &reuses, Part::Pixels).unwrap().wait().unwrap();
    assert!(bits_of(&device, &node) == whole);
    node.destroy(&mut memory);
}
