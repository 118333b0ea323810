//! The passes over tiles, shafts and pixels.

use super::Settings;
use super::settings::Samples;
use crate::graph::{Access, Graph, Owner, Pass, Push, ResourceId, STORAGE_BYTES, Use, Uses, Work};
use crate::shaders::{Module, module};
use crate::stages::hierarchy::{Hierarchy, groups};
use crate::stages::visibility::grid;
use crate::techniques::room::PassInputs;
use ash::vk;
use bytemuck::{Pod, Zeroable};
use smallvec::smallvec;

/// The pixels along a tile's side (`traced/frame.glsl`).
const TILE_SIDE: u32 = 4;
/// The shafts of a tile (`traced/frame.glsl`).
const SHAFTS_A_TILE: u32 = 2;
/// The slots of a block (`traced/lists.glsl`).
const BLOCK: u32 = 256;
/// The places in the lists of triangles for each pixel of the image, on average.
const LISTED_A_PIXEL: u64 = 16;
/// The bytes of a slot, its shaft and first leaves, and of a list's entry (`traced/lists.glsl`).
const SLOT_BYTES: u64 = 128;
const ENTRY_BYTES: u64 = 24;
/// The bytes before a list's entries, and the offset in them of the workgroups that cover shafts.
const HEAD_BYTES: u64 = 24;
const SHADOWED: u64 = 12;

/// The push constants of the passes that make the lists (`traced/sums.comp`).
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct ListPush {
    /// How many slots for shafts there are.
    pub slots: u32,
    /// How many blocks they make.
    pub blocks: u32,
    /// The most leaves that a shaft may hold.
    pub most: u32,
    /// How many places all lists have together.
    pub capacity: u32,
}

/// The push constants of `traced/emission.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct EmissionPush {
    /// Samples along a side of the light.
    pub side: i32,
    /// 1 where red, green and blue count each, 0 where luminance does.
    pub color: i32,
}

/// The shaders that there are more than one of: for a light with a texture or without, for one visible fraction or one of
/// each color, for each number of samples, and for opacity textures.
struct Shaders {
    tiles: Module,
    gather: Module,
    /// Without opacity textures that cut out triangles, and with them.
    cover: [Module; 2],
    rays: [Module; 2],
}

impl Shaders {
    fn of(settings: &Settings, inputs: &PassInputs) -> Self {
        let (tiles, gather) = match inputs.color {
            false => (module!("traced/tiles.comp"), module!("traced/gather.comp")),
            true => (module!("traced/tiles_color.comp"), module!("traced/gather_color.comp")),
        };
        let (rays, covers) = match (inputs.light_texture, inputs.color) {
            (None, _) => (
                [module!("traced/rays.comp"), module!("traced/rays_cut.comp")],
                [
                    [module!("traced/cover.comp"), module!("traced/cover_cut.comp")],
                    [module!("traced/cover_many.comp"), module!("traced/cover_many_cut.comp")],
                    [module!("traced/cover_most.comp"), module!("traced/cover_most_cut.comp")],
                ],
            ),
            (Some(_), false) => (
                [module!("traced/rays_textured.comp"), module!("traced/rays_textured_cut.comp")],
                [
                    [
                        module!("traced/cover_textured.comp"),
                        module!("traced/cover_textured_cut.comp"),
                    ],
                    [
                        module!("traced/cover_many_textured.comp"),
                        module!("traced/cover_many_textured_cut.comp"),
                    ],
                    [
                        module!("traced/cover_most_textured.comp"),
                        module!("traced/cover_most_textured_cut.comp"),
                    ],
                ],
            ),
            (Some(_), true) => (
                [module!("traced/rays_color.comp"), module!("traced/rays_color_cut.comp")],
                [
                    [module!("traced/cover_color.comp"), module!("traced/cover_color_cut.comp")],
                    [
                        module!("traced/cover_many_color.comp"),
                        module!("traced/cover_many_color_cut.comp"),
                    ],
                    [
                        module!("traced/cover_most_color.comp"),
                        module!("traced/cover_most_color_cut.comp"),
                    ],
                ],
            ),
        };
        let [few, many, most] = covers;
        let cover = match settings.samples {
            Samples::Few => few,
            Samples::Many => many,
            Samples::Most => most,
        };
        Self { tiles, gather, cover, rays }
    }
}

/// The places in the lists of triangles for an image.
pub(super) fn listed(extent: [u32; 2]) -> u32 {
    let wished = LISTED_A_PIXEL * u64::from(extent[0]) * u64::from(extent[1]);
    wished.min(STORAGE_BYTES / 4) as u32
}

/// The bytes of the shafts of an image.
pub(super) fn slot_bytes(extent: [u32; 2]) -> u64 {
    let [x, y] = extent.map(|e| u64::from(e.div_ceil(TILE_SIDE)));
    u64::from(SHAFTS_A_TILE) * x * y * SLOT_BYTES
}

