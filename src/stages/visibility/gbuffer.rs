//! The host's G-buffer as passes over its pixels read it.

use crate::graph::{Access, Graph, Need, Pass, ResourceId, Use};
use bytemuck::{Pod, Zeroable};

/// The binding of the lent normals (`light_space.glsl`), behind all that passes bind of their own.
const NORMAL_AT: u8 = 18;
/// The binding of the constants.
const CONSTANTS_AT: u8 = 19;

/// The host's G-buffer, as resources of the graph.
#[derive(Clone, Copy, Debug)]
pub struct GBuffer {
    /// The depth image, as the host's camera sees the scene.
    pub depth: ResourceId,
    /// The image of roles: red 1 blocks and receives, ½ receives only, 0 receives nothing. Without it every pixel has
    /// 1.
    pub mask: Option<ResourceId>,
    /// The image of the surfaces' normals.
    pub normal: Option<ResourceId>,
    /// The buffer of [`Constants`].
    pub constants: ResourceId,
    /// Width and height in pixels.
    pub extent: [u32; 2],
    /// The depth of a pixel that shows no surface.
    pub background: f32,
}

/// The numbers of camera and G-buffer that all passes over the pixels read (`light_space.glsl`).
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Constants {
    /// Normalized device coordinates to light space, by column.
    pub light_from_ndc: [f32; 16],
    /// The space of the lent normals to light space, by column; the fourth number of each is not read.
    pub light_from_normal: [[f32; 4]; 3],
    /// The G-buffer's width and height.
    pub extent: [i32; 2],
    /// The depth of a pixel that shows no surface.
    pub background: f32,
    /// Bit 0: there is a mask; bits 1 to 3: the [encoding](crate::NormalEncoding) of lent normals, 0 without them.
    pub flags: i32,
}

impl Constants {
    /// Adds the buffer that holds the constants.
    pub(crate) fn declare(graph: &mut Graph) -> ResourceId {
        graph.buffer("gbuffer.constants", size_of::<Self>() as u64)
    }

    /// Adds the pass that writes the constants.
    pub(crate) fn write(&self, graph: &mut Graph, buffer: ResourceId, need: &Need) {
        graph.push(Pass::constants("gbuffer.constants", buffer, 0, self, need));
    }
}

impl GBuffer {
    /// The uses of depth and mask at bindings 0 and 1; without a mask the depth is bound there and not read.
    pub fn bound(&self) -> [Use; 2] {
        [
            Use::bound(0, self.depth, Access::SampledCompute),
            Use::bound(1, self.mask.unwrap_or(self.depth), Access::SampledCompute),
        ]
    }

    /// The uses of everything that tells a pixel's place, plane and role: depth, mask, normals and constants. Where an
    /// image is not lent, the depth is bound in its place and not read.
    pub(crate) fn all_bound(&self) -> [Use; 4] {
        let [depth, mask] = self.bound();
        let normal = self.normal.unwrap_or(self.depth);
        [depth, mask, Use::bound(NORMAL_AT, normal, Access::SampledCompute), self.constants_use()]
    }

    /// The use of the constants alone.
    pub(crate) fn constants_use(&self) -> Use {
        Use::bound(CONSTANTS_AT, self.constants, Access::Uniform)
    }
}
