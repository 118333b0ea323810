//! What the host lends for a frame: images, meshes, ready-made occluder maps.

mod normals;
mod opacity;

pub use normals::{NormalEncoding, Normals};
pub use opacity::{OpacityTexture, Wrap};

use crate::Error;
use crate::error::quoted;
use crate::graph::Scope;
use crate::plain::Matrix;
use ash::vk;
use glam::{DMat4, DVec3};
use std::fmt;
use std::str::FromStr;

/// Which of the frames in flight a frame is, 0 and up, below
/// [`Description::frames_in_flight`](crate::Description::frames_in_flight).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Slot(pub u32);

/// Which of the description's lights a frame is for, 0 and up, below
/// [`Description::lights`](crate::Description::lights).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LightIndex(pub u32);

/// Which of the description's techniques a frame uses: 0 is
/// [`Description::technique`](crate::Description::technique), n the nth of
/// [`Description::other_techniques`](crate::Description::other_techniques).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TechniqueIndex(pub u32);

macro_rules! numbers {
    ($($index:ident)+) => {
        $(impl fmt::Display for $index {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "{}", self.0)
            }
        })+
    };
}

numbers! { Slot LightIndex TechniqueIndex }

/// An axis-aligned box in mesh space: least and largest corner, metres before the transform.
pub type MeshBounds = [[f32; 3]; 2];

/// How many half-extents away from 0 a mesh is at least whose positions count from another origin. From 3 on no
/// position is more than twice as large as another, and f32 subtracts such numbers exactly (Sterbenz 1974); nearer by, an
/// origin would win less than two bits.
const FAR: f32 = 3.0;

/// The origin from which a mesh's positions count when they are transformed, in mesh space: 0, or along the axes on which
/// its bounds lie far from 0 (a town in the coordinates of a country) their middle.
///
/// The differences from there are exact, and the matrix that they are transformed with ([`from_origin`]) is a product in
/// 64 bits: nothing is rounded at the size of the positions themselves.
pub(crate) fn origin_of([low, high]: &MeshBounds) -> [f32; 3] {
    [0, 1, 2].map(|i| {
        let [middle, half] = [0.5 * low[i] + 0.5 * high[i], 0.5 * high[i] - 0.5 * low[i]];
        // Numbers that are not finite are refused elsewhere.
        if middle.abs() > FAR * half && middle.is_finite() { middle } else { 0.0 }
    })
}

/// The transform of positions less their mesh's origin.
pub(crate) fn from_origin(world_from_mesh: &DMat4, origin: [f32; 3]) -> DMat4 {
    let at = DVec3::from_array(origin.map(f64::from)).extend(1.0);
    DMat4 { w_axis: *world_from_mesh * at, ..*world_from_mesh }
}

/// What a mesh does with light: blocks it, shows shadows, or both.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Role {
    /// Blocks light. Its own pixels are lit whole (visible fraction 1) only where the G-buffer has a mask
    /// ([`Frame::mask`](crate::Frame::mask)) that holds [`Self::mask`] at them; without a mask they are shadowed as
    /// all others are.
    Occluder,
    /// Shows shadows and blocks nothing. Only a mask tells its pixels from those of meshes that block as well: without
    /// one, what lies behind the plane of such a pixel shadows it no more.
    Receiver,
    /// Blocks light and shows shadows, its own included; what every pixel is where there is no mask.
    #[default]
    Both,
}

impl Role {
    /// Whether a mesh of this role blocks light.
    pub fn blocks(self) -> bool {
        self != Self::Receiver
    }

    /// What the G-buffer's mask holds at the pixels of a mesh of this role, as an 8-bit unorm.
    pub fn mask(self) -> u8 {
        match self {
            Self::Both => 255,
            Self::Receiver => 128,
            Self::Occluder => 0,
        }
    }

    /// Whether a mesh of this role shows shadows.
    pub fn receives(self) -> bool {
        self != Self::Occluder
    }
}

impl fmt::Display for Role {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Occluder => "occluder",
            Self::Receiver => "receiver",
            Self::Both => "both",
        })
    }
}

impl FromStr for Role {
    type Err = Error;

    /// Reads `occluder`, `receiver` or `both`, as in a file's `shadow_role`.
    ///
    /// # Errors
    /// [`Error::Scene`] for any other word.
    fn from_str(word: &str) -> Result<Self, Error> {
        match word {
            "occluder" => Ok(Self::Occluder),
            "receiver" => Ok(Self::Receiver),
            "both" => Ok(Self::Both),
            _ => Err(Error::Scene(format!(
                "the role {} is not known; write occluder, receiver or both",
                quoted(word)
            ))),
        }
    }
}

