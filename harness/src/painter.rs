//! Scenes drawn into color attachments and reversed depth: G-buffers, and whatever a fragment shader makes
//! of the same fragments.

use crate::raster::{Raster, RasterInfo, Triangles};
use crate::set::BoundSet;
use crate::shaders::{GBUFFER_CUT_FRAG, GBUFFER_CUT_VERT, GBUFFER_VERT};
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
    /// The set of a mesh that a texture cuts out, and its layout.
    cut: Option<(vk::DescriptorSet, vk::DescriptorSetLayout)>,
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
        let cut = buffers.cut_set(instance.mesh).map(|set| (set.raw(), set.layout()));
        Some(SceneDraw { push, positions, normals, indices, count, cut })
    };
    scene.instances.iter().filter(|i| keep(i)).filter_map(draw).collect()
}

/// A raster of a scene's meshes, of which [`SceneDraw`]s are drawn.
pub(crate) struct Painter {
    device: HeadlessDevice,
    raster: Raster,
    colors: Vec<vk::Format>,
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
            set_layout: None,
            push: size_of::<Push>() as u32,
        };
        let (device, colors) = (device.clone(), colors.to_vec());
        Ok(Self { raster: Raster::new(&device, info)?, device, colors, inputs })
    }

    /// A raster like the G-buffer's own for meshes that textures cut out, whose sets have this layout.
    fn cut_raster(&self, set_layout: vk::DescriptorSetLayout) -> Result<Raster, Error> {
        let info = RasterInfo {
            colors: &self.colors,
            background: 0.0,
            adds: false,
            depth: true,
            vertex: GBUFFER_CUT_VERT,
            fragment: Some(GBUFFER_CUT_FRAG),
            vertices: &[&[3], &[3]],
            set: None,
            set_layout: Some(set_layout),
            push: size_of::<Push>() as u32,
        };
        Raster::new(&self.device, info)
    }

    /// Paints into the images, the color attachments in order and then depth, submits and waits; how long
    /// that took. All have one size.
    ///
    /// # Errors
    /// [`Error::Vulkan`] where the driver refuses.
    pub fn paint(&self, images: &[&OwnedImage], draws: &[SceneDraw]) -> Result<Duration, Error> {
        let target = self.raster.target(images)?;
        // Forward evaluation draws them whole.
        let cut = draws.iter().find_map(|draw| draw.cut).filter(|_| self.inputs);
        let cut = cut.map(|(_, layout)| self.cut_raster(layout)).transpose()?;
        let draw_all = |cmd| {
            // What is cut out comes last, because it changes the pipeline.
            let is_cut = |draw: &&SceneDraw| cut.is_some() && draw.cut.is_some();
            let whole = draws.iter().filter(|draw| !is_cut(draw));
            for draw in whole.chain(draws.iter().filter(is_cut)) {
                let mut raster = &self.raster;
                if let (Some(cut), Some((set, _))) = (&cut, draw.cut) {
                    cut.take_over(cmd, set);
                    raster = cut;
                }
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
                raster.draw(cmd, bytemuck::bytes_of(&push), &triangles);
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
