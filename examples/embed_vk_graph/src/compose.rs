//! Compose: visibility × unshadowed irradiance, into the picture.

use crate::Outcome;
use crate::device::Gpu;
use crate::targets::TargetNodes;
use crate::world::World;
use glam::{DMat4, DVec3};
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
    fn new(world_from_ndc: &DMat4, world: &World) -> Self {
        let light = &world.light.light;
        let frame = light.world_from_light();
        let [a, b] = light.half_extents();
        // Light space has its z along the emission, which is half_v × half_u: v is against y.
        let vector = |v: DVec3| frame.transform_vector3(v).as_vec3().extend(0.0).to_array();
        Self {
            world_from_ndc: world_from_ndc.as_mat4().to_cols_array(),
            radiance: world.radiance(),
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
    pub fn add(
        &self,
        graph: &mut Graph,
        targets: &TargetNodes,
        [width, height]: [u32; 2],
        world_from_ndc: &DMat4,
        world: &World,
    ) {
        let fetched = AccessType::ComputeShaderReadSampledImageOrUniformTexelBuffer;
        let push = Push::new(world_from_ndc, world);
        graph
            .begin_cmd()
            .debug_name("compose")
            .bind_pipeline(&self.0)
            .shader_resource_access(0, targets.depth, fetched)
            .shader_resource_access(1, targets.normal, fetched)
            .shader_resource_access(2, targets.visibility, fetched)
            .shader_resource_access(3, targets.picture, AccessType::ComputeShaderWrite)
            .record_cmd(move |cmd| {
                cmd.push_constants(0, bytemuck::bytes_of(&push)).dispatch(
                    width.div_ceil(8),
                    height.div_ceil(8),
                    1,
                );
            });
    }
}
