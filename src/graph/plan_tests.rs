use super::*;
use crate::graph::{Need, Pass, Push, Reason, Use, Uses, Work};
use crate::shaders;
use smallvec::smallvec;
use vk::{AccessFlags as A, ImageLayout as L, PipelineStageFlags as S};

const DRAWN: Scope = Scope {
    stage: S::LATE_FRAGMENT_TESTS,
    access: A::DEPTH_STENCIL_ATTACHMENT_WRITE,
    layout: L::DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
};
const FETCHED: Scope = Scope {
    stage: S::FRAGMENT_SHADER,
    access: A::SHADER_READ,
    layout: L::SHADER_READ_ONLY_OPTIMAL,
};

/// A plan with an imported image that passes read by `reads`, and an exported image that a last pass writes.
fn plan_of(reads: &[Access], place_borders: bool) -> (Plan, ResourceId) {
    let mut graph = Graph::new();
    let extent = [4, 4];
    let depth = graph.image("depth", vk::Format::D32_SFLOAT, extent, Owner::Imported);
    let result = graph.image("result", vk::Format::R32_SFLOAT, extent, Owner::Exported);
    let middle = graph.buffer("middle", 4);
    let pass = |name, uses| Pass {
        name,
        uses,
        push: Push::NONE,
        work: Work::Dispatch { shader: shaders::LIT, groups: [1; 3] },
        need: Need::Yes(Reason::default()),
    };
    for (&read, name) in reads.iter().zip(["one", "two"]) {
        let write = Use::fixed(middle, Access::BufferWriteCompute);
        graph.push(pass(name, smallvec![Use::fixed(depth, read), write]));
    }
    let mut last = smallvec![Use::fixed(result, Access::ImageWrite)];
    if !reads.is_empty() {
        last.push(Use::fixed(middle, Access::BufferReadCompute));
    }
    graph.push(pass("last", last));
    let borders =
        [depth, result].map(|resource| Border { resource, before: DRAWN, after: FETCHED });
    (compile(graph, &borders, place_borders).unwrap(), depth)
}

/// The host expects a shared image in its layout whether or not a pass used it.
#[test]
fn what_no_pass_uses_is_handed_over_too() {
    let (plan, depth) = plan_of(&[], true);
    assert!(plan.boundary.iter().all(|b| b.resource != depth));
    let barrier = plan.handover.iter().find(|b| b.resource == depth).unwrap().barrier;
    assert_eq!((barrier.src_stage, barrier.src_access), (DRAWN.stage, DRAWN.access));
    assert_eq!((barrier.dst_stage, barrier.dst_access), (FETCHED.stage, FETCHED.access));
    assert_eq!((barrier.old_layout, barrier.new_layout), (DRAWN.layout, FETCHED.layout));
    // Without the host's barriers the plan hands over nothing.
    assert!(plan_of(&[], false).0.handover.is_empty());
}

/// The host's one barrier on entry must reach every stage that reads before anything is written.
#[test]
fn the_entry_covers_every_reader() {
    let (plan, depth) = plan_of(&[Access::SampledCompute, Access::SampledFragment], false);
    let entry = plan.boundary.iter().find(|b| b.resource == depth).unwrap().entry;
    assert_eq!(entry.stage, S::COMPUTE_SHADER | S::FRAGMENT_SHADER);
    assert!(plan.steps.iter().flat_map(|s| &s.barriers).all(|b| b.resource != depth));
}

fn buffers() -> (Graph, [ResourceId; 2], ResourceId) {
    let mut graph = Graph::new();
    let buffers = [graph.buffer("a", 4), graph.buffer("b", 4)];
    let result = graph.image("result", vk::Format::R32_SFLOAT, [4; 2], Owner::Exported);
    (graph, buffers, result)
}

fn pass(name: &'static str, uses: Uses, need: Need) -> Pass {
    let work = Work::Dispatch { shader: shaders::LIT, groups: [1; 3] };
    Pass { name, uses, push: Push::NONE, work, need }
}

fn needed() -> Need {
    Need::Yes(Reason::default())
}

fn compiled(graph: Graph, result: ResourceId) -> Result<Plan, Error> {
    compile(graph, &[Border { resource: result, before: FETCHED, after: FETCHED }], true)
}

