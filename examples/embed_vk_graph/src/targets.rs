//! The images of the picture's size.

use crate::Outcome;
use crate::device::Gpu;
use antumbra::{NormalEncoding, Normals};
use ash::vk;
use std::sync::Arc;
use vk::ImageUsageFlags as Usage;
use vk_graph::driver::image::{Image, ImageInfo};

pub const DEPTH: vk::Format = vk::Format::D32_SFLOAT;
pub const MASK: vk::Format = vk::Format::R8_UNORM;
const NORMAL: vk::Format = vk::Format::R16G16B16A16_SFLOAT;
/// How the node reads the triangles' normals: world space, x, y and z as they are.
pub const NORMALS: Normals = Normals { format: NORMAL, encoding: NormalEncoding::Signed };
const VISIBILITY: vk::Format = vk::Format::R32_SFLOAT;
/// The picture's format, which every device can write from a compute shader.
const PICTURE: vk::Format = vk::Format::R8G8B8A8_UNORM;

/// The images. There is one set for all frames in flight: vk-graph remembers how the frame before
/// used each of them, and a graph keeps those that it binds until its commands are done.
pub struct Targets {
    pub extent: [u32; 2],
    pub depth: Arc<Image>,
    pub normal: Arc<Image>,
    pub mask: Arc<Image>,
    /// The triangles' own normals, which the node is lent; shading takes the interpolated ones.
    pub plane: Arc<Image>,
    /// The engine's own, lent to the node, which writes it.
    pub visibility: Arc<Image>,
    pub picture: Arc<Image>,
}

impl Targets {
    pub fn new(gpu: &Gpu, extent: [u32; 2]) -> Outcome<Self> {
        let [width, height] = extent;
        let image = |name: &str, format, usage| -> Outcome<Arc<Image>> {
            let info = ImageInfo::image_2d(width, height, format, usage);
            let made = Image::create(&gpu.device, info)
                .map_err(|e| format!("making the {name} image of {width}×{height} pixels: {e}"))?;
            Ok(Arc::new(made))
        };
        let (color, depth) = (Usage::COLOR_ATTACHMENT, Usage::DEPTH_STENCIL_ATTACHMENT);
        let copied = Usage::TRANSFER_SRC;
        Ok(Self {
            extent,
            // The node samples depth, mask and plane, so they say SAMPLED.
            depth: image("depth", DEPTH, depth | Usage::SAMPLED | copied)?,
            normal: image("normal", NORMAL, color | Usage::SAMPLED)?,
            mask: image("mask", MASK, color | Usage::SAMPLED)?,
            plane: image("plane", NORMAL, color | Usage::SAMPLED)?,
            // The node stores into it.
            visibility: image("visibility", VISIBILITY, Usage::STORAGE | Usage::SAMPLED | copied)?,
            picture: image("picture", PICTURE, Usage::STORAGE | copied)?,
        })
    }
}
