//! Every row of every graph against its SPIR-V: bindings, push constants, workgroups.

use antumbra::frame::{self, Limits};
use antumbra::graph::{Draw, Graph, INVOCATIONS, PUSH_BYTES, Pass, Work};
use antumbra::shaders::Module;
use antumbra::stages::depth_layers::DepthPush;
use antumbra::stages::hierarchy::{CutOutPush, MeshPush};
use antumbra_harness::descriptions::with_every_pass;
use antumbra_tests::example::root;
use antumbra_tests::headers;
use antumbra_tests::permutations;
use antumbra_tests::reflect::{Binding, Interface, reflect};
use ash::vk;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Mutex;

fn graphs() -> Vec<(String, Graph)> {
    let gpu = Limits::default();
    let devices = [("", gpu), (", on a processor", Limits { processor: true, ..gpu })];
    let of_device = |(name, limits): (&str, Limits)| {
        let graph = |(words, d)| (format!("{words}{name}"), frame::full_graph_on(&d, limits));
        with_every_pass().into_iter().map(graph).collect::<Vec<_>>()
    };
    devices.into_iter().flat_map(of_device).collect()
}

/// The modules of a row.
pub fn modules(pass: &Pass) -> Vec<Module> {
    match pass.work {
        Work::Dispatch { shader, .. }
        | Work::Indirect { shader, .. }
        | Work::EachMesh { shader }
        | Work::EachCutOut { shader, .. } => vec![shader],
        Work::Constants { .. } | Work::FrameNumber | Work::CutOuts => Vec::new(),
        Work::Raster { vertex, fragment, cut, .. } => {
            // The pipelines for cut-out meshes are there where the pass reads these.
            let cut = cut.filter(|_| pass.uses.iter().any(|u| u.binding == Some(15)));
            std::iter::once(vertex).chain(fragment).chain(cut.into_iter().flatten()).collect()
        }
    }
}

/// A module's interface, reflected once.
fn interface(module: Module) -> Interface {
    static KNOWN: Mutex<BTreeMap<&str, Interface>> = Mutex::new(BTreeMap::new());
    let mut known = KNOWN.lock().unwrap();
    let reflect = || reflect(module.spirv).unwrap_or_else(|e| panic!("{}: {e}", module.path));
    known.entry(module.path).or_insert_with(reflect).clone()
}

/// What set 1 of a pass holds of each mesh: positions and indices; or texture coordinates, an opacity texture and indices.
fn set_of_mesh(pass: &Pass) -> &'static [vk::DescriptorType] {
    const BUFFER: vk::DescriptorType = vk::DescriptorType::STORAGE_BUFFER;
    match pass.work {
        Work::EachMesh { .. } => &[BUFFER; 2],
        Work::EachCutOut { .. } => &[BUFFER, vk::DescriptorType::SAMPLED_IMAGE, BUFFER],
        // The indices are for compute shaders alone.
        Work::Raster { cut: Some(_), .. } => &[BUFFER, vk::DescriptorType::SAMPLED_IMAGE],
        _ => &[],
    }
}

/// What a row and its shaders disagree on.
fn disagreements(graph: &Graph, pass: &Pass) -> Vec<String> {
    let mut found = Vec::new();
    let mut seen = BTreeSet::new();
    let pushed = match pass.work {
        Work::Raster { draw: Draw::Layer { .. }, .. } => {
            pass.push.bytes().len().max(size_of::<DepthPush>())
        }
        Work::EachMesh { .. } => size_of::<MeshPush>(),
        Work::EachCutOut { .. } => size_of::<CutOutPush>(),
        _ => pass.push.bytes().len(),
    };
    for module in modules(pass) {
        let shader = interface(module);
        let of_mesh = |b: &&Binding| b.set == 1 && !set_of_mesh(pass).is_empty();
        for b in shader.bindings.iter().filter(of_mesh) {
            if b.writes || set_of_mesh(pass).get(b.binding as usize) != Some(&b.kind) {
                found.push(format!("{}: set 1 is no mesh", module.path));
            }
        }
        for b in shader.bindings.iter().filter(|b| !of_mesh(b)) {
            seen.insert(b.binding);
            let used = pass.uses.iter().find(|u| u.binding.map(u32::from) == Some(b.binding));
            let Some(used) = used else {
                found.push(format!(
                    "{}: binding {} ({}) is not in the row",
                    module.path, b.binding, b.name
                ));
                continue;
            };
            if b.set != 0 || used.access.descriptor() != Some(b.kind) {
                found.push(format!(
                    "{}: binding {} is {:?} of set {}, the row has {:?}",
                    module.path, b.binding, b.kind, b.set, used.access
                ));
            }
            if b.writes != used.access.writes() {
                found.push(format!(
                    "{}: binding {} ({}) {} written, the row has {:?}",
                    module.path,
                    b.binding,
                    b.name,
                    if b.writes { "is" } else { "is not" },
                    used.access
                ));
            }
            if b.kind == vk::DescriptorType::STORAGE_IMAGE {
                let shape = graph.resource(used.resource).shape;
                let antumbra::graph::Shape::Image { format, .. } = shape else {
                    found.push(format!("{}: binding {} is no image", module.path, b.binding));
                    continue;
                };
                if format != b.format {
                    found.push(format!("{}: {:?}, not {format:?}", module.path, b.format));
                }
            }
        }
        let bytes = shader.push_bytes() as usize;
        // A fragment shader may declare a part of what the vertex shader does, and structs are
        // padded to their alignment.
        if bytes > pushed || pushed > PUSH_BYTES || (pushed > bytes + 4 && modules(pass).len() == 1)
        {
            found
                .push(format!("{}: {bytes} bytes of push constants, pushed {pushed}", module.path));
        }
        if pass.work.compute_shader().is_some() {
            let invocations: u32 = shader.workgroup.iter().product();
            if !(1..=INVOCATIONS).contains(&invocations) {
                found.push(format!("{}: workgroup {:?}", module.path, shader.workgroup));
            }
        }
    }
    // What every device has for a stage: maxPerStageDescriptorStorageBuffers and so on.
    for (kind, most) in [
        (vk::DescriptorType::STORAGE_BUFFER, 4),
        (vk::DescriptorType::STORAGE_IMAGE, 4),
        (vk::DescriptorType::SAMPLED_IMAGE, 16),
    ] {
        let bound = pass.uses.iter().filter(|u| u.access.descriptor() == Some(kind)).count();
        let bound = bound + set_of_mesh(pass).iter().filter(|of_mesh| **of_mesh == kind).count();
        let targets =
            pass.uses.iter().filter(|u| u.access == antumbra::graph::Access::ColorTarget).count();
        if targets > antumbra::graph::COLOR_ATTACHMENTS {
            found.push(format!("{}: {targets} color attachments", pass.name));
        }
        if bound > most {
            found.push(format!("{}: {bound} of {kind:?}, where {most} are guaranteed", pass.name));
        }
    }
    for binding in pass.uses.iter().filter_map(|u| u.binding) {
        if !seen.contains(&binding.into()) {
            found.push(format!("{}: binding {binding} is in no shader", pass.name));
        }
    }
    found
}