#[test]
fn nothing_is_read_before_it_is_written() {
    use Access::{BufferReadCompute as R, BufferWriteCompute as W, ImageWrite as I};
    let (mut graph, [a, b], result) = buffers();
    let uses = smallvec![Use::fixed(a, R), Use::fixed(result, I)];
    graph.push(pass("early", uses.clone(), needed()));
    let error = compiled(graph, result).unwrap_err().to_string();
    assert!(error.contains("early") && error.contains("reads a,"), "{error}");
    // A pass that does not run writes nothing.
    let (mut graph, _, _) = buffers();
    graph.push(pass("writer", smallvec![Use::fixed(a, W)], Need::No(Reason::default())));
    graph.push(pass("reader", uses, needed()));
    assert!(compiled(graph, result).is_err());
    // Nor may a pass read what it writes itself.
    let (mut graph, _, _) = buffers();
    graph.push(pass("writer", smallvec![Use::fixed(b, W)], needed()));
    graph.push(pass("both", smallvec![Use::fixed(b, R), Use::fixed(b, W)], needed()));
    let error = compiled(graph, result).unwrap_err().to_string();
    assert!(error.contains("touches b twice"), "{error}");
}

#[test]
fn passes_whose_output_nobody_reads_drop_out_with_all_that_fed_them() {
    use Access::{BufferReadCompute as R, BufferWriteCompute as W, ImageWrite as I};
    let (mut graph, [a, b], result) = buffers();
    graph.push(pass("feeds", smallvec![Use::fixed(a, W)], needed()));
    graph.push(pass("unread", smallvec![Use::fixed(a, R), Use::fixed(b, W)], needed()));
    graph.push(pass("result", smallvec![Use::fixed(result, I)], needed()));
    let why = graph.because("not today");
    graph.push(pass("off", smallvec![Use::fixed(b, W)], Need::No(why)));
    let plan = compiled(graph, result).unwrap();
    assert_eq!(plan.steps.iter().map(|s| s.pass).collect::<Vec<_>>(), [2]);
    let why: Vec<_> =
        plan.skipped.iter().map(|s| (s.pass, plan.why_skipped(s).to_string())).collect();
    let why: Vec<_> = why.iter().map(|(pass, why)| (*pass, why.as_str())).collect();
    assert_eq!(
        why,
        [
            (0, "nothing reads a in this frame"),
            (1, "nothing reads b in this frame"),
            (3, "not today")
        ]
    );
}

#[test]
fn a_lent_image_without_a_border_is_refused() {
    let (mut graph, _, result) = buffers();
    graph.push(pass("result", smallvec![Use::fixed(result, Access::ImageWrite)], needed()));
    let error = compile(graph, &[], true).unwrap_err().to_string();
    assert!(error.contains("result") && error.contains("host must say"), "{error}");
}

/// A map that is drawn and added n times: passes of one name, with other numbers.
fn repeated(times: u32) -> (Graph, ResourceId) {
    use Access::{
        BufferReadCompute as R, BufferWriteCompute as W, ImageUpdate as U, ImageWrite as I,
    };
    let (mut graph, [map, _], result) = buffers();
    let sum = graph.image("sum", vk::Format::R32_SFLOAT, [4; 2], Owner::Transient);
    graph.push(pass("clear", smallvec![Use::bound(0, sum, I)], needed()));
    for nth in 0..times {
        let push = Push::new(&nth);
        let draw = pass("draw", smallvec![Use::bound(0, map, W)], needed());
        graph.push(Pass { push, ..draw });
        let add = pass("add", smallvec![Use::bound(0, map, R), Use::bound(1, sum, U)], needed());
        graph.push(Pass { push, ..add });
    }
    let uses = smallvec![Use::bound(0, sum, Access::SampledCompute), Use::bound(1, result, I)];
    graph.push(pass("average", uses, needed()));
    (graph, result)
}

#[test]
fn passes_of_one_name_are_one_kind_and_one_line() {
    let (graph, result) = repeated(5);
    assert_eq!(graph.passes().len(), 12);
    assert_eq!(
        graph.kinds().map(|p| p.name).collect::<Vec<_>>(),
        ["clear", "draw", "add", "average"]
    );
    let plan = compiled(graph, result).unwrap();
    assert_eq!(plan.steps.len(), 12);
    let first: Vec<_> = plan.steps.iter().filter(|s| s.first).map(|s| s.pass).collect();
    assert_eq!(first, [0, 1, 2, 11], "descriptors are written once a kind");
    let runs: Vec<_> = plan.runs().iter().map(|r| (r.pass.name, r.times)).collect();
    assert_eq!(runs, [("clear", 1), ("draw", 5), ("add", 5), ("average", 1)]);
    let table = plan.table();
    assert_eq!(table.lines().count(), 4, "{table}");
    assert!(table.contains("×5"), "{table}");
    assert_eq!(plan.graphviz().matches("label=\"add\"").count(), 1);
}