/// One of the host's images, how it was left and how it is wanted back.
///
/// Format, extent and usage are what the image was created with; [`ShadowNode::plan`] holds them
/// against what the node needs, because Vulkan does not tell them of a handle.
///
/// [`ShadowNode::plan`]: crate::ShadowNode::plan
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HostImage {
    /// The image: one sample, and the view's mip level and array layer its only ones.
    pub image: vk::Image,
    /// A 2D view of it, of the depth aspect for depth.
    pub view: vk::ImageView,
    /// The format of image and view.
    pub format: vk::Format,
    /// Width and height in texels.
    pub extent: [u32; 2],
    /// What the image was created for.
    pub usage: vk::ImageUsageFlags,
    /// Stage, access and layout of the host's last use before the node. A host that places the
    /// barriers itself says here in which layout the node will find an image that it reads.
    pub before: Scope,
    /// Stage, access and layout of the host's first use after it; `UNDEFINED` leaves the layout, and [`Scope::ANY`] is
    /// for an image that the host clears next.
    pub after: Scope,
}

impl HostImage {
    /// An image and its view, with what they were created with and how the host uses them.
    pub fn new(
        (image, view): (vk::Image, vk::ImageView),
        format: vk::Format,
        extent: [u32; 2],
        usage: vk::ImageUsageFlags,
        before: Scope,
        after: Scope,
    ) -> Self {
        Self { image, view, format, extent, usage, before, after }
    }

    /// The image as a frame hands it back, for the frame of the next light, which follows in the same command buffer.
    /// [`Self::after`] must name a layout, so it cannot be [`Scope::ANY`]; that of the last light's frame can.
    #[must_use]
    pub fn handed_back(self) -> Self {
        Self { before: self.after, ..self }
    }
}

/// Whose image the result is written to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Visibility {
    /// The node's own, [`ShadowNode::visibility`](crate::ShadowNode::visibility): with several lights,
    /// the layer of the frame's light. A frame that would write what is there already leaves it, unless
    /// `before` writes it or forgets its layout.
    Own {
        /// The host's last use of it. In the first frame, and the first behind a resize, there was none:
        /// [`Scope::UNUSED`], or what it is in every other frame, will do, since the node forgets what it overwrites.
        before: Scope,
        /// The host's first use of what this frame writes.
        after: Scope,
    },
    /// The host's: R32_SFLOAT (R32G32B32A32_SFLOAT with color), as large as the G-buffer, with STORAGE
    /// usage. Every pixel of it is
    /// written, so what it held need not be kept.
    Lent(HostImage),
}

/// A mesh's triangles in buffers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MeshBuffers {
    /// Positions: three 32-bit floats each, in a buffer with `VERTEX_BUFFER` usage.
    pub positions: vk::Buffer,
    /// Where the first position is, in bytes.
    pub positions_offset: u64,
    /// Bytes from one position to the next; one of
    /// [`Description::position_strides`](crate::Description::position_strides).
    pub positions_stride: u32,
    /// Indices: buffer, offset in bytes, type; none for a list of triangles without.
    pub indices: Option<(vk::Buffer, u64, vk::IndexType)>,
    /// How many indices, or vertices where there are none.
    pub count: u32,
}

impl MeshBuffers {
    /// `count` 32-bit indices from a buffer's start into positions from a buffer's start, which lie
    /// `stride` bytes apart.
    pub fn indexed(positions: vk::Buffer, stride: u32, indices: vk::Buffer, count: u32) -> Self {
        Self {
            positions,
            positions_offset: 0,
            positions_stride: stride,
            indices: Some((indices, 0, vk::IndexType::UINT32)),
            count,
        }
    }
}

/// How a mesh's triangles come into the depth layers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Geometry {
    /// The node draws them.
    Buffers(MeshBuffers),
    /// The host draws them with a pipeline of its own (skinned, displaced, generated), when
    /// [`ShadowNode::record_with`](crate::ShadowNode::record_with) asks for this number.
    HostDrawn(u64),
}

