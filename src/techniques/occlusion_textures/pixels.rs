//! The passes over the pixels: at all of them, or at those of tiles that may meet an occluder.

use super::settings::{Combine, Prefilter, Settings};
use crate::graph::{Access, Graph, Owner, Pass, Push, ResourceId, Use, Uses};
use crate::shaders::module;
use crate::stages::nearest::nodes_a_row;
use crate::stages::tiles::Tiles;
use crate::stages::visibility::grid;
use crate::techniques::room::PassInputs;
use ash::vk;
use bytemuck::{Pod, Zeroable};
use smallvec::smallvec;

const NAME: &str = "occlusion_textures.visibility";

/// The slices as the pixels read them.
pub(super) struct PrefilteredSlices {
    /// The distances at which slices begin and end.
    pub placement: ResourceId,
    /// The mask of a bit a slice for each texel.
    pub mask: ResourceId,
    /// The slices' summed-area tables, or levels of means.
    pub means: ResourceId,
    /// The nearest faces, where frames may look for what slices leave out near a pixel.
    pub front: Option<ResourceId>,
}

/// Adds the passes that write the visible fraction from the prefiltered slices.
pub(super) fn declare_pixels(
    graph: &mut Graph,
    slices: &PrefilteredSlices,
    settings: &Settings,
    inputs: &PassInputs,
) {
    let sums = settings.prefilter == Prefilter::Sat;
    let (gbuffer, visibility) = (inputs.gbuffer, inputs.visibility);
    let push = Push::new(&pixel_push(settings, inputs));
    let write = if settings.classify { Access::ImageUpdate } else { Access::ImageWrite };
    let mut uses = Uses::from_slice(&gbuffer.all_bound());
    uses.extend([
        Use::bound(2, slices.placement, Access::SampledCompute),
        Use::bound(3, slices.means, Access::SampledCompute),
        Use::bound(4, visibility, write),
    ]);
    if !sums {
        uses.push(Use::bound(5, slices.mask, Access::SampledCompute));
    }
    uses.extend(slices.front.map(|front| Use::bound(8, front, Access::SampledCompute)));
    if !settings.classify {
        let shader = match (sums, settings.is_correlated()) {
            (true, false) => module!("occlusion_textures/visibility_sat.comp"),
            (true, true) => module!("occlusion_textures/visibility_sat_correlated.comp"),
            (false, false) => module!("occlusion_textures/visibility_levels.comp"),
            (false, true) => module!("occlusion_textures/visibility_levels_correlated.comp"),
        };
        let groups = grid(gbuffer.extent);
        graph.push(Pass::compute(NAME, shader, groups, push, uses, inputs.need));
        return;
    }
    // Means from levels do not distinguish an empty window from one with little in it; squares of the mask do.
    let blocking = if sums { slices.means } else { squares(graph, slices.mask, inputs) };
    let (sort, shader) = match (sums, settings.is_correlated()) {
        (true, false) => (
            module!("occlusion_textures/tiles_sat.comp"),
            module!("occlusion_textures/visibility_listed_sat.comp"),
        ),
        (true, true) => (
            module!("occlusion_textures/tiles_sat_correlated.comp"),
            module!("occlusion_textures/visibility_listed_sat_correlated.comp"),
        ),
        (false, false) => (
            module!("occlusion_textures/tiles_levels.comp"),
            module!("occlusion_textures/visibility_listed_levels.comp"),
        ),
        (false, true) => (
            module!("occlusion_textures/tiles_levels.comp"),
            module!("occlusion_textures/visibility_listed_levels_correlated.comp"),
        ),
    };
    let tiles = Tiles::start(graph, gbuffer.extent, inputs.need);
    let met = graph.buffer("occlusion_textures.met", 4 * Tiles::in_image(gbuffer.extent));
    let asked = [
        Use::bound(2, blocking, Access::SampledCompute),
        Use::bound(6, slices.placement, Access::SampledCompute),
        Use::bound(7, met, Access::BufferWriteCompute),
    ];
    tiles.sort(graph, sort, push, (&asked, visibility), gbuffer, inputs.need);
    uses.push(Use::bound(7, met, Access::BufferReadCompute));
    tiles.run(graph, (NAME, shader), push, uses, 6, inputs.need);
}

/// The push constants of `squares.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Squares {
    /// The map's side in texels.
    pub map: i32,
}

/// Adds the pass that finds the slices that block in each square of the mask.
fn squares(graph: &mut Graph, mask: ResourceId, inputs: &PassInputs) -> ResourceId {
    let side = inputs.occluders.side;
    let row = nodes_a_row(side);
    let name = "occlusion_textures.squares";
    let squares = graph.image(name, vk::Format::R32_UINT, [row; 2], Owner::Transient);
    graph.push(Pass::compute(
        name,
        module!("occlusion_textures/squares.comp"),
        grid([row; 2]),
        Push::new(&Squares { map: side as i32 }),
        smallvec![
            Use::bound(0, mask, Access::SampledCompute),
            Use::bound(1, squares, Access::ImageWrite),
        ],
        inputs.need,
    ));
    squares
}

/// The push constants of `visibility_*.comp`, `tiles_*.comp` and `listed_*.comp`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Visibility {
    /// Map texels a unit of u and v.
    pub texels_per_uv: [f32; 2],
    /// Texel coordinates of u = v = 0.
    pub first: [f32; 2],
    /// Half the light's width and height, m.
    pub half_light: [f32; 2],
    /// How far behind the light the projection point is, m.
    pub eye: f32,
    /// The map's side in texels.
    pub map: i32,
    /// The number of slices and what is switched on, see `slices.glsl`.
    pub flags: i32,
    /// The w of the map's near plane, 1/m.
    pub top: f32,
    /// How far a raster moves a vertex, in texels.
    pub snap: f32,
}

fn pixel_push(settings: &Settings, inputs: &PassInputs) -> Visibility {
    let PassInputs { occluders: view, light, .. } = inputs;
    let combine = match settings.combine {
        Combine::Product | Combine::Correlated => 0,
        Combine::Sum => 1,
        Combine::Max => 2,
    };
    Visibility {
        texels_per_uv: view.texels_per_uv().map(|x| x as f32),
        first: view.first().map(|x| x as f32),
        half_light: light.half_extents().map(|x| x as f32),
        eye: inputs.occluders.behind() as f32,
        map: view.side as i32,
        flags: settings.sizes(inputs.served).slices as i32
            | combine << 8
            | i32::from(settings.prefilter == Prefilter::Mip) << 11
            | i32::from(settings.looks_near(inputs.served)) << 12,
        top: view.top() as f32,
        snap: inputs.snap,
    }
}
