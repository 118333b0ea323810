//! Records draws and dispatches of the host's meshes.

use super::Recorder;
use crate::frame::{FramePlan, MeshDraw};
use crate::gpu::pipeline::{PassObjects, variant};
use crate::lent::MeshBuffers;
use crate::stages::depth_layers::DepthPush;
use crate::stages::hierarchy::CutOutPush;
use ash::vk;

impl Recorder<'_> {
    /// Dispatches for each blocking mesh.
    pub(super) fn each_mesh(&self, frame: &FramePlan, made: &PassObjects) {
        let (device, cmd) = (&self.host.device, self.cmd);
        let point = vk::PipelineBindPoint::COMPUTE;
        // SAFETY: Host::borrow's promise: cmd is recording outside a render pass.
        unsafe { device.cmd_bind_pipeline(cmd, point, made.pipelines[0]) };
        let layout = made.layouts.pipeline;
        let sets = self.mesh_sets.of(&frame.triangles, self.place);
        for (mesh, set) in frame.triangles.meshes.iter().zip(sets) {
            let [x, y, z] = mesh.push.groups();
            let push = bytemuck::bytes_of(&mesh.push);
            // SAFETY: as above; the set was made for a layout that is defined alike.
            unsafe { device.cmd_bind_descriptor_sets(cmd, point, layout, 1, &[set], &[]) };
            // SAFETY: as above; the layout's range is one MeshPush.
            unsafe { device.cmd_push_constants(cmd, layout, made.push_stages, 0, push) };
            // SAFETY: pipeline, sets and push constants are bound; the barriers that the pass needs came before
            // it, and each mesh writes places of its own.
            unsafe { device.cmd_dispatch(cmd, x, y, z) };
        }
    }

    /// Dispatches for each opacity texture that is not an earlier mesh's, too.
    pub(super) fn each_texture(&self, frame: &FramePlan, made: &PassObjects) {
        let list = &frame.cut_outs;
        for &number in &list.textures {
            let Some(record) = list.records.get(number as usize) else { continue };
            let push = CutOutPush::of_texture(record, list.halved);
            self.dispatch_cut_out(made, number, &push, push.groups());
        }
    }

    /// Dispatches for each blocking mesh that a texture cuts out.
    pub(super) fn each_cut_out(&self, frame: &FramePlan, made: &PassObjects) {
        for mesh in &frame.triangles.meshes {
            let Some(number) = mesh.cut_out else { continue };
            let Some(record) = frame.cut_outs.records.get(number as usize) else { continue };
            let push = CutOutPush::of_mesh(record, &mesh.push);
            self.dispatch_cut_out(made, number, &push, mesh.push.groups());
        }
    }

    fn dispatch_cut_out(
        &self,
        made: &PassObjects,
        number: u32,
        push: &CutOutPush,
        [x, y, z]: [u32; 3],
    ) {
        let Some(set) = self.cut_out_sets.of(number, self.place) else { return };
        let (device, cmd, layout) = (&self.host.device, self.cmd, made.layouts.pipeline);
        let point = vk::PipelineBindPoint::COMPUTE;
        let push = bytemuck::bytes_of(push);
        // SAFETY: Host::borrow's promise: cmd is recording outside a render pass.
        unsafe { device.cmd_bind_pipeline(cmd, point, made.pipelines[0]) };
        // SAFETY: as above; the set was made for a layout that is defined alike.
        unsafe { device.cmd_bind_descriptor_sets(cmd, point, layout, 1, &[set], &[]) };
        // SAFETY: as above; the layout's range is one CutOutPush.
        unsafe { device.cmd_push_constants(cmd, layout, made.push_stages, 0, push) };
        // SAFETY: pipeline, sets and push constants are bound; the barriers that the pass needs came before it, and
        // each dispatch writes places of its own.
        unsafe { device.cmd_dispatch(cmd, x, y, z) };
    }

    /// Draws a mesh inside the pass's render pass.
    pub(super) fn mesh(
        &self,
        made: &PassObjects,
        draw: &MeshDraw,
        matrix: &[f32; 16],
        mesh: &MeshBuffers,
    ) {
        let (device, cmd) = (&self.host.device, self.cmd);
        let [x, y, z] = draw.origin;
        let push = DepthPush { clip_from_mesh: *matrix, origin: [x, y, z, 0.0] };
        let push = bytemuck::bytes_of(&push);
        let cut = draw.cut_out.and_then(|n| Some((n, self.cut_out_sets.of(n, self.place)?)));
        let nth = variant(draw.stride, draw.faces);
        let (pipeline, first) = match cut.zip(made.cut_pipelines.get(nth)) {
            None => (made.pipelines[nth], 0),
            Some(((number, set), &pipeline)) => {
                let (layout, point) = (made.layouts.pipeline, vk::PipelineBindPoint::GRAPHICS);
                // SAFETY: Host::borrow's promise: cmd is recording; the set was made for a layout that is defined
                // alike.
                unsafe { device.cmd_bind_descriptor_sets(cmd, point, layout, 1, &[set], &[]) };
                (pipeline, number)
            }
        };
        // SAFETY: inside the pass's render pass, with a pipeline made for it.
        unsafe { device.cmd_bind_pipeline(cmd, vk::PipelineBindPoint::GRAPHICS, pipeline) };
        // SAFETY: the layout's range begins with one DepthPush for the vertex stage.
        unsafe {
            device.cmd_push_constants(cmd, made.layouts.pipeline, made.push_stages, 0, push);
        };
        // SAFETY: Host::borrow's promise: the mesh's buffers are valid and hold what the frame
        // says of them.
        unsafe {
            device.cmd_bind_vertex_buffers(cmd, 0, &[mesh.positions], &[mesh.positions_offset]);
        }
        match mesh.indices {
            Some((buffer, offset, kind)) => {
                // SAFETY: as above.
                unsafe { device.cmd_bind_index_buffer(cmd, buffer, offset, kind) };
                // SAFETY: as above.
                unsafe { device.cmd_draw_indexed(cmd, mesh.count, 1, 0, 0, first) };
            }
            // SAFETY: as above.
            None => unsafe { device.cmd_draw(cmd, mesh.count, 1, 0, first) },
        }
    }
}