/// Adds the passes from the hierarchy to the visible fraction.
pub(super) fn declare(
    graph: &mut Graph,
    settings: &Settings,
    tree: &Hierarchy,
    constants: ResourceId,
    inputs: &PassInputs,
) {
    let PassInputs { gbuffer, need, visibility, .. } = *inputs;
    let extent = gbuffer.extent;
    let shaders = Shaders::of(settings, inputs);
    let emission = inputs.light_texture.map(|texture| {
        let side = settings.samples.side();
        let format = vk::Format::R32G32B32A32_SFLOAT;
        let emission = graph.image("traced.emission", format, [side; 2], Owner::Transient);
        graph.push(Pass::compute(
            "traced.emission",
            module!("traced/emission.comp"),
            [side, side, 1],
            Push::new(&EmissionPush { side: side as i32, color: inputs.color.into() }),
            smallvec![
                Use::bound(0, texture, Access::SampledCompute),
                Use::bound(1, emission, Access::ImageWrite),
            ],
            need,
        ));
        Use::bound(8, emission, Access::SampledCompute)
    });
    let tiles = extent.map(|e| e.div_ceil(TILE_SIDE));
    let slot_count = SHAFTS_A_TILE * tiles[0] * tiles[1];
    let blocks = slot_count.div_ceil(BLOCK);
    let capacity = listed(extent);
    let push = Push::new(&ListPush { slots: slot_count, blocks, most: settings.leaves, capacity });

    let slots = graph.buffer("traced.slots", slot_bytes(extent));
    let sums = graph.buffer("traced.sums", 16 * u64::from(blocks));
    let arguments = graph.buffer("traced.arguments", 32);
    let entries =
        graph.buffer("traced.entries", HEAD_BYTES + 2 * ENTRY_BYTES * u64::from(slot_count));
    let lists = graph.buffer("traced.lists", 4 * u64::from(capacity));

    let read = |binding, id| Use::bound(binding, id, Access::BufferReadCompute);
    let write = |binding, id| Use::bound(binding, id, Access::BufferWriteCompute);
    let update = |binding, id| Use::bound(binding, id, Access::BufferUpdate);
    let image = |binding, id| Use::bound(binding, id, Access::ImageRead);
    let shown = |binding| Use::bound(binding, visibility, Access::ImageUpdate);
    let of_frame = |more: &[Use]| {
        let mut uses = Uses::from_slice(&gbuffer.bound());
        uses.push(read(2, constants));
        uses.extend_from_slice(more);
        uses
    };
    graph.push(Pass::compute(
        "traced.tiles",
        shaders.tiles,
        grid(tiles),
        Push::NONE,
        of_frame(&[
            image(3, tree.nodes),
            write(4, slots),
            Use::bound(5, visibility, Access::ImageWrite),
        ]),
        need,
    ));
    graph.push(Pass::compute(
        "traced.sums",
        module!("traced/sums.comp"),
        groups(blocks),
        push,
        smallvec![read(0, slots), write(1, sums)],
        need,
    ));
    graph.push(Pass::compute(
        "traced.totals",
        module!("traced/totals.comp"),
        [1, 1, 1],
        push,
        smallvec![update(0, sums), write(1, entries), write(2, arguments)],
        need,
    ));
    graph.push(Pass::compute(
        "traced.list",
        module!("traced/list.comp"),
        groups(blocks),
        push,
        smallvec![read(0, slots), read(1, sums), update(2, entries)],
        need,
    ));
    // What the passes use that sum what the samples emit.
    let weighed = |uses: &[Use]| uses.iter().copied().chain(emission).collect::<Uses>();
    let over_list = |graph: &mut Graph, name, shader, (arguments, offset), uses: &[Use], need| {
        let mut uses = of_frame(uses);
        uses.push(Use::fixed(arguments, Access::Indirect));
        let work = Work::Indirect { shader, arguments, offset };
        graph.push(Pass { name, uses, push: Push::NONE, work, need });
    };
    over_list(
        graph,
        "traced.gather",
        shaders.gather,
        (arguments, 0),
        &[
            image(3, tree.nodes),
            image(4, tree.triangles),
            read(5, slots),
            update(6, entries),
            write(7, lists),
            shown(8),
        ],
        *need,
    );
    let cover = weighed(&[
        image(3, tree.triangles),
        read(4, slots),
        read(5, entries),
        read(6, lists),
        shown(7),
    ]);
    let rays = weighed(&[
        image(3, tree.nodes),
        image(4, tree.triangles),
        read(5, slots),
        read(6, entries),
        shown(7),
    ]);
    // A frame runs those that look opacity textures up, or those that do not.
    let [whole, cut] = tree.needs(graph, need);
    let [of_cover, of_rays] = [(entries, SHADOWED), (arguments, 16)];
    over_list(graph, "traced.cover", shaders.cover[0], of_cover, &cover, whole);
    over_list(graph, "traced.rays", shaders.rays[0], of_rays, &rays, whole);
    if let Some(cut_outs) = tree.cut_outs {
        let with = |uses: Uses| -> Uses { uses.into_iter().chain(cut_outs.bound(9)).collect() };
        let (cover, rays) = (with(cover), with(rays));
        over_list(graph, "traced.cover_cut", shaders.cover[1], of_cover, &cover, cut);
        over_list(graph, "traced.rays_cut", shaders.rays[1], of_rays, &rays, cut);
    }
}