#[test]
fn with_every_pass_is_what_its_shaders_say() {
    let mut problems = Vec::new();
    let mut rows = BTreeSet::new();
    for (words, graph) in graphs() {
        for pass in graph.passes() {
            rows.insert(pass.name);
            problems
                .extend(disagreements(&graph, pass).into_iter().map(|d| format!("{words}: {d}")));
        }
    }
    println!("{} rows: {rows:?}", rows.len());
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

/// The comparison notices a wrong binding, a wrong access and too few push constants.
#[test]
fn a_wrong_row_is_noticed() {
    let (_, graph) = graphs().remove(0);
    let pass = |name: &str| graph.passes().iter().find(|p| p.name == name).unwrap().clone();
    let good = pass("soft_shadow_map.blocks");
    assert!(disagreements(&graph, &good).is_empty());
    let mut wrong = good.clone();
    wrong.uses[2].binding = Some(7);
    assert_eq!(disagreements(&graph, &wrong).len(), 2, "one in the shader, one in the row");
    let mut wrong = good.clone();
    wrong.uses[2].access = antumbra::graph::Access::BufferReadCompute;
    assert_eq!(disagreements(&graph, &wrong).len(), 1);
    let mut wrong = good;
    wrong.push = antumbra::graph::Push::NONE;
    assert_eq!(disagreements(&graph, &wrong).len(), 1);
}

/// Every committed module is some pass's.
#[test]
fn every_module_has_a_row() {
    let used: BTreeSet<&str> = graphs()
        .iter()
        .flat_map(|(_, g)| g.passes().iter().flat_map(modules).map(|m| m.path).collect::<Vec<_>>())
        .collect();
    let committed: BTreeSet<String> = antumbra_tests::compile::committed().into_keys().collect();
    let headless = |name: &String| name.starts_with("headless/");
    let listed: BTreeSet<String> = committed.into_iter().filter(|name| !headless(name)).collect();
    assert_eq!(listed, used.iter().map(ToString::to_string).collect());
}

/// Every whole shader's first line names the passes that run it, and a Rust file that names one of its modules.
#[test]
fn every_shader_names_its_passes() {
    let mut passes: BTreeMap<&str, BTreeSet<String>> = BTreeMap::new();
    for (_, graph) in graphs() {
        for pass in graph.passes() {
            for module in modules(pass) {
                passes.entry(module.path).or_default().insert(pass.name.to_owned());
            }
        }
    }
    let mut files: BTreeMap<String, (BTreeSet<String>, Vec<String>)> = BTreeMap::new();
    for module in permutations::modules() {
        if let Some(passes) = passes.get(module.name.as_str()) {
            let (of_file, names) = files.entry(module.file).or_default();
            of_file.extend(passes.iter().cloned());
            names.push(module.name);
        }
    }
    assert!(files.len() > 50, "{} shaders", files.len());
    let mut found = Vec::new();
    for (file, (passes, names)) in files {
        match headers::entry(&file) {
            Err(problem) => found.push(format!("{problem}, is {passes:?}")),
            Ok(entry) => {
                let more = passes.difference(&entry.passes).count() > 0;
                if !entry.passes.is_subset(&passes) || more != entry.and_others {
                    let named = &entry.passes;
                    found.push(format!("glsl/{file} names the passes {named:?}, is {passes:?}"));
                }
                let text = std::fs::read_to_string(root().join(&entry.declared_in));
                let text = text.unwrap_or_default();
                // A few are constants that more than one file needs.
                let shared = std::fs::read_to_string(root().join("src/shaders.rs")).unwrap();
                let names_one = |name: &String| {
                    let quoted = format!("module!(\"{name}\")");
                    text.contains(&quoted) || shared.contains(&quoted)
                };
                if !names.iter().any(names_one) {
                    let declared_in = &entry.declared_in;
                    found.push(format!("glsl/{file}: {declared_in} has none of {names:?}"));
                }
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}
