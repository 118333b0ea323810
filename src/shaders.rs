//! The shaders, embedded, each stated once, room by room.
//!
//! The words come from `spirv/`, which is compiled from `glsl/` and committed; a test recompiles
//! every module and compares the bytes. A file that is compiled more than once has its modules in
//! `glsl/permutations.txt`.

/// One SPIR-V module with the entry point `main`.
#[derive(Clone, Copy)]
pub struct Module {
    /// Its path under `spirv/`, without `.spv`.
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

/// Constants of the modules, and [`ALL`] of them.
macro_rules! modules {
    ($($(#[$doc:meta])* $name:ident = $path:literal;)*) => {
        $($(#[$doc])* pub const $name: Module = module!($path);)*

        /// Every module of the node's passes.
        pub const ALL: &[Module] = &[$($name),*];
    };
}

modules! {
    /// Vertices to clip space, for depth alone.
    DEPTH_VERT = "depth_layers/depth.vert";
    /// A host's occluder map to a layer.
    COPY_MAP = "depth_layers/copy_map.comp";

    /// The largest w of squares of texels.
    NEAREST = "common/nearest.comp";

    /// A hard shadow map, 3×3 filtered.
    HARD = "hard/hard.comp";

    /// Percentage-closer soft shadows.
    PCSS = "pcss/pcss.comp";
    /// Percentage-closer soft shadows at the pixels of listed tiles.
    PCSS_TILES = "pcss/pcss_listed.comp";
    /// Lists the tiles of pixels that find a blocker.
    PCSS_SORT = "pcss/tiles.comp";

    /// The least and largest w of 2×2 texels.
    FINEST_LEVEL = "back_projection/finest_level.comp";
    /// A level of least and largest w from the level before.
    NEXT_LEVEL = "back_projection/next_level.comp";
    /// Texels projected back onto the light.
    BACK_PROJECTION = "back_projection/back_projection.comp";

    /// The G-buffer in light space.
    RECEIVERS = "many_lights/receivers.comp";
    /// Whether each pixel sees one point of the light.
    ADD_POINT = "many_lights/add_point.comp";
    /// The share of the points that each pixel sees.
    AVERAGE = "many_lights/average.comp";

    /// Occluder map to blocks of texels with their moments.
    BLOCKS = "soft_shadow_map/blocks.comp";
    /// Blocks to superblocks.
    SUPERBLOCKS = "soft_shadow_map/superblocks.comp";
    /// The hierarchical gather at the receiver map's texels.
    GATHER_MAP = "soft_shadow_map/gather_map.comp";
    /// The hierarchical gather at the G-buffer's pixels.
    GATHER_PIXELS = "soft_shadow_map/gather_pixels.comp";
    /// The hierarchical gather at the pixels of listed tiles.
    GATHER_TILES = "soft_shadow_map/gather_pixels_listed.comp";
    /// Lists the tiles of pixels that an occluder affects, by blocks of the map.
    TILES = "soft_shadow_map/tiles.comp";
    /// Occupied texels of each group of blocks.
    PATCH_COUNT = "soft_shadow_map/patch_count.comp";
    /// Group counts to offsets, and the draw's arguments.
    PATCH_SCAN = "soft_shadow_map/patch_scan.comp";
    /// Blocks to a buffer of micro-patches.
    PATCH_EMIT = "soft_shadow_map/patch_emit.comp";
    /// A micro-patch to its penumbra rectangle.
    PATCH_VERT = "soft_shadow_map/patch.vert";
    /// A micro-patch's occlusion at a receiver texel.
    PATCH_FRAG = "soft_shadow_map/patch.frag";

    /// Depth layers to columns of what is solid.
    COLUMNS = "ray_march/columns.comp";
    /// The bounds of a level's windows.
    LEVEL = "ray_march/level.comp";
    /// The bounds of a level's windows, for any kind of windows.
    LEVEL_ANY = "ray_march/level_any.comp";
    /// An empty list of pixels.
    START = "ray_march/start.comp";
    /// Which pixels need rays.
    CLASSIFY = "ray_march/classify.comp";
    /// Which pixels need rays, with any settings.
    CLASSIFY_ANY = "ray_march/classify_any.comp";
    /// Which pixels need rays, in color.
    CLASSIFY_COLOR = "ray_march/classify_color.comp";
    /// The rays of the listed pixels.
    TRACE = "ray_march/trace.comp";
    /// The rays of the listed pixels, with any settings.
    TRACE_ANY = "ray_march/trace_any.comp";
    /// The rays of the listed pixels, weighed by what the light emits.
    TRACE_TEXTURED = "ray_march/trace_textured.comp";
    /// The rays of the listed pixels, weighed by what the light emits, in color.
    TRACE_COLOR = "ray_march/trace_color.comp";
    /// The listed pixels, filtered along rows.
    FILTER_ROWS = "ray_march/filter_rows.comp";
    /// The listed pixels, filtered along rows, in color.
    FILTER_ROWS_COLOR = "ray_march/filter_rows_color.comp";
    /// The listed pixels, filtered along columns.
    FILTER_COLUMNS = "ray_march/filter_columns.comp";
    /// The listed pixels, filtered along columns, in color.
    FILTER_COLUMNS_COLOR = "ray_march/filter_columns_color.comp";

    /// Where slices begin and end.
    PLACE = "occlusion_textures/place.comp";
    /// An empty histogram of distances.
    HISTOGRAM_START = "occlusion_textures/histogram_start.comp";
    /// How many texels have a face in each bin of distances.
    HISTOGRAM = "occlusion_textures/histogram.comp";
    /// Where slices begin and end, by a histogram of distances.
    PLACE_FITTED = "occlusion_textures/place_fitted.comp";
    /// Faces counted in the first sixteen slices.
    SLICE = "occlusion_textures/slice.frag";
    /// Faces counted in the slices from the seventeenth on.
    SLICE_LOWER = "occlusion_textures/slice_lower.frag";
    /// Counted faces to a bit a slice.
    MASK = "occlusion_textures/mask.comp";
    /// Summed-area tables along rows.
    SUM_ROWS = "occlusion_textures/sum_rows.comp";
    /// Summed-area tables along columns.
    SUM_COLUMNS = "occlusion_textures/sum_columns.comp";
    /// Means of the smallest windows of slices.
    MEANS_FIRST_LEVEL = "occlusion_textures/first_level.comp";
    /// Means of a level's windows.
    MEANS_NEXT_LEVEL = "occlusion_textures/next_level.comp";
    /// What blocks in squares of the mask.
    SQUARES = "occlusion_textures/squares.comp";
    /// Lists the tiles of pixels that meet something in a slice, by summed-area tables.
    SLICE_TILES_SAT = "occlusion_textures/tiles_sat.comp";
    /// Lists the tiles of pixels that meet something, by tables of correlated slices.
    SLICE_TILES_SAT_CORRELATED = "occlusion_textures/tiles_sat_correlated.comp";
    /// Lists the tiles of pixels that meet something in a slice, by squares of the mask.
    SLICE_TILES_LEVELS = "occlusion_textures/tiles_levels.comp";
    /// The visible fraction from summed-area tables of slices.
    VISIBILITY_SAT = "occlusion_textures/visibility_sat.comp";
    /// The visible fraction from summed-area tables, by what slices have in common.
    VISIBILITY_SAT_CORRELATED = "occlusion_textures/visibility_sat_correlated.comp";
    /// The visible fraction from levels of means of slices.
    VISIBILITY_LEVELS = "occlusion_textures/visibility_levels.comp";
    /// The visible fraction from levels of means, by what slices have in common.
    VISIBILITY_LEVELS_CORRELATED = "occlusion_textures/visibility_levels_correlated.comp";
    /// The visible fraction at the pixels of listed tiles, from summed-area tables.
    LISTED_SAT = "occlusion_textures/visibility_listed_sat.comp";
    /// The visible fraction at the pixels of listed tiles, from tables of correlated slices.
    LISTED_SAT_CORRELATED = "occlusion_textures/visibility_listed_sat_correlated.comp";
    /// The visible fraction at the pixels of listed tiles, from levels of means.
    LISTED_LEVELS = "occlusion_textures/visibility_listed_levels.comp";
    /// The visible fraction at the pixels of listed tiles, from levels of correlated slices.
    LISTED_LEVELS_CORRELATED = "occlusion_textures/visibility_listed_levels_correlated.comp";

    /// Samples evenly along a line.
    LINE_SPREAD = "linear_light/spread.comp";
    /// Vertices as a line's middle sees them.
    MIDDLE_VERT = "linear_light/middle.vert";
    /// Vertices as a sample sees them.
    SAMPLE_VERT = "linear_light/sample.vert";
    /// What a sample sees, into a layer.
    LINE_COPY = "linear_light/copy_depth.comp";
    /// What receivers see of a line.
    LINE_MASK = "linear_light/mask.comp";
    /// Samples where light is lost.
    LINE_PLACE = "linear_light/place.comp";
    /// A sample and the segment before it.
    SKIN_START = "linear_light/start.comp";
    /// Where occluders end, to skins.
    EDGES = "linear_light/edges.comp";
    /// A skin as the neighbouring sample sees it.
    SKINS_VERT = "linear_light/skins.vert";
    /// What lies behind a skin sees of the segment.
    SKINS_FRAG = "linear_light/skins.frag";
    /// A sample's map as pixels read it.
    KEEP = "linear_light/keep.comp";
    /// The samples' parts of each pixel, summed.
    LINE_VISIBILITY = "linear_light/visibility.comp";

    /// The soft shadow map projected onto the G-buffer.
    RESOLVE = "visibility/resolve.comp";
    /// An empty list of tiles.
    TILES_START = "visibility/tiles_start.comp";
    /// Every pixel fully lit.
    LIT = "visibility/lit.comp";
    /// Every pixel fully lit, in color.
    LIT_COLOR = "visibility/lit_color.comp";
}
