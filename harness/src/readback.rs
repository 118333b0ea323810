//! The paper's own scheme, for comparison: depth read back, rectangles made by the processor, sent
//! back and blended (Atty 2006 section 4.1).
//!
//! ```text
//!   submit 1   occluders' and receivers' depth; the former copied to the processor; wait
//!   processor  one penumbra rectangle a texel, as four vertices
//!   submit 2   the rectangles, blended into the soft shadow map in 32 bits; wait
//! ```
//! One side, and the map without its projection onto pixels: it stands beside a frame of the node with
//! `receivers=map sides=one`. The sums are the same bits as those of `accumulate=blend`.

use crate::raster::{COLOR_LAYOUT, DEPTH_LAYOUT, Raster, RasterInfo, Target, Triangles};
use crate::set::{Bound, BoundSet};
use crate::shaders::QUADS_VERT;
use crate::{HeadlessDevice, HostBuffer, OwnedImage, SceneBuffers};
use antumbra::frame::ImageBarrier;
use antumbra::graph::Scope;
use antumbra::scene::{Role, Scene};
use antumbra::stages::depth_layers::{self, DepthPush, MapView};
use antumbra::stages::visibility;
use antumbra::techniques::soft_shadow_map::{BLEND_STEPS, PatchDraw, receiver_grid};
use antumbra::{Error, Geometry, MeshInstance, RectangleLight, shaders};
use ash::vk;
use std::time::{Duration, Instant};

/// The times of one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReadbackTimes {
    /// The time from the first submit to the last fence.
    pub frame: Duration,
    /// The first submit, its wait and the copy.
    pub depth: Duration,
    /// Making the rectangles.
    pub rectangles: Duration,
    /// The second submit and its wait.
    pub blend: Duration,
    /// The number of rectangles.
    pub patches: usize,
    /// Bytes over the bus, there and back.
    pub bytes: u64,
}

/// A corner of a penumbra rectangle.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Corner {
    at: [f32; 2],
    of_patch: [f32; 3],
}

/// A scene, its maps, and what draws them.
pub struct ReadbackScheme {
    device: HeadlessDevice,
    front: OwnedImage,
    receivers: OwnedImage,
    map: OwnedImage,
    /// Draws depth into `front` and `receivers`.
    layers: Raster,
    layer_targets: [Target; 2],
    blend: Raster,
    blend_target: Target,
    depth: HostBuffer,
    corners: HostBuffer,
    indices: HostBuffer,
    instances: Vec<MeshInstance>,
    _buffers: SceneBuffers,
}

impl ReadbackScheme {
    /// Uploads the scene and makes maps of these sides, in texels.
    ///
    /// # Errors
    /// Whatever the device refuses.
    pub fn new(
        device: &HeadlessDevice,
        scene: &Scene,
        map: u32,
        receiver_map: u32,
    ) -> Result<Self, Error> {
        use vk::ImageUsageFlags as Usage;
        let image =
            |name, format, side, usage| OwnedImage::new(device, name, format, [side; 2], usage);
        let depth = Usage::DEPTH_STENCIL_ATTACHMENT | Usage::SAMPLED;
        let front = image("readback.front", depth_layers::FORMAT, map, depth)?;
        let receivers = image("readback.receivers", depth_layers::FORMAT, receiver_map, depth)?;
        let color = Usage::COLOR_ATTACHMENT | Usage::SAMPLED;
        let map_image = image("readback.map", visibility::FORMAT, receiver_map, color)?;
        let layers = RasterInfo {
            colors: &[],
            background: 0.0,
            adds: false,
            depth: true,
            vertex: shaders::DEPTH_VERT,
            fragment: None,
            vertices: &[&[3]],
            set: None,
            set_layout: None,
            push: size_of::<DepthPush>() as u32,
        };
        let layers = Raster::new(device, layers)?;
        let layer_targets = [layers.target(&[&front])?, layers.target(&[&receivers])?];
        let fetched = [(1, Bound::Fetched(receivers.view(), DEPTH_LAYOUT))];
        let blend = RasterInfo {
            colors: &[visibility::FORMAT],
            background: 0.0,
            adds: true,
            depth: false,
            vertex: QUADS_VERT,
            fragment: Some(shaders::PATCH_FRAG),
            // As a `Corner` lies in memory.
            vertices: &[&[2, 3]],
            set: Some(BoundSet::new(device, vk::ShaderStageFlags::FRAGMENT, &fetched)?),
            set_layout: None,
            push: size_of::<PatchDraw>() as u32,
        };
        let blend = Raster::new(device, blend)?;
        let blend_target = blend.target(&[&map_image])?;
        let texels = u64::from(map) * u64::from(map);
        let of = |name, bytes, usage| HostBuffer::new(device, name, bytes, usage);
        use vk::BufferUsageFlags as Buffer;
        let mut indices = of("readback.indices", texels * 24, Buffer::INDEX_BUFFER)?;
        let quad = |n: u32| [0, 1, 2, 2, 1, 3].map(|corner| n * 4 + corner);
        indices.write(&(0..texels as u32).flat_map(quad).collect::<Vec<_>>())?;
        let buffers = SceneBuffers::new(device, scene)?;
        Ok(Self {
            device: device.clone(),
            depth: of("readback.depth", texels * 4, Buffer::TRANSFER_DST)?,
            corners: of(
                "readback.corners",
                texels * 4 * size_of::<Corner>() as u64,
                Buffer::VERTEX_BUFFER,
            )?,
            indices,
            front,
            receivers,
            map: map_image,
            layers,
            layer_targets,
            blend,
            blend_target,
            instances: buffers.instances(scene),
            _buffers: buffers,
        })
    }

