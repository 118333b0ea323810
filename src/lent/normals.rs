//! The normals of the host's G-buffer.

use crate::Error;
use crate::graph::is_color_format;
use ash::vk::{self, Format as F};

/// The image of the surfaces' normals in the host's G-buffer, and what its texels mean.
///
/// The normals are those of the triangles, of any length and on either side. Normals that are interpolated between
/// vertices, or bent by a normal map, make shadows worse than none: light ends at the triangle's plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Normals {
    /// The image's format: a color format that a shader reads as floats, with as many channels as the encoding reads.
    pub format: vk::Format,
    /// How a texel holds a normal.
    pub encoding: NormalEncoding,
}

/// How a texel holds a normal; lengths and sides do not matter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum NormalEncoding {
    /// x, y and z are red, green and blue, from −1 to 1: signed and float formats.
    Signed,
    /// x, y and z are red, green and blue times 2 less 1, from 0 to 1: unsigned formats.
    Unsigned,
    /// The octahedron's surface, unfolded into a square, is red and green, from −1 to 1 (Meyer et al. 2010; Cigolle et
    /// al. 2014, section 3): n / (|x| + |y| + |z|), and where z is below 0 the corners folded over the edges.
    OctahedralSigned,
    /// The unfolded octahedron from 0 to 1: twice red and green, less 1.
    OctahedralUnsigned,
}

impl NormalEncoding {
    fn is_octahedral(self) -> bool {
        matches!(self, Self::OctahedralSigned | Self::OctahedralUnsigned)
    }

    fn is_signed(self) -> bool {
        matches!(self, Self::Signed | Self::OctahedralSigned)
    }
}

impl Normals {
    /// The encoding's number in the shaders' flags; 0 where no normals are lent.
    pub(crate) fn code(of: Option<Self>) -> i32 {
        match of.map(|normals| normals.encoding) {
            None => 0,
            Some(NormalEncoding::Signed) => 1,
            Some(NormalEncoding::Unsigned) => 2,
            Some(NormalEncoding::OctahedralSigned) => 3,
            Some(NormalEncoding::OctahedralUnsigned) => 4,
        }
    }

    /// Checks that the format can hold the encoding.
    ///
    /// # Errors
    /// [`Error::Frame`] for a format without color, with too few channels, or without numbers below 0 where some are.
    pub(crate) fn check(&self) -> Result<(), Error> {
        let Self { format, encoding } = *self;
        let bad = |what: String| Err(Error::Frame(what));
        if !is_color_format(format) {
            return bad(format!(
                "the normals' format {format:?} holds no color that a shader reads as floats"
            ));
        }
        if lacks_green(format) || (lacks_blue(format) && !encoding.is_octahedral()) {
            return bad(format!(
                "the normals' format {format:?} has fewer channels than the encoding {encoding:?} reads; octahedral ones \
                 read two, the others three"
            ));
        }
        if encoding.is_signed() && is_unsigned(format) {
            return bad(format!(
                "the normals' format {format:?} holds nothing below 0, which the encoding {encoding:?} needs; say \
                 Unsigned or OctahedralUnsigned"
            ));
        }
        Ok(())
    }
}

/// Whether a color format has one channel.
fn lacks_green(format: vk::Format) -> bool {
    matches!(
        format,
        F::R8_UNORM
            | F::R8_SNORM
            | F::R8_USCALED
            | F::R8_SSCALED
            | F::R8_SRGB
            | F::R16_UNORM
            | F::R16_SNORM
            | F::R16_USCALED
            | F::R16_SSCALED
            | F::R16_SFLOAT
            | F::R32_SFLOAT
    )
}

/// Whether a color format has two channels or one.
fn lacks_blue(format: vk::Format) -> bool {
    lacks_green(format)
        || matches!(
            format,
            F::R8G8_UNORM
                | F::R8G8_SNORM
                | F::R8G8_USCALED
                | F::R8G8_SSCALED
                | F::R8G8_SRGB
                | F::R16G16_UNORM
                | F::R16G16_SNORM
                | F::R16G16_USCALED
                | F::R16G16_SSCALED
                | F::R16G16_SFLOAT
                | F::R32G32_SFLOAT
        )
}

/// Whether a format of those that G-buffers use for normals holds nothing below 0.
fn is_unsigned(format: vk::Format) -> bool {
    matches!(
        format,
        F::R8G8_UNORM
            | F::R16G16_UNORM
            | F::R8G8B8A8_UNORM
            | F::B8G8R8A8_UNORM
            | F::A8B8G8R8_UNORM_PACK32
            | F::A2R10G10B10_UNORM_PACK32
            | F::A2B10G10R10_UNORM_PACK32
            | F::R16G16B16A16_UNORM
            | F::B10G11R11_UFLOAT_PACK32
            | F::R8G8B8A8_SRGB
            | F::B8G8R8A8_SRGB
    )
}
