//! Scenes drawn into color attachments and reversed depth: G-buffers, and whatever a fragment shader makes
//! of the same fragments.

use crate::raster::{Raster, RasterInfo, Triangles};
use crate::set::BoundSet;
use crate::shaders::GBUFFER_VERT;
use crate::{HeadlessDevice, OwnedImage, SceneBuffers, View};
use antumbra::Error;
use antumbra::scene::{Instance, Scene};
use antumbra::shaders::{DEPTH_VERT, Module};
use ash::vk;
use glam::DMat4;
use std::time::Duration;

/// The push constants of `glsl/headless/gbuffer.vert` and of the fragment stages.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Push {
    clip_from_mesh: [f32; 16],
    /// Columns of three, the fourth float of each but the last unused.
    world_from_mesh: [f32; 15],
    /// The role in bits 0 to 7, which faces are not seen in bits 8 and 9.
    flags: u32,
}

/// Bit 8 hides the faces whose corners run counter-clockwise in the image, bit 9 the others.
const COUNTER_CLOCKWISE: u32 = 1 << 8;
const CLOCKWISE: u32 = 2 << 8;

/// A mesh ready to be drawn. Its buffers are the [`SceneBuffers`]' that it was made of, which must live as
/// long.
pub(crate) struct SceneDraw {
    push: Push,
    positions: vk::Buffer,
    normals: vk::Buffer,
    indices: vk::Buffer,
    count: u32,
}

/// The instances that `keep` accepts, as a view sees them.
pub(crate) fn draws(
    scene: &Scene,
    buffers: &SceneBuffers,
    view: &View,
    keep: impl Fn(&Instance) -> bool,
) -> Vec<SceneDraw> {
    let draw = |instance: &Instance| {
        let (positions, normals, indices, count) = buffers.draw(instance.mesh)?;
        let double_sided = scene.meshes[instance.mesh].double_sided;
        let backs = match (double_sided, instance.mirrored()) {
            (true, _) => 0,
            // A transform that mirrors turns the order of corners round, and fronts are fronts all the same.
            (false, true) => COUNTER_CLOCKWISE,
            (false, false) => CLOCKWISE,
        };
        let flags = u32::from(instance.role.mask()) | backs;
        let push = push_of(&buffers.world_from_buffer(instance), flags, view);
        Some(SceneDraw { push, positions, normals, indices, count })
    };
    scene.instances.iter().filter(|i| keep(i)).filter_map(draw).collect()
}

/// A raster of a scene's meshes, of which [`SceneDraw`]s are drawn.
pub(crate) struct Painter {
    device: HeadlessDevice,
    raster: Raster,
    inputs: bool,
}

impl Painter {
    /// For color attachments of these formats, which begin as `background` in every channel and which the
    /// fragment shader writes; it may read one set. It gets world positions and normals, or with `inputs` off
    /// nothing: what is written and not read is worth a warning to the validation layer.
    ///
    /// # Errors
    /// [`Error::Vulkan`] where the driver refuses.
    pub fn new(
        device: &HeadlessDevice,
        colors: &[vk::Format],
        background: f32,
        fragment: Module,
        inputs: bool,
        set: Option<BoundSet>,
    ) -> Result<Self, Error> {
        // Both put a vertex where the other does.
        let (vertex, vertices): (_, &[&[u32]]) =
            if inputs { (GBUFFER_VERT, &[&[3], &[3]]) } else { (DEPTH_VERT, &[&[3]]) };
        let info = RasterInfo {
            colors,
            background,
            adds: false,
            depth: true,
            vertex,
            fragment: Some(fragment),
            vertices,
            set,
            push: size_of::<Push>() as u32,
        };
        Ok(Self { device: device.clone(), raster: Raster::new(device, info)?, inputs })
    }

    /// Paints into the images, the color attachments in order and then depth, submits and waits; how long
    /// that took. All have one size.
    ///
    /// # Errors
    /// [`Error::Vulkan`] where the driver refuses.
    pub fn paint(&self, images: &[&OwnedImage], draws: &[SceneDraw]) -> Result<Duration, Error> {
        let target = self.raster.target(images)?;
        let draw_all = |cmd| {
            for draw in draws {
                let triangles = Triangles {
                    vertices: &[draw.positions, draw.normals],
                    offsets: &[0, 0],
                    indices: (draw.indices, 0, vk::IndexType::UINT32),
                    count: draw.count,
                };
                // `depth.vert` has a mesh's origin in this place, which is 0.
                let world_from_mesh =
                    if self.inputs { draw.push.world_from_mesh } else { [0.0; 15] };
                let push = Push { world_from_mesh, ..draw.push };
                self.raster.draw(cmd, bytemuck::bytes_of(&push), &triangles);
            }
        };
        let painted = self.device.submit_timed(|cmd| {
            self.raster.record(cmd, &target, || draw_all(cmd));
            Ok(())
        })?;
        Ok(painted.1)
    }
}

fn push_of(m: &DMat4, flags: u32, view: &View) -> Push {
    let mut world_from_mesh = [0.0; 15];
    for (column, c) in [m.x_axis, m.y_axis, m.z_axis, m.w_axis].iter().enumerate() {
        for (row, value) in c.truncate().to_array().into_iter().enumerate() {
            world_from_mesh[column * 4 + row] = value as f32;
        }
    }
    let clip_from_mesh = (view.clip_from_world * *m).as_mat4().to_cols_array();
    Push { clip_from_mesh, world_from_mesh, flags }
}
