//! The rasters' shaders, compiled with those of the library: `glsl/headless/` and `spirv/headless/`.

use antumbra::shaders::Module;

macro_rules! module {
    ($name:literal) => {
        Module {
            path: concat!("headless/", $name),
            spirv: include_bytes!(concat!("../../spirv/headless/", $name, ".spv")),
        }
    };
}

/// Positions and normals of a mesh, for the G-buffer and for forward evaluation.
pub const GBUFFER_VERT: Module = module!("gbuffer.vert");
/// Position, normal and role of a pixel.
pub const GBUFFER_FRAG: Module = module!("gbuffer.frag");
/// [`GBUFFER_VERT`] for meshes that textures cut out.
pub const GBUFFER_CUT_VERT: Module = module!("gbuffer_cut.vert");
/// [`GBUFFER_FRAG`] for meshes that textures cut out.
pub const GBUFFER_CUT_FRAG: Module = module!("gbuffer_cut.frag");
/// Penumbra rectangles that the processor made.
pub const QUADS_VERT: Module = module!("quads.vert");
/// The rays of a fragment.
pub const FORWARD_FRAG: Module = module!("forward.frag");
