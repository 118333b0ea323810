//! Compose: visibility × unshadowed irradiance, into the picture.

use crate::Outcome;
use crate::device::Gpu;
use crate::shot::Shot;
use glam::DVec3;
use vk_graph::Graph;
use vk_graph::driver::compute::{ComputePipeline, ComputePipelineInfo};
use vk_graph::driver::shader::Shader;
use vk_graph::driver::sync::AccessType;

/// `compose.comp`
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Push {
    world_from_ndc: [f32; 16],
    radiance: [f32; 4],
    center: [f32; 4],
    half_u: [f32; 4],
    half_v: [f32; 4],
}

impl Push {
    fn new(shot: &Shot) -> Self {
        let light = shot.light.light.rectangle();
        let [a, b] = light.half_extents();
        let peak = shot.light.color.into_iter().fold(1e-6, f32::max);
        let [red, green, blue] = shot.light.color.map(|c| c / peak * shot.exposure);
        // Light space has its z along the emission, which is half_v × half_u: v is against y.
        let frame = light.world_from_light();
        let vector = |v: DVec3| frame.transform_vector3(v).as_vec3().extend(0.0).to_array();
        Self {
            world_from_ndc: shot.world_from_ndc.as_mat4().to_cols_array(),
            radiance: [red, green, blue, 0.0],
            center: light.center().as_vec3().extend(1.0).to_array(),
            half_u: vector(DVec3::X * a),
            half_v: vector(DVec3::NEG_Y * b),
        }
    }
}

/// Composes pictures.
pub struct ComposePass(ComputePipeline);

impl ComposePass {
    pub fn new(gpu: &Gpu) -> Outcome<Self> {
        let shader = Shader::new_compute(include_bytes!("shaders/compose.comp.spv").as_slice());
        Ok(Self(ComputePipeline::create(&gpu.device, ComputePipelineInfo::default(), shader)?))
    }

    /// Adds the command that composes.
    pub fn add(&self, graph: &mut Graph, shot: &Shot) {
        let targets = shot.targets;
        let fetched = [&targets.depth, &targets.normal, &targets.visibility];
        let [depth, normal, visibility] = fetched.map(|image| graph.bind_resource(image));
        let picture = graph.bind_resource(&targets.picture);
        let read = AccessType::ComputeShaderReadSampledImageOrUniformTexelBuffer;
        let push = Push::new(shot);
        let [groups_x, groups_y] = targets.extent.map(|e| e.div_ceil(8));
        graph
            .begin_cmd()
            .debug_name("compose")
            .bind_pipeline(&self.0)
            .shader_resource_access(0, depth, read)
            .shader_resource_access(1, normal, read)
            .shader_resource_access(2, visibility, read)
            .shader_resource_access(3, picture, AccessType::ComputeShaderWrite)
            .record_cmd(move |cmd| {
                cmd.push_constants(0, bytemuck::bytes_of(&push)).dispatch(groups_x, groups_y, 1);
            });
    }
}