/// The second map is drawn when the first has been read; each sum waits for the one before.
#[test]
fn a_pass_that_repeats_waits_for_itself() {
    let (graph, result) = repeated(2);
    let plan = compiled(graph, result).unwrap();
    let of = |step: usize, name: &str| {
        let named = |b: &&ResourceBarrier| plan.graph.resource(b.resource).name == name;
        plan.steps[step].barriers.iter().find(named).map(|b| b.barrier)
    };
    let again = of(3, "a").unwrap();
    assert_eq!((again.src_stage, again.dst_access), (S::COMPUTE_SHADER, A::SHADER_WRITE));
    let sum = of(4, "sum").unwrap();
    assert_eq!((sum.src_access, sum.old_layout), (A::SHADER_WRITE, L::GENERAL));
    assert!(sum.dst_access.contains(A::SHADER_READ | A::SHADER_WRITE));
}

#[test]
fn what_is_updated_must_have_been_written() {
    let (mut graph, _, result) = buffers();
    let uses = smallvec![Use::fixed(result, Access::ImageUpdate)];
    graph.push(pass("add", uses, needed()));
    let error = compiled(graph, result).unwrap_err().to_string();
    assert!(error.contains("add: reads result"), "{error}");
}

#[test]
fn one_name_for_two_kinds_of_work_is_refused() {
    let (mut graph, [a, b], result) = buffers();
    for id in [a, b] {
        graph.push(pass(
            "writer",
            smallvec![Use::bound(0, id, Access::BufferWriteCompute)],
            needed(),
        ));
    }
    graph.push(pass("result", smallvec![Use::fixed(result, Access::ImageWrite)], needed()));
    let error = compiled(graph, result).unwrap_err().to_string();
    assert!(error.contains("writer: passes of one name"), "{error}");
}

/// A kept image is left ready for its readers: a frame that does not write it reads it without a barrier.
#[test]
fn what_is_kept_needs_no_barrier_again() {
    let plan_of = |makes: Need| {
        let mut graph = Graph::new();
        let image = |graph: &mut Graph, name, owner| {
            graph.image(name, vk::Format::R32_SFLOAT, [4, 4], owner)
        };
        let map = image(&mut graph, "map", Owner::Transient);
        let result = image(&mut graph, "result", Owner::Exported);
        graph.keep(map);
        let pass = |name, uses, need| Pass {
            name,
            uses,
            push: Push::NONE,
            work: Work::Dispatch { shader: shaders::LIT, groups: [1; 3] },
            need,
        };
        graph.push(pass("make", smallvec![Use::fixed(map, Access::ImageWrite)], makes));
        let look = smallvec![
            Use::fixed(map, Access::SampledCompute),
            Use::fixed(result, Access::ImageWrite)
        ];
        graph.push(pass("look", look, Need::Yes(Reason::default())));
        let borders = [Border { resource: result, before: FETCHED, after: FETCHED }];
        (compile(graph, &borders, true).unwrap(), map)
    };
    let of_map = |(plan, map): &(Plan, ResourceId)| {
        let steps = plan.steps.iter().flat_map(|s| &s.barriers).chain(&plan.handover);
        steps.filter(|b| b.resource == *map).map(|b| b.barrier).collect::<Vec<_>>()
    };
    let made = of_map(&plan_of(Need::Yes(Reason::default())));
    assert_eq!(made.len(), 2);
    // Earlier frames may still read what is overwritten.
    assert!(made[0].src_stage.contains(S::COMPUTE_SHADER) && made[0].new_layout == L::GENERAL);
    assert_eq!((made[1].src_access, made[1].new_layout), (A::SHADER_WRITE, FETCHED.layout));
    let kept = plan_of(Need::No(Reason::default()));
    assert_eq!(kept.0.steps.len(), 1);
    assert!(of_map(&kept).is_empty());
}
