//! The largest that any host may ask for, against the least that every device of Vulkan 1.1 has ("Required Limits" and
//! "Required Format Support" of its specification), without an optional feature.

use crate::rows::modules;
use antumbra::graph::{
    Access, COLOR_ATTACHMENTS, Graph, INVOCATIONS, Pass, STORAGE_BYTES, Shape, Work,
};
use antumbra::{Description, LightTexture, frame};
use antumbra_tests::compile::committed;
use antumbra_tests::measure::settings;
use antumbra_tests::reflect::reflect;
use ash::vk::Format as F;

/// Pixels a side of an image (maxImageDimension2D) and of a framebuffer (maxFramebufferWidth).
const IMAGE_SIDE: u32 = 4096;
/// maxImageArrayLayers
const IMAGE_LAYERS: u32 = 256;
/// maxComputeWorkGroupCount
const GROUPS: u32 = 65_535;
/// maxComputeWorkGroupSize
const GROUP: [u32; 3] = [128, 128, 64];
/// maxComputeSharedMemorySize
const SHARED_BYTES: u32 = 16_384;
/// maxFragmentCombinedOutputResources
const FRAGMENT_OUTPUTS: usize = 4;
/// maxPerStageResources
const RESOURCES: usize = 128;

/// Formats that every device blends. (R32_SFLOAT is none of them: where it is not, `accumulate=blend` is refused.)
const BLENDED: [F; 2] = [F::R8G8B8A8_UNORM, F::R16_SFLOAT];
/// Formats that compute shaders write on every device, without shaderStorageImageExtendedFormats.
const STORED: [F; 5] = [
    F::R32_SFLOAT,
    F::R32_UINT,
    F::R32G32B32A32_SFLOAT,
    F::R32G32B32A32_UINT,
    F::R16G16B16A16_SFLOAT,
];

/// SPIR-V capabilities that need no feature: Matrix, Shader, InputAttachment, Sampled1D, Image1D, SampledBuffer,
/// ImageBuffer, ImageQuery, DerivativeControl.
const CAPABILITIES: [u32; 9] = [0, 1, 40, 43, 44, 46, 47, 50, 51];

/// What asks for most of each kind of row.
const WORDS: [&str; 18] = [
    "",
    "classify=off",
    "receivers=map receiver_map=4096 sides=two",
    "receivers=map receiver_map=4096 sides=two accumulate=blend",
    "receivers=map receiver_map=4096 accumulate=blend-fp16",
    "technique=hard",
    "technique=pcss",
    "technique=pcss classify=off",
    "technique=back-projection",
    "technique=many-lights samples=4096",
    "technique=ray-march layers=4",
    "technique=ray-march layers=3 levels=thirds",
    "technique=ray-march levels=mip search=linear filter=off",
    "technique=occlusion-textures slices=32 classify=off",
    "technique=occlusion-textures slices=32",
    "technique=occlusion-textures slices=32 prefilter=n-buffer",
    "technique=linear-light samples=16 lines=16",
    "technique=traced samples=1024",
];

/// The largest image, or for a list of its pixels the largest that is accepted, in the shape with the widest rows.
fn largest(words: &str) -> Description {
    // The largest map that agrees with the other settings.
    let sides = std::iter::successors(Some(4096), |side| (*side > 16).then_some(side / 2));
    let technique = settings(words);
    // Not every technique has maps.
    let technique = match technique.get("map") {
        Some(_) => {
            let mut all = sides.map(|side| technique.with_map(side).unwrap());
            all.find(|t| t.check().is_ok()).unwrap_or_else(|| panic!("{words}: no map"))
        }
        None => technique,
    };
    let heights = std::iter::successors(Some(16384), |height| (*height > 1).then_some(height - 1));
    let mut extents = heights.map(|height| [16384, height]);
    let fits = |extent: &[u32; 2]| {
        let list = technique.room().pixel_list(*extent);
        list.is_none_or(|(bytes, _)| bytes <= STORAGE_BYTES)
    };
    let extent = extents.find(fits).unwrap();
    let format = F::R8G8B8A8_UNORM;
    let textured = technique.room().takes().texture;
    let texture = textured.then_some(LightTexture { format, color: true });
    let description = Description {
        technique,
        mask_format: Some(F::R8_UNORM),
        light_texture: texture,
        ..Description::new(extent)
    };
    description.check().unwrap_or_else(|e| panic!("{words}: {e}"));
    description
}

fn of_resources(graph: &Graph, extent: [u32; 2]) -> Vec<String> {
    let too_large = |shape| match shape {
        Shape::Image { width, height, layers, .. } => {
            // What is as large as the G-buffer is there where the G-buffer is.
            ([width, height] != extent && width.max(height) > IMAGE_SIDE)
                || layers.unwrap_or(1) > IMAGE_LAYERS
        }
        Shape::Buffer { bytes } => bytes > STORAGE_BYTES,
    };
    let all = graph.resources().iter().filter(|r| too_large(r.shape));
    all.map(|r| format!("{}: {:?}", r.name, r.shape)).collect()
}

