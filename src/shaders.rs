//! The shaders, embedded: one line per module.
//!
//! The words come from `spirv/`, which is compiled from `glsl/` and committed; a test recompiles
//! every module and compares the bytes.

/// One SPIR-V module with the entry point `main`.
#[derive(Clone, Copy)]
pub struct Module {
    /// The source's path under `glsl/`.
    pub path: &'static str,
    /// SPIR-V 1.0, little-endian words.
    pub spirv: &'static [u8],
}

impl Module {
    /// The module's words.
    pub fn words(&self) -> Vec<u32> {
        let word = |b: &[u8]| u32::from_le_bytes([b[0], b[1], b[2], b[3]]);
        self.spirv.chunks_exact(4).map(word).collect()
    }
}

impl PartialEq for Module {
    fn eq(&self, other: &Self) -> bool {
        self.path == other.path
    }
}

impl std::fmt::Debug for Module {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.path)
    }
}

macro_rules! module {
    ($path:literal) => {
        Module { path: $path, spirv: include_bytes!(concat!("../spirv/", $path, ".spv")) }
    };
}

/// Positions to clip space, for depth alone.
pub const DEPTH_VERT: Module = module!("depth_layers/depth.vert");
/// A host's occluder map to a layer.
pub const TAKE: Module = module!("depth_layers/take.comp");
/// A hard shadow map, 3×3 filtered.
pub const HARD: Module = module!("baseline/hard.comp");
/// Percentage-closer soft shadows.
pub const PCSS: Module = module!("baseline/pcss.comp");
/// The same at the pixels of listed tiles.
pub const PCSS_TILES: Module = module!("baseline/pcss_tiles.comp");
/// Which tiles of pixels find no blocker.
pub const PCSS_SORT: Module = module!("baseline/tiles.comp");
/// The largest w of squares of texels.
pub const NEAREST: Module = module!("baseline/nearest.comp");
/// The least and largest w of 2×2 texels.
pub const FINEST_LEVEL: Module = module!("baseline/finest_level.comp");
/// A level of those from the one before.
pub const NEXT_LEVEL: Module = module!("baseline/next_level.comp");
/// Texels projected back onto the light.
pub const BACK_PROJECTION: Module = module!("baseline/back_projection.comp");
/// The G-buffer in light space.
pub const RECEIVERS: Module = module!("baseline/receivers.comp");
/// Whether each pixel sees one point of the light.
pub const ADD_POINT: Module = module!("baseline/add_point.comp");
/// The share of the points that each pixel sees.
pub const AVERAGE: Module = module!("baseline/average.comp");
/// Occluder map to blocks of texels with their moments.
pub const BLOCKS: Module = module!("soft_shadow_map/blocks.comp");
/// Blocks to superblocks.
pub const SUPERBLOCKS: Module = module!("soft_shadow_map/superblocks.comp");
/// The hierarchical gather at the receiver map's texels.
pub const GATHER_MAP: Module = module!("soft_shadow_map/gather_map.comp");
/// The hierarchical gather at the G-buffer's pixels.
pub const GATHER_PIXELS: Module = module!("soft_shadow_map/gather_pixels.comp");
/// The same at the pixels of listed tiles.
pub const GATHER_TILES: Module = module!("soft_shadow_map/gather_tiles.comp");
/// Which tiles of pixels feel no occluder, by blocks of the map.
pub const TILES: Module = module!("soft_shadow_map/tiles.comp");
/// Occupied texels of each group of blocks.
pub const PATCH_COUNT: Module = module!("soft_shadow_map/patch_count.comp");
/// Group counts to offsets, and the draw's arguments.
pub const PATCH_SCAN: Module = module!("soft_shadow_map/patch_scan.comp");
/// Blocks to a buffer of micro-patches.
pub const PATCH_EMIT: Module = module!("soft_shadow_map/patch_emit.comp");
/// A micro-patch to its penumbra rectangle.
pub const PATCH_VERT: Module = module!("soft_shadow_map/patch.vert");
/// A micro-patch's occlusion at a receiver texel.
pub const PATCH_FRAG: Module = module!("soft_shadow_map/patch.frag");
/// Depth layers to columns of what is solid.
pub const COLUMNS: Module = module!("ray_march/columns.comp");
/// The bounds of a level's windows.
pub const LEVEL: Module = module!("ray_march/level.comp");
/// The same for any kind of windows.
pub const LEVEL_ANY: Module = module!("ray_march/level_any.comp");
/// An empty list of pixels.
pub const START: Module = module!("ray_march/start.comp");
/// Which pixels need rays.
pub const CLASSIFY: Module = module!("ray_march/classify.comp");
/// The same with any settings.
pub const CLASSIFY_ANY: Module = module!("ray_march/classify_any.comp");
/// The rays of the listed pixels.
pub const TRACE: Module = module!("ray_march/trace.comp");
/// The same with any settings.
pub const TRACE_ANY: Module = module!("ray_march/trace_any.comp");
/// The listed pixels, filtered along rows.
pub const FILTER_ROWS: Module = module!("ray_march/filter_rows.comp");
/// The same along columns.
pub const FILTER_COLUMNS: Module = module!("ray_march/filter_columns.comp");
/// Which pixels need rays, in color.
pub const CLASSIFY_COLOR: Module = module!("ray_march/classify_color.comp");
/// Rays weighed by what the light emits.
pub const TRACE_TEXTURED: Module = module!("ray_march/trace_textured.comp");
/// The same in color.
pub const TRACE_COLOR: Module = module!("ray_march/trace_color.comp");
/// The listed pixels, filtered along rows, in color.
pub const FILTER_ROWS_COLOR: Module = module!("ray_march/filter_rows_color.comp");
/// The same along columns.
pub const FILTER_COLUMNS_COLOR: Module = module!("ray_march/filter_columns_color.comp");
/// Where slices begin and end.
pub const PLACE: Module = module!("occlusion_textures/place.comp");
/// An empty histogram of distances.
pub const HISTOGRAM_START: Module = module!("occlusion_textures/histogram_start.comp");
/// How many texels have a face in each bin of distances.
pub const HISTOGRAM: Module = module!("occlusion_textures/histogram.comp");
/// Where slices begin and end, by that.
pub const PLACE_FITTED: Module = module!("occlusion_textures/place_fitted.comp");
/// Faces counted in the first sixteen slices.
pub const SLICE: Module = module!("occlusion_textures/slice.frag");
/// Faces counted in the others.
pub const SLICE_LOWER: Module = module!("occlusion_textures/slice_lower.frag");
/// Counted faces to a bit a slice.
pub const MASK: Module = module!("occlusion_textures/mask.comp");
/// Summed-area tables along rows.
pub const SUM_ROWS: Module = module!("occlusion_textures/sum_rows.comp");
/// The same along columns.
pub const SUM_COLUMNS: Module = module!("occlusion_textures/sum_columns.comp");
/// What slices hide of each pixel, from summed-area tables.
pub const VISIBILITY_SAT: Module = module!("occlusion_textures/visibility_sat.comp");
/// The same by what slices have in common.
pub const VISIBILITY_SAT_CORRELATED: Module =
    module!("occlusion_textures/visibility_sat_correlated.comp");