    /// One frame under a light; `window` fixes the tangents of the occluder map.
    ///
    /// # Errors
    /// [`Error::Frame`] where nothing can be shadowed; what the device refuses.
    pub fn run(
        &mut self,
        light: &RectangleLight,
        window: Option<[[f64; 2]; 2]>,
    ) -> Result<ReadbackTimes, Error> {
        let boxes = |keep: fn(Role) -> bool| {
            let kept = self.instances.iter().filter(move |m| keep(m.role));
            kept.map(|m| (m.bounds, m.world_from_mesh)).collect::<Vec<_>>()
        };
        let seen = boxes(Role::receives);
        let blockers: Vec<_> = boxes(Role::blocks)
            .into_iter()
            .filter(|b| !depth_layers::is_aside(light, b, &seen))
            .collect();
        let [map, receiver_map] = [&self.front, &self.receivers].map(|i| i.extent()[0]);
        let nothing = || Error::Frame("nothing can be shadowed".into());
        let occluders = depth_layers::fit_occluders(light, &blockers, window, map);
        let occluders = occluders.ok_or_else(nothing)?;
        let view = depth_layers::fit_receivers(light, &seen, &occluders, receiver_map);
        let view = view.ok_or_else(nothing)?;
        let (t_step, t_first) = receiver_grid(&view, &occluders);
        let push = PatchDraw {
            scale: occluders.scale(light).map(|s| s as f32),
            t_step,
            t_first,
            w_far: (1.0 / view.far) as f32,
            receiver_inv_near: (1.0 / view.near) as f32,
            receiver_map: receiver_map as i32,
            steps: BLEND_STEPS,
        };

        let aside =
            |m: &MeshInstance| depth_layers::is_aside(light, &(m.bounds, m.world_from_mesh), &seen);
        let (_, drawn) = self.device.submit_timed(|cmd| {
            self.draw_layer(cmd, 0, light, &occluders, |m| m.role.blocks() && !aside(m));
            self.draw_layer(cmd, 1, light, &view, |m| m.role.receives());
            self.copy_depth(cmd);
            Ok(())
        })?;
        let started = Instant::now();
        let depth = self.depth.read::<f32>();
        let read = started.elapsed();
        let started = Instant::now();
        let corners = rectangles(&depth, map, (1.0 / occluders.near) as f32, &push);
        self.corners.write(&corners)?;
        let made = started.elapsed();
        let patches = corners.len() / 4;
        let (_, blended) = self.device.submit_timed(|cmd| {
            let triangles = Triangles {
                vertices: &[self.corners.raw()],
                offsets: &[0],
                indices: (self.indices.raw(), 0, vk::IndexType::UINT32),
                count: patches as u32 * 6,
            };
            let draw = || self.blend.draw(cmd, bytemuck::bytes_of(&push), &triangles);
            self.blend.record(cmd, &self.blend_target, draw);
            Ok(())
        })?;
        Ok(ReadbackTimes {
            frame: drawn + read + made + blended,
            depth: drawn + read,
            rectangles: made,
            blend: blended,
            patches,
            bytes: (size_of_val(&depth[..]) + size_of_val(&corners[..])) as u64,
        })
    }

