//! Vulkan's calls that fail, one after the other: each is an error that names what was being made, nothing is left
//! behind, and what was there before is as it was.
//!
//! Every device here is under the validation layer: an object that nobody destroyed is told when its device is.

use antumbra::graph::Scope;
use antumbra::{Description, Error, Requirements, ShadowNode, frame};
use antumbra::{LightIndex, Slot};
use antumbra_harness::{ImageSource, read_image};
use antumbra_tests::TestDevice;
use antumbra_tests::bench::{Bench, Described, EXTENT, Memory, OTHER_EXTENT, host};
use antumbra_tests::measure::settings;
use antumbra_tests::permutations;
use antumbra_tests::tables::{self, FAULTY};
use ash::vk;
use std::collections::BTreeMap;

/// Which answers drivers give where they cannot make something.
const OUT: [vk::Result; 2] =
    [vk::Result::ERROR_OUT_OF_DEVICE_MEMORY, vk::Result::ERROR_OUT_OF_HOST_MEMORY];

/// Words that errors name what is made by: the rows, resources and shaders of a description, and what there is one of.
fn names(description: &Description) -> Vec<String> {
    let mut names: Vec<String> =
        ["the descriptor pool", "the descriptor sets", "the timestamps", "a layer of visibility"]
            .map(Into::into)
            .into();
    for s in description.all_techniques() {
        let alone =
            Description { technique: *s, other_techniques: Vec::new(), ..description.clone() };
        let graph = frame::full_graph(&alone);
        names.extend(graph.resources().iter().map(|r| r.name.to_owned()));
        names.extend(graph.passes().iter().map(|p| p.name.to_owned()));
    }
    names.extend(permutations::modules().into_iter().map(|module| module.name));
    names
}

/// Lets one call after the other fail until none of them does, and counts them by name.
fn each_call<T>(
    faults: &mut BTreeMap<&'static str, usize>,
    names: &[String],
    mut attempt: impl FnMut() -> Result<T, Error>,
) -> T {
    for k in 0.. {
        let result = OUT[k % 2];
        tables::fail(k, result);
        let made = attempt();
        let (failed, _) = tables::end();
        let error = match (made, failed) {
            (Ok(made), None) => return made,
            (Ok(_), Some(call)) => panic!("{call} failed, and nobody minded"),
            (Err(error), None) => panic!("no call has failed: {error}"),
            (Err(error), Some(call)) => {
                *faults.entry(call).or_default() += 1;
                error
            }
        };
        match &error {
            // gpu_allocator's own calls: it says what they were for.
            Error::Memory { .. } => assert_eq!(failed, Some("allocate_memory"), "{error}"),
            Error::Vulkan { result: told, .. } => assert_eq!(*told, result, "{error}"),
            _ => panic!("{failed:?}: {error}"),
        }
        let sentence = error.to_string();
        assert!(names.iter().any(|name| sentence.contains(name.as_str())), "what? {sentence}");
    }
    unreachable!("there are fewer calls than numbers")
}

fn show(what: &str, faults: &BTreeMap<&'static str, usize>) {
    println!("{what}: {} calls failed: {faults:?}", faults.values().sum::<usize>());
}

#[test]
fn calls_that_fail_while_a_node_is_made() {
    let device = TestDevice::through(FAULTY);
    let bench = Bench::new(&device).unwrap();
    let slow = device.leaves_to_others("calls that fail for other techniques than hard");
    let mut memory = Memory::new(&device);
    let mut faults = BTreeMap::new();
    let blends = Requirements::of(&host(&device, true)).blends_f32;
    let blend = if blends { "accumulate=blend" } else { "accumulate=blend-fp16" };
    let blend = format!("map=16 receivers=map receiver_map=16 {blend}");
    let more: &[Described] = &[
        ("map=16", |_| {}),
        (&blend, |_| {}),
        ("technique=linear-light map=16 samples=2 lines=1", |_| {}),
    ];
    let hard: Described = ("technique=hard map=16", |d| {
        (d.lights, d.inspect) = (2, true);
        d.other_techniques.push(settings("technique=hard map=32"));
    });
    let all = std::iter::once(&hard).chain(if slow { &[] } else { more });
    for (words, change) in all {
        let description = Bench::description(words, *change);
        let names = names(&description);
        // Layouts of its own, so that those fail too.
        let host = host(&device, false);
        let mut node = each_call(&mut faults, &names, || {
            let made = ShadowNode::new(host.clone(), &mut memory, description.clone());
            assert!(made.is_ok() || memory.out == 0, "{words}: not all came back");
            made
        });
        let before = bench.bits(&device, &node);
        let held = memory.out;
        let retired = each_call(&mut faults, &names, || {
            let resized = node.resize(&mut memory, OTHER_EXTENT);
            if resized.is_err() {
                assert_eq!(memory.out, held, "{words}: not all came back");
                tables::without_faults(|| {
                    assert!(bench.bits(&device, &node) == before, "{words}: another image");
                });
            }
            resized
        });
        retired.destroy(&mut memory);
        node.resize(&mut memory, EXTENT).unwrap().destroy(&mut memory);
        assert!(bench.bits(&device, &node) == before, "{words}: another image behind it all");
        node.destroy(&mut memory);
        assert_eq!(memory.out, 0, "{words}");
    }
    show("nodes", &faults);
    let of_a_node = &tables::FALLIBLE
        [1..tables::FALLIBLE.iter().position(|n| *n == "get_query_pool_results").unwrap()];
    let missed: Vec<_> = of_a_node.iter().filter(|n| !faults.contains_key(**n)).collect();
    // Hard has none of these.
    let missed: Vec<_> = missed.into_iter().filter(|n| !(slow && n.contains("buffer"))).collect();
    let timestamps = device.limits().timestamp_period > 0.0;
    assert!(
        missed.iter().all(|n| **n == "create_query_pool" && !timestamps),
        "never failed: {missed:?}"
    );
    drop(bench);
    device.finish();
}

