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

/// The module of a path under `spirv/`, which a pass names where it is declared.
macro_rules! module {
    ($path:literal) => {
        $crate::shaders::Module {
            path: $path,
            spirv: include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/spirv/", $path, ".spv")),
        }
    };
}

pub(crate) use module;

/// Transforms vertices to clip space, for depth alone.
pub const DEPTH_VERT: Module = module!("depth_layers/depth.vert");

/// [`DEPTH_VERT`] for meshes that textures cut out.
pub const DEPTH_CUT_VERT: Module = module!("depth_layers/depth_cut.vert");

/// Leaves out what opacity textures let the light through at, for depth alone.
pub const CUT_FRAG: Module = module!("cut_outs/depth.frag");

/// Computes a micro-patch's occlusion at a receiver texel.
pub const PATCH_FRAG: Module = module!("soft_shadow_map/patch.frag");

/// Traces the rays of the listed pixels, for the usual settings.
pub const TRACE: Module = module!("ray_march/trace.comp");

/// Writes a visible fraction of 1 to every pixel.
pub const LIT: Module = module!("visibility/lit.comp");
