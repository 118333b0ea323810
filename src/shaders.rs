//! The SPIR-V modules of the node's shaders, embedded in the crate and listed by room.
//!
//! The words come from `spirv/`, which is compiled from `glsl/` and committed; a test recompiles every module and
//! compares the bytes. `glsl/permutations.txt` lists the modules of a file that is compiled more than once.

/// One SPIR-V module with the entry point `main`.
#[derive(Clone, Copy)]
pub struct Module {
    /// The module's path under `spirv/`, without `.spv`.
    pub path: &'static str,
    /// The module's SPIR-V 1.0, as little-endian words.
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

/// Declares a constant for each module, and [`ALL`] of them.
macro_rules! modules {
    ($($(#[$doc:meta])* $name:ident = $path:literal;)*) => {
        $($(#[$doc])* pub const $name: Module = module!($path);)*

        /// Every module of the node's passes.
        pub const ALL: &[Module] = &[$($name),*];
    };
}

modules! {
    /// Transforms vertices to clip space, for depth alone.
    DEPTH_VERT = "depth_layers/depth.vert";
    /// Copies a host's occluder map to a depth layer.
    COPY_MAP = "depth_layers/copy_map.comp";

    /// Writes the largest w of squares of a map's texels.
    NEAREST = "common/nearest.comp";

    /// Computes the visible fraction by a hard shadow map with a 3×3 filter.
    HARD = "hard/hard.comp";

    /// Computes the visible fraction by percentage-closer soft shadows.
    PCSS = "pcss/pcss.comp";
    /// Computes percentage-closer soft shadows at the pixels of listed tiles.
    PCSS_TILES = "pcss/pcss_listed.comp";
    /// Lists the tiles of pixels that may find a blocker, for percentage-closer soft shadows.
    PCSS_SORT = "pcss/tiles.comp";

    /// Writes the least and largest w of 2×2 texels, for back-projection.
    FINEST_LEVEL = "back_projection/finest_level.comp";
    /// Writes a level of least and largest w from the level before it, for back-projection.
    NEXT_LEVEL = "back_projection/next_level.comp";
    /// Computes the visible fraction by projecting occluder texels back onto the light.
    BACK_PROJECTION = "back_projection/back_projection.comp";

    /// Writes the G-buffer in light space, for many lights.
    RECEIVERS = "many_lights/receivers.comp";
    /// Counts, for each pixel, whether one point of the light is hidden from it.
    ADD_POINT = "many_lights/add_point.comp";
    /// Writes the share of the light's points that each pixel sees.
    AVERAGE = "many_lights/average.comp";

    /// Converts an occluder map to blocks of texels with their moments, for soft shadow maps.
    BLOCKS = "soft_shadow_map/blocks.comp";
    /// Combines blocks of texels to superblocks, for soft shadow maps.
    SUPERBLOCKS = "soft_shadow_map/superblocks.comp";
    /// Gathers a soft shadow map hierarchically at the receiver map's texels.
    GATHER_MAP = "soft_shadow_map/gather_map.comp";
    /// Gathers the visible fraction hierarchically at the G-buffer's pixels.
    GATHER_PIXELS = "soft_shadow_map/gather_pixels.comp";
    /// Gathers the visible fraction hierarchically at the pixels of listed tiles.
    GATHER_TILES = "soft_shadow_map/gather_pixels_listed.comp";
    /// Lists the tiles of pixels that an occluder may shadow, by the blocks of a soft shadow map's occluders.
    TILES = "soft_shadow_map/tiles.comp";
    /// Counts the occupied texels of each group of blocks, to blend micro-patches.
    PATCH_COUNT = "soft_shadow_map/patch_count.comp";
    /// Turns the groups' counts into offsets, and writes the arguments of the micro-patches' draw.
    PATCH_SCAN = "soft_shadow_map/patch_scan.comp";
    /// Writes a buffer of micro-patches from blocks of texels.
    PATCH_EMIT = "soft_shadow_map/patch_emit.comp";
    /// Expands a micro-patch to its penumbra rectangle.
    PATCH_VERT = "soft_shadow_map/patch.vert";
    /// Computes a micro-patch's occlusion at a receiver texel.
    PATCH_FRAG = "soft_shadow_map/patch.frag";

    /// Converts depth layers to columns of solid matter, for ray marching.
    COLUMNS = "ray_march/columns.comp";
    /// Writes the bounds of an N-buffer level's windows, for ray marching.
    LEVEL = "ray_march/level.comp";
    /// Writes the bounds of a level's windows, for windows of any kind.
    LEVEL_ANY = "ray_march/level_any.comp";
    /// Empties the list of pixels that need rays.
    START = "ray_march/start.comp";
    /// Lists the pixels that need rays, for the usual settings.
    CLASSIFY = "ray_march/classify.comp";
    /// Lists the pixels that need rays, for any settings.
    CLASSIFY_ANY = "ray_march/classify_any.comp";
    /// Lists the pixels that need rays, with visible fractions in color.
    CLASSIFY_COLOR = "ray_march/classify_color.comp";
    /// Traces the rays of the listed pixels, for the usual settings.
    TRACE = "ray_march/trace.comp";
    /// Traces the rays of the listed pixels, for any settings.
    TRACE_ANY = "ray_march/trace_any.comp";
    /// Traces the rays of the listed pixels, weighed by the light's emission.
    TRACE_TEXTURED = "ray_march/trace_textured.comp";
    /// Traces the rays of the listed pixels, weighed by the light's emission, in color.
    TRACE_COLOR = "ray_march/trace_color.comp";
    /// Filters the noise of the listed pixels along rows of pixels.
    FILTER_ROWS = "ray_march/filter_rows.comp";
    /// Filters the noise of the listed pixels along rows of pixels, in color.
    FILTER_ROWS_COLOR = "ray_march/filter_rows_color.comp";
    /// Filters the noise of the listed pixels along columns of pixels.
    FILTER_COLUMNS = "ray_march/filter_columns.comp";
    /// Filters the noise of the listed pixels along columns of pixels, in color.
    FILTER_COLUMNS_COLOR = "ray_march/filter_columns_color.comp";

    /// Places slices of equal thickness, for occlusion textures.
    PLACE = "occlusion_textures/place.comp";
    /// Clears the histogram of the occluders' distances, for occlusion textures.
    HISTOGRAM_START = "occlusion_textures/histogram_start.comp";
    /// Counts the texels that have a face in each bin of distances, for occlusion textures.
    HISTOGRAM = "occlusion_textures/histogram.comp";
    /// Places slices by the histogram of the occluders' distances.
    PLACE_FITTED = "occlusion_textures/place_fitted.comp";
    /// Counts faces in the first sixteen slices.
    SLICE = "occlusion_textures/slice.frag";
    /// Counts faces in the slices from the seventeenth on.
    SLICE_LOWER = "occlusion_textures/slice_lower.frag";
    /// Converts counted faces to a mask of a bit a slice.
    MASK = "occlusion_textures/mask.comp";
    /// Sums slices along rows of texels, for summed-area tables.
    SUM_ROWS = "occlusion_textures/sum_rows.comp";
    /// Sums slices along columns of texels, for summed-area tables.
    SUM_COLUMNS = "occlusion_textures/sum_columns.comp";
    /// Writes the means of the smallest windows of slices.
    MEANS_FIRST_LEVEL = "occlusion_textures/first_level.comp";
    /// Writes the means of a level's windows of slices.
    MEANS_NEXT_LEVEL = "occlusion_textures/next_level.comp";
    /// Finds the slices that block in each square of the mask.
    SQUARES = "occlusion_textures/squares.comp";
    /// Lists the tiles of pixels that may meet an occluder in a slice, by summed-area tables.
    SLICE_TILES_SAT = "occlusion_textures/tiles_sat.comp";
    /// Lists the tiles of pixels that may meet an occluder in a slice, by summed-area tables of correlated slices.
    SLICE_TILES_SAT_CORRELATED = "occlusion_textures/tiles_sat_correlated.comp";
    /// Lists the tiles of pixels that may meet an occluder in a slice, by squares of the mask.
    SLICE_TILES_LEVELS = "occlusion_textures/tiles_levels.comp";
    /// Computes the visible fraction from summed-area tables of slices.
    VISIBILITY_SAT = "occlusion_textures/visibility_sat.comp";
    /// Computes the visible fraction from summed-area tables of slices, combined by their measured overlap.
    VISIBILITY_SAT_CORRELATED = "occlusion_textures/visibility_sat_correlated.comp";
    /// Computes the visible fraction from levels of means of slices.
    VISIBILITY_LEVELS = "occlusion_textures/visibility_levels.comp";
    /// Computes the visible fraction from levels of means of slices, combined by their measured overlap.
    VISIBILITY_LEVELS_CORRELATED = "occlusion_textures/visibility_levels_correlated.comp";
    /// Computes the visible fraction at the pixels of listed tiles, from summed-area tables of slices.
    LISTED_SAT = "occlusion_textures/visibility_listed_sat.comp";
    /// Computes the visible fraction at the pixels of listed tiles, from summed-area tables of correlated slices.
    LISTED_SAT_CORRELATED = "occlusion_textures/visibility_listed_sat_correlated.comp";
    /// Computes the visible fraction at the pixels of listed tiles, from levels of means of slices.
    LISTED_LEVELS = "occlusion_textures/visibility_listed_levels.comp";
    /// Computes the visible fraction at the pixels of listed tiles, from levels of means of correlated slices.
    LISTED_LEVELS_CORRELATED = "occlusion_textures/visibility_listed_levels_correlated.comp";

    /// Places samples evenly along a line, for linear lights.
    LINE_SPREAD = "linear_light/spread.comp";
    /// Transforms vertices to clip space, as the middle of a linear light's line sees them.
    MIDDLE_VERT = "linear_light/middle.vert";
    /// Transforms vertices to clip space, as a sample of a linear light's line sees them.
    SAMPLE_VERT = "linear_light/sample.vert";
    /// Copies the depths that a sample of a line sees into its layer.
    LINE_COPY = "linear_light/copy_depth.comp";
    /// Estimates the parts of a line that a grid of receivers sees.
    LINE_MASK = "linear_light/mask.comp";
    /// Places a line's samples where light is lost.
    LINE_PLACE = "linear_light/place.comp";
    /// Begins a sample of a line and the segment before it.
    SKIN_START = "linear_light/start.comp";
    /// Finds where occluders end in a sample's map, and writes skins.
    EDGES = "linear_light/edges.comp";
    /// Expands a skin to its strip in the neighbouring sample's map.
    SKINS_VERT = "linear_light/skins.vert";
    /// Computes the part of a segment that a surface behind a skin sees.
    SKINS_FRAG = "linear_light/skins.frag";
    /// Writes a sample's map in the form that pixels read.
    KEEP = "linear_light/keep.comp";
    /// Computes the visible fraction by summing the parts of all segments that each pixel sees.
    LINE_VISIBILITY = "linear_light/visibility.comp";

    /// Projects a soft shadow map onto the G-buffer's pixels.
    RESOLVE = "visibility/resolve.comp";
    /// Empties the list of tiles.
    TILES_START = "visibility/tiles_start.comp";
    /// Writes a visible fraction of 1 to every pixel.
    LIT = "visibility/lit.comp";
    /// Writes a visible fraction of 1 to every pixel, in color.
    LIT_COLOR = "visibility/lit_color.comp";
}
