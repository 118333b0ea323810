//! The texture that says where a mesh stops light.

use crate::Error;
use ash::vk;
use std::hash::{Hash, Hasher};

/// How an image goes on beyond its edges (glTF 2.0 §5.26).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// The image begins anew.
    #[default]
    Repeat,
    /// The image begins anew, each time mirrored.
    Mirror,
    /// The image's edge goes on.
    Clamp,
}

/// A host's image whose alpha says where a mesh stops light, and the texture coordinates of the mesh's vertices.
///
/// Each place of the mesh is looked up in the view's first mip level alone: a texel of a shadow map stands for one ray,
/// and coarser levels would average alpha before it is compared with the cutoff.
///
/// The node records no barrier for image and coordinates: what the host wrote to them must be visible to shader reads of
/// the vertex (coordinates), fragment (image) and compute stages (both).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpacityTexture {
    /// A 2D view of an image with SAMPLED usage, of a format that shaders read as floats, whose alpha is the opacity; a
    /// swizzle of the view makes it another component.
    pub view: vk::ImageView,
    /// The width and height of the view's first mip level in texels, each above 0.
    pub extent: [u32; 2],
    /// The image's layout: `SHADER_READ_ONLY_OPTIMAL` or `GENERAL`.
    pub layout: vk::ImageLayout,
    /// How the image goes on along u and v.
    pub wrap: [Wrap; 2],
    /// Between texels' centres alpha is interpolated; otherwise each texel is a square.
    pub linear: bool,
    /// Is multiplied with alpha: a material's own, 0..1.
    pub factor: f32,
    /// The mesh stops all light where the product is this or more, and none elsewhere; without a cutoff it stops the part
    /// of the light that the product is.
    pub cutoff: Option<f32>,
    /// The buffer of texture coordinates, two 32-bit floats each, one a vertex, with `STORAGE_BUFFER` usage.
    pub coordinates: vk::Buffer,
    /// Where in it the first is, in bytes: a multiple of 4.
    pub coordinates_offset: u64,
    /// Bytes from one to the next: a multiple of 4 from 8 to 4092.
    pub coordinates_stride: u32,
    /// From the buffer's coordinates to those of the image, where (0, 0) is the first texel's corner and (1, 1) the last
    /// one's: a row for u and a row for v, each to be multiplied with (u, v, 1).
    pub transform: [[f32; 3]; 2],
}

impl OpacityTexture {
    /// An image in `SHADER_READ_ONLY_OPTIMAL` that repeats, interpolated, with a cutoff of ½, and coordinates that lie
    /// tightly packed from a buffer's start on.
    pub fn new(view: vk::ImageView, extent: [u32; 2], coordinates: vk::Buffer) -> Self {
        Self {
            view,
            extent,
            layout: vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL,
            wrap: [Wrap::Repeat; 2],
            linear: true,
            factor: 1.0,
            cutoff: Some(0.5),
            coordinates,
            coordinates_offset: 0,
            coordinates_stride: 8,
            transform: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        }
    }

    /// Checks that shaders can read it; the sentence begins with the mesh's number.
    ///
    /// # Errors
    /// [`Error::Frame`] for the first thing that they cannot.
    pub(crate) fn check(&self, mesh: usize) -> Result<(), Error> {
        let bad = |what: String| Err(Error::Frame(format!("mesh {mesh}: its opacity {what}")));
        let Self { extent: [width, height], layout, coordinates_stride: stride, .. } = *self;
        if !(1..=16384).contains(&width) || !(1..=16384).contains(&height) {
            return bad(format!(
                "texture of {width}×{height} texels is outside 1×1 to 16384×16384"
            ));
        }
        if ![vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL, vk::ImageLayout::GENERAL].contains(&layout)
        {
            return bad(format!(
                "texture is in the layout {layout:?}; shaders read it in SHADER_READ_ONLY_OPTIMAL or GENERAL"
            ));
        }
        if !stride.is_multiple_of(4) || !(8..=4092).contains(&stride) {
            return bad(format!(
                "texture's coordinates have a stride of {stride} bytes; two floats take 8, and strides are multiples \
                 of 4 up to 4092"
            ));
        }
        if !self.coordinates_offset.is_multiple_of(4) {
            return bad(format!(
                "texture's coordinates begin at byte {}; they must begin at a multiple of 4",
                self.coordinates_offset
            ));
        }
        let numbers =
            self.transform.as_flattened().iter().chain(&self.cutoff).chain([&self.factor]);
        if !numbers.into_iter().all(|x| x.is_finite()) {
            return bad("texture's transform, factor and cutoff must be finite numbers".into());
        }
        Ok(())
    }

    /// Hashes everything that decides where light is stopped, but for what the image and the buffer hold.
    pub(crate) fn hash_into(&self, hasher: &mut impl Hasher) {
        (self.view, self.extent, self.wrap, self.linear).hash(hasher);
        (self.coordinates, self.coordinates_offset, self.coordinates_stride).hash(hasher);
        let bits = |x: &f32| x.to_bits();
        self.transform.as_flattened().iter().map(bits).for_each(|x| x.hash(hasher));
        (bits(&self.factor), self.cutoff.as_ref().map(bits)).hash(hasher);
    }
}