/// A mesh as the host keeps it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshInstance {
    /// The triangles of the mesh.
    pub geometry: Geometry,
    /// Mesh space to world space, for column vectors: the last row is 0, 0, 0, 1.
    pub world_from_mesh: DMat4,
    /// A box around the positions, in mesh space: [least, largest] corners. The node never reads positions on the CPU,
    /// so nothing tells it that a box is too small; what reaches beyond it may cast no shadow, and show none.
    /// Where it lies far from 0, more than three of its half-extents along an axis, its middle is subtracted from positions
    /// before anything is transformed in 32 bits.
    pub bounds: MeshBounds,
    /// Occluder, receiver or both.
    pub role: Role,
    /// Both sides of each triangle are front faces.
    pub double_sided: bool,
    /// A texture's alpha cuts holes into it, or lets a part of the light through. Without [`Self::opacity`] the node draws
    /// it whole, which [`FramePlan::explain`](crate::FramePlan::explain) then says; with [`Geometry::HostDrawn`] the host
    /// cuts it.
    pub cut_out: bool,
    /// The texture that tells where, for [`Geometry::Buffers`]: every technique's maps and rays then look it up. The node
    /// is made for a number of such meshes ([`Description::cut_outs`](crate::Description::cut_outs)).
    pub opacity: Option<OpacityTexture>,
}

impl MeshInstance {
    /// A mesh whose triangles have one front: the side from which their corners run counter-clockwise.
    pub fn new(
        geometry: Geometry,
        world_from_mesh: impl Into<Matrix>,
        bounds: MeshBounds,
        role: Role,
    ) -> Self {
        let world_from_mesh = world_from_mesh.into().0;
        Self {
            geometry,
            world_from_mesh,
            bounds,
            role,
            double_sided: false,
            cut_out: false,
            opacity: None,
        }
    }
}

/// Depth images of the occluders that the host drew itself, from the light.
///
/// Their camera is a perspective that stands at the light's centre, looks along its emission and has
/// its x and y along the light's half-axes, either way round. Depth may be standard or reversed, the
/// far plane finite or infinite: window and distances are worked out from the matrix. The images are
/// square, [`map`](crate::Technique::map) texels a side, of the format that
/// [`Description::occluder_maps`](crate::Description::occluder_maps) says, cleared to the far plane.
///
/// Leave out what lies behind everything, such as a ground: as an occluder it only costs accuracy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OccluderMaps {
    /// The nearest faces, of either orientation.
    pub front: HostImage,
    /// The furthest back faces: front faces culled, the furthest kept, cleared to the near plane.
    /// Needed unless `sides` is `one`.
    pub back: Option<HostImage>,
    /// World space to the clip space of both.
    pub clip_from_world: DMat4,
}

impl OccluderMaps {
    /// Images, and the matrix that they were drawn with.
    pub fn new(
        front: HostImage,
        back: Option<HostImage>,
        clip_from_world: impl Into<Matrix>,
    ) -> Self {
        Self { front, back, clip_from_world: clip_from_world.into().0 }
    }
}

/// Who places the barriers at the node's border.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BorderBarriers {
    /// The node, from what the host says of its images.
    #[default]
    Node,
    /// The host, from [`FramePlan::accesses`](crate::FramePlan::accesses).
    Host,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Within bounds three half-extents away and more, f32 subtracts the origin without rounding; nearer ones have none.
    #[test]
    fn positions_less_their_origin_are_exact() {
        for (middle, half) in [(1e5, 3.0), (-7e6, 2.1e6), (3.3e-5, 1e-5), (12.0, 0.0), (1e30, 1e29)]
        {
            let (low, high) = (middle - half, middle + half);
            let [origin, ..] = origin_of(&[[low, 0.0, -1.0], [high, 0.0, 1.0]]);
            for step in 0..=1000 {
                let p = (low + (high - low) * (step as f32 / 1000.0)).clamp(low, high);
                assert_eq!(f64::from(p - origin), f64::from(p) - f64::from(origin), "{p}");
            }
            assert!(origin >= low && origin <= high);
        }
        for (low, high) in [(-1.0, 1.0), (0.0, 5.0), (1.0, 2.0), (-3.0, -1.5), (f32::NAN, 2.0)] {
            assert_eq!(origin_of(&[[low; 3], [high; 3]]), [0.0; 3], "{low} to {high}");
        }
    }

    #[test]
    fn the_transform_from_an_origin_takes_it_where_it_was() {
        let world = DMat4::from_translation(DVec3::new(-1e5, 2.0, 3.0))
            * DMat4::from_scale(DVec3::splat(2.0));
        let moved = from_origin(&world, [5e4, 0.0, 0.25]);
        assert_eq!(moved.transform_point3(DVec3::X), DVec3::new(2.0, 2.0, 3.5));
        assert_eq!(from_origin(&world, [0.0; 3]), world);
    }
}