/// Means of the smallest windows of slices.
pub const MEANS_FIRST_LEVEL: Module = module!("occlusion_textures/first_level.comp");
/// Means of a level's windows.
pub const MEANS_NEXT_LEVEL: Module = module!("occlusion_textures/next_level.comp");
/// Which tiles of pixels meet nothing in any slice, by summed-area tables.
pub const SLICE_TILES_SAT: Module = module!("occlusion_textures/tiles_sat.comp");
/// The same with what correlated slices have.
pub const SLICE_TILES_SAT_CORRELATED: Module =
    module!("occlusion_textures/tiles_sat_correlated.comp");
/// The visible fraction at the pixels of listed tiles, from summed-area tables.
pub const LISTED_SAT: Module = module!("occlusion_textures/listed_sat.comp");
/// The same by what slices have in common.
pub const LISTED_SAT_CORRELATED: Module = module!("occlusion_textures/listed_sat_correlated.comp");
/// What slices hide of each pixel, from levels of means.
pub const VISIBILITY_LEVELS: Module = module!("occlusion_textures/visibility_levels.comp");
/// The same by what slices have in common.
pub const VISIBILITY_LEVELS_CORRELATED: Module =
    module!("occlusion_textures/visibility_levels_correlated.comp");
/// What blocks in squares of the mask.
pub const SQUARES: Module = module!("occlusion_textures/squares.comp");
/// Which tiles of pixels meet nothing in any slice, by those.
pub const SLICE_TILES_LEVELS: Module = module!("occlusion_textures/tiles_levels.comp");
/// The visible fraction at the pixels of listed tiles, from levels of means.
pub const LISTED_LEVELS: Module = module!("occlusion_textures/listed_levels.comp");
/// The same by what slices have in common.
pub const LISTED_LEVELS_CORRELATED: Module =
    module!("occlusion_textures/listed_levels_correlated.comp");
