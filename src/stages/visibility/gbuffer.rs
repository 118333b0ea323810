//! The host's G-buffer as passes over its pixels read it.

use crate::graph::{Access, Graph, Need, Pass, ResourceId, Use};
use bytemuck::{Pod, Zeroable};
use glam::{DMat4, DVec3};

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
    /// A plane of column, row and depth to its normal's x, y and z in light space ([`plane_to_normal`]).
    pub plane_to_normal: [[f32; 4]; 3],
    /// The G-buffer's width and height.
    pub extent: [i32; 2],
    /// The depth of a pixel that shows no surface.
    pub background: f32,
    /// Bit 0: there is a mask; bits 1 to 3: the [encoding](crate::NormalEncoding) of lent normals, 0 without them.
    pub flags: i32,
}

/// The numbers behind [`Constants`] that passes over the pixels read where normals are lent.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct NormalConstants {
    /// The space of the lent normals to light space, by column; the fourth number of each is not read.
    pub light_from_normal: [[f32; 4]; 3],
}

/// A plane (a, b, c, d) of the image, which holds what a column + b row + c depth + d is 0 of, to x, y and z of its
/// normal in light space, on the viewer's side: the inverse's transpose, as for all planes, of which a normal takes
/// three rows. The largest number is 1.
///
/// The viewer is where column and row do not matter, at depth infinity, or in that direction for an orthographic camera.
pub(crate) fn plane_to_normal(
    light_from_ndc: &DMat4,
    ndc_from_light: &DMat4,
    extent: [u32; 2],
    background: f32,
) -> [[f32; 4]; 3] {
    let [width, height] = extent.map(f64::from);
    let first = DVec3::new(1.0 / width - 1.0, 1.0 / height - 1.0, 0.0);
    let ndc_from_pixel = DMat4::from_translation(first)
        * DMat4::from_scale(DVec3::new(2.0 / width, 2.0 / height, 1.0));
    let inverse = ndc_from_pixel.inverse() * *ndc_from_light;
    let columns = [inverse.x_axis, inverse.y_axis, inverse.z_axis];
    let eye = light_from_ndc.z_axis.w as f32;
    let is_towards = if eye == 0.0 { background != 0.0 } else { eye < 0.0 };
    let most = columns.iter().fold(0.0, |most, column| column.abs().max_element().max(most));
    let scale = if is_towards { 1.0 / most } else { -1.0 / most };
    columns.map(|column| (scale * column).as_vec4().to_array())
}

impl Constants {
    /// Adds the buffer that holds the constants.
    pub(crate) fn declare(graph: &mut Graph) -> ResourceId {
        let bytes = size_of::<Self>() + size_of::<NormalConstants>();
        graph.buffer("gbuffer.constants", bytes as u64)
    }

    /// Adds the pass that writes the constants, and where normals are lent the one that writes theirs.
    pub(crate) fn write(
        &self,
        normals: Option<&NormalConstants>,
        graph: &mut Graph,
        buffer: ResourceId,
        need: &Need,
    ) {
        graph.push(Pass::constants("gbuffer.constants", buffer, 0, self, need));
        if let Some(normals) = normals {
            let behind = size_of::<Self>() as u64;
            graph.push(Pass::constants("gbuffer.normals", buffer, behind, normals, need));
        }
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
