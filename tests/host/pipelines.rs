//! The pipelines of a description without a node: all of them, without memory, nothing left behind where a call fails, and what
//! they leave in the host's cache is what a node needs.

use antumbra::gpu::Pipelines;
use antumbra::graph::Work;
use antumbra::{Description, Requirements, ShadowNode, frame};
use antumbra_tests::TestDevice;
use antumbra_tests::bench::{Bench, Memory, host};
use antumbra_tests::tables::{self, FAULTY};
use ash::vk;
use std::collections::BTreeSet;
use std::time::Instant;

fn description() -> Description {
    Bench::description("map=16", |d| d.other_techniques.push("hard map=16".parse().unwrap()))
}

#[test]
fn every_pass_of_every_technique_has_its_pipelines() {
    let device = TestDevice::new(true);
    let description = Description { position_strides: vec![12, 24], ..description() };
    let pipelines = Pipelines::new(&host(&device, true), &description).unwrap();
    let mut expected = BTreeSet::new();
    for (technique, words) in [(0, description.technique), (1, description.other_techniques[0])] {
        let alone =
            Description { technique: words, other_techniques: Vec::new(), ..description.clone() };
        let graph = frame::full_graph(&alone);
        let runs =
            |work: &Work| work.compute_shader().is_some() || matches!(work, Work::Raster { .. });
        let passes = graph.kinds().filter(|pass| runs(&pass.work));
        expected.extend(passes.map(|pass| (technique, pass.name)));
    }
    let made: BTreeSet<_> = pipelines.each().iter().map(|p| (p.technique.0, p.pass)).collect();
    assert_eq!(made, expected);
    for pipeline in pipelines.each() {
        assert_ne!(pipeline.pipeline, vk::Pipeline::null());
        assert!(!pipeline.modules.is_empty(), "{}", pipeline.pass);
    }
    // Two strides, each with three ways of culling.
    let front = pipelines.each().iter().filter(|p| p.pass == "depth_layers.front");
    assert_eq!(front.filter(|p| p.technique.0 == 0).count(), 6);
    pipelines.destroy();
}

#[test]
fn a_call_that_fails_leaves_nothing_behind() {
    let device = TestDevice::through(FAULTY);
    let (host, description) = (host(&device, false), description());
    let mut failed = 0;
    for k in 0.. {
        tables::fail(k, vk::Result::ERROR_OUT_OF_HOST_MEMORY);
        let made = Pipelines::new(&host, &description);
        let (call, _) = tables::end();
        match (made, call) {
            (Ok(made), None) => {
                made.destroy();
                break;
            }
            (Err(error), Some(_)) => assert!(error.to_string().contains("failed"), "{error}"),
            (made, call) => panic!("{call:?}: {:?}", made.err()),
        }
        failed += 1;
    }
    println!("{failed} calls failed");
    assert!(failed > 20);
}

/// What is refused for a node is refused here.
#[test]
fn a_description_that_cannot_work_is_refused() {
    let device = TestDevice::new(true);
    let host = host(&device, true);
    let wrong = Description { lights: 65, ..description() };
    let error = Pipelines::new(&host, &wrong).err().unwrap();
    assert!(error.to_string().contains("65"), "{error}");
    let side = Requirements::of(&host).image_side;
    if side < 16384 {
        let large = Description { extent: [side + 1, 1], ..description() };
        assert!(Pipelines::new(&host, &large).is_err());
    }
}

/// The times are printed: that a driver keeps what it compiled is its own affair.
#[test]
fn a_node_finds_what_was_compiled_before() {
    let device = TestDevice::new(true);
    let host = host(&device, true);
    let mut memory = Memory::new(&device);
    let begin = Instant::now();
    let pipelines = Pipelines::new(&host, &description()).unwrap();
    let compiled = begin.elapsed();
    pipelines.destroy();
    let begin = Instant::now();
    let node = ShadowNode::new(host, &mut memory, description()).unwrap();
    println!("pipelines {compiled:.1?}, the node behind them {:.1?}", begin.elapsed());
    node.destroy(&mut memory);
    assert_eq!(memory.out, 0);
}