/// Samples evenly along a line.
pub const LINE_SPREAD: Module = module!("linear_light/spread.comp");
/// Positions as a line's middle sees them.
pub const MIDDLE_VERT: Module = module!("linear_light/middle.vert");
/// Positions as a sample sees them.
pub const SAMPLE_VERT: Module = module!("linear_light/sample.vert");
/// What it sees, into a layer.
pub const LINE_TAKE: Module = module!("linear_light/take.comp");
/// What receivers see of a line.
pub const LINE_MASK: Module = module!("linear_light/mask.comp");
/// Samples where light is lost.
pub const LINE_PLACE: Module = module!("linear_light/place.comp");
/// A sample and the segment before it.
pub const SKIN_START: Module = module!("linear_light/start.comp");
/// Where occluders end, to skins.
pub const EDGES: Module = module!("linear_light/edges.comp");
/// A skin as the neighbouring sample sees it.
pub const SKINS_VERT: Module = module!("linear_light/skins.vert");
/// What lies behind it sees of the segment.
pub const SKINS_FRAG: Module = module!("linear_light/skins.frag");
/// A sample's map as pixels ask for it.
pub const KEEP: Module = module!("linear_light/keep.comp");
/// The samples' parts of each pixel, summed.
pub const LINE_VISIBILITY: Module = module!("linear_light/visibility.comp");
/// The soft shadow map projected onto the G-buffer.
pub const RESOLVE: Module = module!("visibility/resolve.comp");
/// An empty list of tiles.
pub const TILES_START: Module = module!("visibility/tiles_start.comp");
/// Everything lit.
pub const LIT: Module = module!("visibility/lit.comp");
/// The same in color.
pub const LIT_COLOR: Module = module!("visibility/lit_color.comp");

/// Every module of the node's passes.
pub const ALL: &[Module] = &[
    DEPTH_VERT,
    TAKE,
    HARD,
    PCSS,
    PCSS_TILES,
    PCSS_SORT,
    NEAREST,
    FINEST_LEVEL,
    NEXT_LEVEL,
    BACK_PROJECTION,
    RECEIVERS,
    ADD_POINT,
    AVERAGE,
    BLOCKS,
    SUPERBLOCKS,
    GATHER_MAP,
    GATHER_PIXELS,
    GATHER_TILES,
    TILES,
    PATCH_COUNT,
    PATCH_SCAN,
    PATCH_EMIT,
    PATCH_VERT,
    PATCH_FRAG,
    COLUMNS,
    LEVEL,
    LEVEL_ANY,
    START,
    CLASSIFY,
    CLASSIFY_ANY,
    TRACE,
    TRACE_ANY,
    FILTER_ROWS,
    FILTER_COLUMNS,
    CLASSIFY_COLOR,
    TRACE_TEXTURED,
    TRACE_COLOR,
    FILTER_ROWS_COLOR,
    FILTER_COLUMNS_COLOR,
    PLACE,
    HISTOGRAM_START,
    HISTOGRAM,
    PLACE_FITTED,
    SLICE,
    SLICE_LOWER,
    MASK,
    SUM_ROWS,
    SUM_COLUMNS,
    VISIBILITY_SAT,
    VISIBILITY_SAT_CORRELATED,
    SLICE_TILES_SAT,
    SLICE_TILES_SAT_CORRELATED,
    LISTED_SAT,
    LISTED_SAT_CORRELATED,
    MEANS_FIRST_LEVEL,
    MEANS_NEXT_LEVEL,
    VISIBILITY_LEVELS,
    VISIBILITY_LEVELS_CORRELATED,
    SQUARES,
    SLICE_TILES_LEVELS,
    LISTED_LEVELS,
    LISTED_LEVELS_CORRELATED,
    LINE_SPREAD,
    MIDDLE_VERT,
    SAMPLE_VERT,
    LINE_TAKE,
    LINE_MASK,
    LINE_PLACE,
    SKIN_START,
    EDGES,
    SKINS_VERT,
    SKINS_FRAG,
    KEEP,
    LINE_VISIBILITY,
    RESOLVE,
    TILES_START,
    LIT,
    LIT_COLOR,
];