/// The headless device around a node: scene, G-buffer, painter, submits, read-back.
#[test]
fn calls_that_fail_around_a_node() {
    let device = TestDevice::through(FAULTY);
    let mut faults = BTreeMap::new();
    // What is made there is told by many words.
    let any = [String::new()];
    let bench = each_call(&mut faults, &any, || Bench::new(&device));
    let mut memory = Memory::new(&device);
    let description = Bench::description("technique=hard map=16", |_| {});
    let node = ShadowNode::new(host(&device, true), &mut memory, description).unwrap();
    bench.bits(&device, &node);
    let result = node.visibility().unwrap();
    let format = vk::Format::R32_SFLOAT;
    let source = ImageSource { image: result.image, format, extent: result.extent, layer: 0 };
    each_call(&mut faults, &any, || read_image::<f32>(&device, &source, Scope::COPIED_FROM.layout));
    show("headless", &faults);
    node.destroy(&mut memory);
    drop(bench);
    device.finish();
}

const LOST: vk::Result = vk::Result::ERROR_DEVICE_LOST;

fn is_lost(error: &Error, what: &str) {
    let Error::DeviceLost { doing } = error else { panic!("{what}: {error}") };
    println!("{what}: lost while {doing}");
    assert!(error.to_string().contains("start anew"), "{error}");
}

/// A device that is lost while a node is made or resized: told as such, and what is there can be destroyed.
#[test]
fn a_device_that_is_lost_while_something_is_made() {
    let device = TestDevice::through(FAULTY);
    let mut memory = Memory::new(&device);
    let description = Bench::description("technique=hard map=16", |_| {});
    let host = host(&device, false);
    let mut losses = 0;
    let mut node = loop {
        tables::fail(losses, LOST);
        let made = ShadowNode::new(host.clone(), &mut memory, description.clone());
        let (call, _) = tables::end();
        match (made, call) {
            (Ok(node), _) => break node,
            // Of memory Vulkan says that it is out of it, or nothing.
            (Err(Error::Memory { .. }), Some("allocate_memory")) => {}
            (Err(error), _) => is_lost(&error, "new"),
        }
        assert_eq!(memory.out, 0);
        losses += 1;
    };
    tables::fail(0, LOST);
    is_lost(&node.resize(&mut memory, OTHER_EXTENT).err().unwrap(), "resize");
    tables::fail(0, LOST);
    is_lost(&node.reconfigure(&mut memory, description.clone()).err().unwrap(), "reconfigure");
    tables::end();
    assert_eq!(*node.description(), description, "it goes on as it was");
    // Without a wait, and without a word of Vulkan's.
    node.destroy(&mut memory);
    assert_eq!(memory.out, 0);
    println!("{losses} losses");
    device.finish();
}

/// A device that is lost while it runs a frame.
#[test]
fn a_device_that_is_lost_while_it_works() {
    let device = TestDevice::through(FAULTY);
    let mut bench = Bench::new(&device).unwrap();
    let light = bench.scene.lights[0].light;
    let plan = bench.stage.plan(light, None).unwrap();
    for call in ["begin_command_buffer", "end_command_buffer", "queue_submit", "wait_for_fences"] {
        tables::fail_next(call, LOST);
        let error = bench.stage.run(&plan).unwrap_err();
        assert_eq!(tables::end().0, Some(call));
        is_lost(&error, call);
    }
    // Of times there is none to tell then, and nobody waits for one.
    bench.stage.run(&plan).unwrap();
    tables::fail_next("get_query_pool_results", LOST);
    assert_eq!(bench.stage.node().unwrap().timings(Slot(0), LightIndex(0)), None);
    tables::end();
    drop(bench);
    device.finish();
}
