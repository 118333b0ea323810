//! A G-buffer: depth, world position, normal, role and plane of each pixel.

use crate::painter::{Painter, SceneDraw, draws};
use crate::raster::{COLOR_LAYOUT, DEPTH, DEPTH_LAYOUT};
use crate::shaders::GBUFFER_FRAG;
use crate::{HeadlessDevice, OwnedImage, SceneBuffers, View};
use antumbra::graph::Scope;
use antumbra::scene::{Instance, Scene};
use antumbra::{Error, HostImage, NormalEncoding, Normals};
use ash::vk;
use half::f16;
use std::time::Duration;

const VECTOR: vk::Format = vk::Format::R32G32B32A32_SFLOAT;
const PLANE: vk::Format = vk::Format::R16G16B16A16_SFLOAT;
/// The roles' format: 255 blocks and receives, 128 receives only, 0 receives nothing.
pub(crate) const MASK: vk::Format = vk::Format::R8_UNORM;

/// The images, all of one size.
pub struct GBuffer {
    /// Reversed depth, D32_SFLOAT.
    pub depth: OwnedImage,
    /// World position in metres; 0 on background.
    pub position: OwnedImage,
    /// Unit world normal; 0 on background.
    pub normal: OwnedImage,
    /// Role; 0 on background.
    pub mask: OwnedImage,
    /// Unit world normal of the triangle, on either side; 0 on background.
    pub plane: OwnedImage,
}

/// Lends an image, and takes it back to be copied out in the layout that it is kept in.
fn lend(image: &OwnedImage, before: Scope) -> HostImage {
    image.lend(before, Scope::COPIED_FROM.in_layout(before.layout))
}

impl GBuffer {
    /// Images of a size, not yet painted.
    ///
    /// # Errors
    /// See [`OwnedImage::new`].
    pub fn new(device: &HeadlessDevice, extent: [u32; 2]) -> Result<Self, Error> {
        use vk::ImageUsageFlags as Usage;
        let color = Usage::COLOR_ATTACHMENT | Usage::SAMPLED;
        let depth = Usage::DEPTH_STENCIL_ATTACHMENT | Usage::SAMPLED;
        Ok(Self {
            depth: OwnedImage::new(device, "gbuffer.depth", DEPTH, extent, depth)?,
            position: OwnedImage::new(device, "gbuffer.position", VECTOR, extent, color)?,
            normal: OwnedImage::new(device, "gbuffer.normal", VECTOR, extent, color)?,
            mask: OwnedImage::new(device, "gbuffer.mask", MASK, extent, color)?,
            plane: OwnedImage::new(device, "gbuffer.plane", PLANE, extent, color)?,
        })
    }

    /// The depth image as the node takes it, left by the G-buffer's render pass.
    pub fn depth_for_node(&self) -> HostImage {
        lend(&self.depth, Scope::DEPTH_DRAWN.in_layout(DEPTH_LAYOUT))
    }

    /// The mask as the node takes it.
    pub fn mask_for_node(&self) -> HostImage {
        lend(&self.mask, Scope::COLOR_DRAWN.in_layout(COLOR_LAYOUT))
    }

    /// How the triangles' normals are stored.
    pub const NORMALS: Normals = Normals { format: PLANE, encoding: NormalEncoding::Signed };

    /// The triangles' normals as the node takes them.
    pub fn normals_for_node(&self) -> HostImage {
        lend(&self.plane, Scope::COLOR_DRAWN.in_layout(COLOR_LAYOUT))
    }

    /// Reads world positions, row by row.
    ///
    /// # Errors
    /// See [`OwnedImage::read`].
    pub fn positions(&self) -> Result<Vec<[f32; 4]>, Error> {
        self.position.read(COLOR_LAYOUT)
    }

    /// Reads world normals, row by row.
    ///
    /// # Errors
    /// See [`OwnedImage::read`].
    pub fn normals(&self) -> Result<Vec<[f32; 4]>, Error> {
        self.normal.read(COLOR_LAYOUT)
    }

    /// Reads the triangles' world normals as they are lent, of which each may be on either side, row by row.
    ///
    /// # Errors
    /// See [`OwnedImage::read`].
    pub fn planes(&self) -> Result<Vec<[f32; 4]>, Error> {
        let halves: Vec<[u16; 4]> = self.plane.read(COLOR_LAYOUT)?;
        Ok(halves.iter().map(|n| n.map(|bits| f16::from_bits(bits).into())).collect())
    }

    /// Reads roles, row by row.
    ///
    /// # Errors
    /// See [`OwnedImage::read`].
    pub fn roles(&self) -> Result<Vec<u8>, Error> {
        self.mask.read(COLOR_LAYOUT)
    }
}

/// Draws G-buffers.
pub struct GBufferPainter {
    painter: Painter,
}

impl GBufferPainter {
    /// Makes the render pass and the pipeline; viewports are set while drawing.
    ///
    /// # Errors
    /// [`Error::Vulkan`] where the driver refuses.
    pub fn new(device: &HeadlessDevice) -> Result<Self, Error> {
        let colors = [VECTOR, VECTOR, MASK, PLANE];
        Ok(Self { painter: Painter::new(device, &colors, 0.0, GBUFFER_FRAG, true, None)? })
    }

    /// Paints the instances that `keep` accepts, submits and waits.
    ///
    /// # Errors
    /// [`Error::Vulkan`] where the driver refuses.
    pub fn paint(
        &self,
        gbuffer: &GBuffer,
        scene: &Scene,
        buffers: &SceneBuffers,
        view: &View,
        keep: impl Fn(&Instance) -> bool,
    ) -> Result<(), Error> {
        self.paint_draws(gbuffer, &draws(scene, buffers, view, keep)).map(drop)
    }

    /// Paints draws that are ready, and returns the time from the submit to the fence; see [`Self::paint`].
    pub(crate) fn paint_draws(
        &self,
        gbuffer: &GBuffer,
        draws: &[SceneDraw],
    ) -> Result<Duration, Error> {
        let GBuffer { depth, position, normal, mask, plane } = gbuffer;
        let images = [position, normal, mask, plane, depth];
        self.painter.paint(&images, draws)
    }
}