    /// The soft shadow map of the last frame: occlusion, row by row.
    ///
    /// # Errors
    /// See [`OwnedImage::read`].
    pub fn occlusion(&self) -> Result<Vec<f32>, Error> {
        self.map.read(COLOR_LAYOUT)
    }

    fn draw_layer(
        &self,
        cmd: vk::CommandBuffer,
        layer: usize,
        light: &RectangleLight,
        view: &MapView,
        keep: impl Fn(&MeshInstance) -> bool,
    ) {
        let clip_from_world = view.clip_from_light() * light.light_from_world();
        let draw = || {
            for mesh in self.instances.iter().filter(|m| keep(m)) {
                let Geometry::Buffers(b) = mesh.geometry else { continue };
                let Some(indices) = b.indices else { continue };
                let clip_from_mesh = (clip_from_world * mesh.world_from_mesh).as_mat4();
                let clip_from_mesh = clip_from_mesh.to_cols_array();
                let push = DepthPush { clip_from_mesh, origin: [0.0; 4] };
                let triangles = Triangles {
                    vertices: &[b.positions],
                    offsets: &[b.positions_offset],
                    indices,
                    count: b.count,
                };
                self.layers.draw(cmd, bytemuck::bytes_of(&push), &triangles);
            }
        };
        self.layers.record(cmd, &self.layer_targets[layer], draw);
    }

    /// The occluders' depth to the processor, the receivers' to where it is fetched.
    fn copy_depth(&self, cmd: vk::CommandBuffer) {
        let raw = self.device.device();
        let to = |image: &OwnedImage, scope: Scope| ImageBarrier {
            image: image.raw(),
            layer: 0,
            aspect: vk::ImageAspectFlags::DEPTH,
            before: Scope::DEPTH_DRAWN.in_layout(DEPTH_LAYOUT),
            after: scope,
        };
        let fetched = Scope::FRAGMENT_SAMPLED.in_layout(DEPTH_LAYOUT);
        for barrier in [to(&self.front, Scope::COPIED_FROM), to(&self.receivers, fetched)] {
            let (before, after) = (barrier.before.stage, barrier.after.stage);
            let none = vk::DependencyFlags::empty();
            // SAFETY: `submit_timed` is recording, outside a render pass; both were just drawn.
            unsafe {
                raw.cmd_pipeline_barrier(cmd, before, after, none, &[], &[], &[barrier.vk()]);
            };
        }
        let [width, height] = self.front.extent();
        let copy = [vk::BufferImageCopy::default()
            .image_subresource(vk::ImageSubresourceLayers {
                aspect_mask: vk::ImageAspectFlags::DEPTH,
                layer_count: 1,
                ..Default::default()
            })
            .image_extent(vk::Extent3D { width, height, depth: 1 })];
        let layout = Scope::COPIED_FROM.layout;
        let (image, buffer) = (self.front.raw(), self.depth.raw());
        // SAFETY: the image is in that layout, and the buffer holds all of it.
        unsafe { raw.cmd_copy_image_to_buffer(cmd, image, layout, buffer, &copy) };
    }
}

/// The penumbra rectangle of each occupied texel (Atty 2006 section 3.3), on one core, as `patch.vert`
/// makes them.
fn rectangles(depth: &[f32], side: u32, inv_near: f32, push: &PatchDraw) -> Vec<Corner> {
    // As in `patch.vert`: what rasters drop at edges within their rounding.
    const MARGIN: f32 = 1.0 / 16.0;
    let mut corners = Vec::with_capacity(depth.len() * 4);
    for (y, row) in depth.chunks_exact(side as usize).enumerate() {
        for (x, &stored) in row.iter().enumerate() {
            if stored == 0.0 {
                continue;
            }
            let w = stored * inv_near;
            let texel = [x as f32, y as f32];
            let far = (w - push.w_far).max(0.0);
            let clip = |i: usize, edge: f32, reach: f32, margin: f32| {
                let at =
                    (texel[i] + edge + reach - push.t_first[i]) / push.t_step[i] + 0.5 + margin;
                2.0 * at / push.receiver_map as f32 - 1.0
            };
            let ends = [0, 1].map(|i| {
                let reach = 0.5 * far / push.scale[i];
                [clip(i, 0.0, -reach, -MARGIN), clip(i, 1.0, reach, MARGIN)]
            });
            let of_patch = [texel[0], texel[1], w];
            for (right, lower) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                corners.push(Corner { at: [ends[0][right], ends[1][lower]], of_patch });
            }
        }
    }
    corners
}