/// What of a row not every device has.
fn of_row(graph: &Graph, pass: &Pass) -> Vec<String> {
    let mut found = Vec::new();
    let mut complain = |what: String| found.push(format!("{}: {what}", pass.name));
    if let Work::Dispatch { groups, .. } = pass.work
        && groups.iter().any(|g| !(1..=GROUPS).contains(g))
    {
        complain(format!("{groups:?} workgroups"));
    }
    let is_raster = matches!(pass.work, Work::Raster { .. });
    let mut targets = 0;
    for u in &pass.uses {
        let Shape::Image { format, width, height, .. } = graph.resource(u.resource).shape else {
            continue;
        };
        match u.access {
            Access::ColorTarget => {
                targets += 1;
                if !(BLENDED.contains(&format) || format == F::R32_SFLOAT) {
                    complain(format!("{format:?} is blended"));
                }
            }
            Access::ImageWrite | Access::ImageUpdate if !STORED.contains(&format) => {
                complain(format!("{format:?} is written"));
            }
            _ => {}
        }
        if is_raster && u.access.writes() && width.max(height) > IMAGE_SIDE {
            complain(format!("a framebuffer of {width}×{height}"));
        }
    }
    if targets > COLOR_ATTACHMENTS.min(FRAGMENT_OUTPUTS) || pass.uses.len() > RESOURCES {
        complain(format!("{targets} color attachments among {} resources", pass.uses.len()));
    }
    // Without vertexPipelineStoresAndAtomics and fragmentStoresAndAtomics.
    let stores = pass.uses.iter().filter(|u| u.binding.is_some() && u.access.writes()).count();
    if is_raster && stores > 0 {
        complain(format!("{stores} stores outside of compute"));
    }
    for module in modules(pass) {
        for problem in of_module(module.path, module.spirv) {
            complain(problem);
        }
    }
    found
}

fn of_module(path: &str, spirv: &[u8]) -> Vec<String> {
    let shader = reflect(spirv).unwrap_or_else(|e| panic!("{path}: {e}"));
    let mut found = Vec::new();
    let too_wide = shader.workgroup.iter().zip(GROUP).any(|(side, most)| *side > most);
    if too_wide || shader.workgroup.iter().product::<u32>() > INVOCATIONS {
        found.push(format!("{path}: workgroups of {:?}", shader.workgroup));
    }
    if shader.shared_bytes > SHARED_BYTES {
        found.push(format!("{path}: {} shared bytes", shader.shared_bytes));
    }
    let beyond = shader.capabilities.iter().filter(|c| !CAPABILITIES.contains(c));
    found.extend(beyond.map(|c| format!("{path}: capability {c} is a feature's")));
    found
}

#[test]
fn no_row_takes_more_than_every_device_has() {
    let mut problems = Vec::new();
    let mut rows = 0;
    for words in WORDS {
        // The audit's passes are the same whatever the technique.
        let audit = if words == "technique=hard" { 65_536 } else { 0 };
        let description = Description { audit, ..largest(words) };
        description.check().unwrap_or_else(|e| panic!("{words}: {e}"));
        let graph = frame::full_graph(&description);
        println!("{words}: map={}, {} rows", description.technique.map(), graph.passes().len());
        rows += graph.passes().len();
        let of_rows = graph.kinds().flat_map(|pass| of_row(&graph, pass));
        let all = of_resources(&graph, description.extent).into_iter().chain(of_rows);
        problems.extend(all.map(|problem| format!("{words}: {problem}")));
        // Every row of a kind, by its grid.
        for pass in graph.passes() {
            if let Work::Dispatch { groups, .. } = pass.work {
                assert!(groups.iter().all(|g| *g <= GROUPS), "{words}, {}: {groups:?}", pass.name);
            }
        }
    }
    let modules = committed();
    problems.extend(modules.iter().flat_map(|(path, spirv)| of_module(path, spirv)));
    println!("{rows} passes, {} modules", modules.len());
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

/// The comparison notices too many groups, a format that is not blended everywhere and one that is not written.
#[test]
fn what_is_too_much_is_noticed() {
    let graph =
        frame::full_graph(&largest("receivers=map receiver_map=4096 accumulate=blend-fp16"));
    let pass = |name: &str| graph.passes().iter().find(|p| p.name == name).unwrap().clone();
    let mut wide = pass("soft_shadow_map.blocks");
    assert!(of_row(&graph, &wide).is_empty());
    let Work::Dispatch { groups, .. } = &mut wide.work else { unreachable!() };
    groups[0] = GROUPS + 1;
    assert_eq!(of_row(&graph, &wide), ["soft_shadow_map.blocks: [65536, 512, 2] workgroups"]);
    let mut blended = pass("soft_shadow_map.blend_front");
    let depth = graph.passes().iter().flat_map(|p| &p.uses);
    let depth =
        depth.filter(|u| u.access == Access::DepthTarget).map(|u| u.resource).next().unwrap();
    let target = blended.uses.iter_mut().find(|u| u.access == Access::ColorTarget).unwrap();
    target.resource = depth;
    assert_eq!(of_row(&graph, &blended), ["soft_shadow_map.blend_front: D32_SFLOAT is blended"]);
    let mut stores = pass("soft_shadow_map.blend_front");
    let read = stores.uses.iter_mut().find(|u| u.binding.is_some()).unwrap();
    read.access = Access::BufferUpdate;
    assert_eq!(of_row(&graph, &stores).len(), 1);
    let shapes = of_resources(&graph, [1, 1]);
    assert!(shapes.iter().any(|s| s.starts_with("visibility")), "{shapes:?}");
}
