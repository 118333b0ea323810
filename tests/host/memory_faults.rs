//! An allocator that fails, at each of its calls: an error that names what the piece was for, every piece comes back,
//! and what was there before is as it was, to the bit.
//!
//! The device is under the validation layer: an object that nobody destroyed is told when it is.

use antumbra::frame::Capacity;
use antumbra::graph::{Graph, Owner};
use antumbra::{Description, Error, LightTexture, Requirements, ShadowNode, Technique, frame};
use antumbra_tests::TestDevice;
use antumbra_tests::bench::{Bench, Described, EXTENT, Memory, OTHER_EXTENT, SMALLEST, host};
use antumbra_tests::measure::settings;
use ash::vk;

/// Images and buffers that a node of this description has memory for: those that a row touches, and the result.
fn pieces(description: &Description) -> usize {
    let of = |graph: &Graph| {
        let ids = (0..graph.resources().len()).map(|index| graph.id(index));
        ids.filter(|&id| {
            let owner = graph.resource(id).owner;
            matches!(owner, Owner::Transient | Owner::Kept) && graph.uses_of(id).next().is_some()
        })
        .count()
    };
    let places = (description.lights * description.frames_in_flight) as usize;
    let figures = if description.audit > 0 { places } else { 0 };
    let alone = |s: &Technique| Description {
        technique: *s,
        other_techniques: Vec::new(),
        ..description.clone()
    };
    let graphs = description.all_techniques().map(|s| of(&frame::full_graph(&alone(s))));
    graphs.sum::<usize>() + usize::from(!description.lent_visibility) + figures
}

/// What adds resources to a technique, beside [`SMALLEST`].
const MORE: &[Described] = &[
    ("map=16 receivers=map receiver_map=16 accumulate=blend", |_| {}),
    ("technique=ray-march map=16 rays=4", |d| {
        d.light_texture = Some(LightTexture { format: vk::Format::R8G8B8A8_UNORM, color: true });
    }),
    ("technique=hard map=16", |d| (d.lights, d.inspect) = (3, true)),
    ("technique=hard map=16", |d| {
        (d.audit, d.lights, d.capacity) = (16, 2, Capacity { triangles: 512, meshes: 8 });
    }),
    ("technique=hard map=16", |d| d.other_techniques.push(settings("technique=hard map=32"))),
];

/// What went wrong is the piece that was refused.
fn is_of_memory(error: &Error, memory: &Memory, what: &str) {
    let Error::Memory { resource, .. } = error else { panic!("{what}: {error}") };
    assert_eq!(Some(resource), memory.refused.as_ref(), "{what}");
    assert!(error.to_string().contains("the test has none left"), "{error}");
}

#[test]
fn an_allocator_that_fails_at_each_call() {
    let device = TestDevice::new(true);
    let bench = Bench::new(&device).unwrap();
    let host = host(&device, true);
    let mut memory = Memory::new(&device);
    // There the techniques' pipelines alone would take longer than all of this.
    let slow = device.leaves_to_others("what a failed resize leaves, but for two techniques");
    let mut faults = [0; 3];
    let smallest = SMALLEST.map(|words| -> Described { (words, |_| {}) });
    for (words, change) in smallest.iter().chain(MORE) {
        let description = Bench::description(words, *change);
        if description.technique.room().blends_f32() && !Requirements::of(&host).blends_f32 {
            println!("{words}: the device cannot blend");
            continue;
        }
        let pieces = pieces(&description);
        for k in 0..pieces {
            memory.fail_at(Some(k));
            let made = ShadowNode::new(host.clone(), &mut memory, description.clone());
            is_of_memory(&made.err().unwrap(), &memory, words);
            assert_eq!(memory.out, 0, "{words}, piece {k}: not all came back");
        }
        faults[0] += pieces;
        if slow && !["technique=hard map=16", "map=16"].contains(words) {
            continue;
        }
        memory.fail_at(None);
        let mut node = ShadowNode::new(host.clone(), &mut memory, description.clone()).unwrap();
        assert_eq!(memory.asked, pieces, "{words}: pieces that were never refused");
        let (before, plan) = (bench.bits(&device, &node), bench.plan(&node));
        let as_it_was = |node: &ShadowNode, memory: &Memory, what: &str| {
            assert_eq!(memory.out, pieces, "{words}, {what}: not all came back");
            assert_eq!(*node.description(), description, "{words}, {what}");
            assert!(bench.bits(&device, node) == before, "{words}, {what}: another image");
        };

        // A resize that fails leaves the node as it was, to the bit.
        let mut k = 0;
        let retired = loop {
            memory.fail_at(Some(k));
            match node.resize(&mut memory, OTHER_EXTENT) {
                Ok(retired) => break retired,
                Err(error) => is_of_memory(&error, &memory, words),
            }
            as_it_was(&node, &memory, "resize");
            // Plans from before it fit too.
            let again = plan.as_ref().map(|plan| bench.run(&device, &node, plan));
            assert!(again == before, "{words}: another image of the plan from before");
            k += 1;
        };
        assert!(k > 0, "{words}: nothing depends on the size");
        faults[1] += k;
        retired.destroy(&mut memory);
        memory.fail_at(None);
        node.resize(&mut memory, EXTENT).unwrap().destroy(&mut memory);
        as_it_was(&node, &memory, "resized to and fro");

        // So does another description.
        let another = Description { frames_in_flight: 2, ..description.clone() };
        for k in 0..pieces {
            memory.fail_at(Some(k));
            let error = node.reconfigure(&mut memory, another.clone()).err().unwrap();
            is_of_memory(&error, &memory, words);
            assert_eq!(memory.out, pieces, "{words}, reconfigured: not all came back");
        }
        faults[2] += pieces;
        as_it_was(&node, &memory, "reconfigured");
        node.destroy(&mut memory);
        assert_eq!(memory.out, 0, "{words}");
    }
    let [new, resized, reconfigured] = faults;
    println!(
        "refused pieces of memory: {new} in new, {resized} in resize, {reconfigured} in reconfigure"
    );
    drop(bench);
    device.finish();
}
