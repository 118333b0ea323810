//! Records a plan into a command buffer: with `record/meshes.rs` the only file that calls `vkCmd*` for the node's passes.
//!
//! Recording allocates, creates, submits and waits for nothing.

use super::descriptors::Descriptors;
use super::host::Host;
use super::measured::Measured;
use super::mesh_sets::{CutOutSets, MeshSets};
use super::objects::{Object, Objects, layers, whole};
use super::pipeline::PassObjects;
use super::result::ResultImage;
use super::timing::Timing;
use crate::frame::{Faces, FramePlan, Part};
use crate::graph::{
    self, COLOR_ATTACHMENTS, Draw, Layer, Owner, Pass, ResourceBarrier, ResourceId, Shape, Step,
    Target, Use, Work,
};
use crate::lent::Geometry;
use ash::vk;
use std::ffi::CString;

mod meshes;

/// The most bytes that one command writes into a buffer.
const MOST_UPDATED: usize = 65536;

/// The most barriers that one call records; longer lists take several calls.
const BATCH: usize = 16;

/// A mesh that the host draws with its own pipeline, inside a pass of the node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HostDraw {
    /// The command buffer, inside the layer's render pass. The callback binds its pipeline and draws; it neither ends
    /// the render pass nor leaves queries open.
    pub cmd: vk::CommandBuffer,
    /// The number that [`Geometry::HostDrawn`] gave the mesh.
    pub mesh: u64,
    /// The layer that is drawn.
    pub layer: Layer,
    /// The matrix from mesh space to clip space, column-major, for a viewport as large as the layer; a frame may use a
    /// corner of it.
    pub clip_from_mesh: [f32; 16],
    /// The winding of front faces in that clip space, as in the node's own draws.
    pub faces: Faces,
}

/// The objects of a node that recording needs.
pub(crate) struct Recorder<'a> {
    pub host: &'a Host,
    pub objects: &'a Objects,
    /// The node's own visibility image; `None` where the host lends it.
    pub result: Option<&'a ResultImage>,
    /// The objects of each kind of pass, in the order of the labels.
    pub kinds: &'a [PassObjects],
    pub labels: &'a [CString],
    pub descriptors: &'a Descriptors,
    pub mesh_sets: &'a MeshSets,
    pub cut_out_sets: &'a CutOutSets,
    pub timing: Option<&'a Timing>,
    /// The figures of the audit; `None` where the description has none.
    pub measured: Option<&'a Measured>,
    /// The number of this frame among the light's; 0 for one without an audit.
    pub number: u32,
    /// The place of this frame's descriptor sets and timestamps.
    pub place: usize,
    /// The number of the first of `kinds` among the kinds of all techniques.
    pub first_kind: usize,
    pub draw: &'a mut dyn FnMut(&HostDraw),
    pub cmd: vk::CommandBuffer,
}

impl Recorder<'_> {
    /// Records every step of a plan, and the barriers after the last; or those of one of its parts.
    pub fn record(&mut self, frame: &FramePlan, part: Option<Part>) {
        let plan = &frame.plan;
        let split = frame.light_steps();
        if part != Some(Part::Pixels) {
            self.begin(frame);
        }
        let steps = match part {
            None => 0..plan.steps.len(),
            Some(Part::Light) => 0..split,
            Some(Part::Pixels) => split..plan.steps.len(),
        };
        if let (Some(Part::Pixels), Some(timing), false) = (part, self.timing, steps.is_empty()) {
            timing.resume(self.host, self.cmd, self.place, split);
        }
        // The audit's passes are behind those of the pixels.
        if let Some(measured) = self.measured.filter(|_| part != Some(Part::Light)) {
            let runs = |s: &Step| matches!(plan.graph.passes()[s.pass].work, Work::FrameNumber);
            let audited = plan.steps.iter().any(runs);
            self.number = measured.begin(self.place, frame.light_index(), audited);
        }
        for (nth, step) in plan.steps.iter().enumerate().take(steps.end).skip(steps.start) {
            let pass = &plan.graph.passes()[step.pass];
            let kind = plan.graph.kind_of(step.pass);
            self.label(kind);
            self.barriers(frame, &step.barriers);
            self.pass(frame, kind, pass, step.first);
            self.unlabel();
            if let Some(timing) = self.timing {
                let kind = self.first_kind + kind;
                timing.end_pass(self.host, self.cmd, self.place, (nth, kind));
            }
        }
        if part != Some(Part::Light) {
            self.barriers(frame, &plan.handover);
        }
    }

    /// Begins a frame: resets its timestamps, and writes the sets of its meshes.
    fn begin(&mut self, frame: &FramePlan) {
        if let Some(timing) = self.timing {
            match frame.plan.steps.is_empty() {
                true => timing.nothing(self.place),
                false => timing.begin(self.host, self.cmd, self.place),
            }
        }
        if !frame.triangles.meshes.is_empty() {
            self.mesh_sets.write(self.host, &frame.triangles, self.place);
        }
        self.cut_out_sets.write(self.host, &frame.cut_outs, self.place);
    }

    fn pass(&mut self, frame: &FramePlan, kind: usize, pass: &Pass, first: bool) {
        let (host, cmd, made) = (self.host, self.cmd, &self.kinds[kind]);
        let device = &host.device;
        let objects = self.objects;
        let set = self.descriptors.set(pass, kind, self.place);
        let point = match pass.work {
            Work::Dispatch { .. }
            | Work::Indirect { .. }
            | Work::EachMesh { .. }
            | Work::EachCutOut { .. }
            | Work::CutOuts
            | Work::Constants { .. }
            | Work::FrameNumber => vk::PipelineBindPoint::COMPUTE,
            Work::Raster { .. } => vk::PipelineBindPoint::GRAPHICS,
        };
        if let Some(set) = set {
            if first {
                self.descriptors.write(host, pass, set, |u| self.look_up(frame, u));
            }
            // SAFETY: Host::borrow's promise: cmd is recording. The set was made for this layout.
            unsafe {
                device.cmd_bind_descriptor_sets(cmd, point, made.layouts.pipeline, 0, &[set], &[]);
            };
        }
        let pushed = pass.push.bytes();
        let number = [self.number, frame.light_index().0];
        let constants = match pass.work {
            Work::Constants { offset } => Some((offset, pushed)),
            Work::FrameNumber => Some((0, bytemuck::cast_slice(&number))),
            Work::CutOuts => Some((0, bytemuck::cast_slice(&frame.cut_outs.records))),
            _ => None,
        };
        if let Some((offset, bytes)) = constants {
            let target = pass.uses.first().map_or(Object::None, |u| objects.get(u.resource));
            if let Object::Buffer(buffer) = target {
                for (chunk, bytes) in (0u64..).zip(bytes.chunks(MOST_UPDATED)) {
                    let offset = offset + chunk * MOST_UPDATED as u64;
                    // SAFETY: Host::borrow's promise: cmd is recording outside a render pass; the buffer has
                    // TRANSFER_DST usage, and holds these bytes from a multiple of 4 on.
                    unsafe { device.cmd_update_buffer(cmd, buffer, offset, bytes) };
                }
            }
            return;
        }
        if !pushed.is_empty() {
            // SAFETY: as above; the layout's range holds exactly these bytes.
            unsafe {
                device.cmd_push_constants(cmd, made.layouts.pipeline, made.push_stages, 0, pushed);
            };
        }
        match pass.work {
            Work::Dispatch { groups: [x, y, z], .. } => {
                // SAFETY: as above; outside a render pass.
                unsafe { device.cmd_bind_pipeline(cmd, point, made.pipelines[0]) };
                // SAFETY: a compute pipeline, its set and push constants are bound; the barriers
                // that its accesses need were recorded before it.
                unsafe { device.cmd_dispatch(cmd, x, y, z) };
            }
            Work::Constants { .. } | Work::FrameNumber | Work::CutOuts => {}
            Work::EachMesh { .. } => self.each_mesh(frame, made),
            Work::EachCutOut { textures: true, .. } => self.each_texture(frame, made),
            Work::EachCutOut { .. } => self.each_cut_out(frame, made),
            Work::Indirect { arguments, offset, .. } => {
                let Object::Buffer(buffer) = objects.get(arguments) else { return };
                // SAFETY: as for the other grids; the buffer holds one VkDispatchIndirectCommand,
                // which an earlier pass wrote.
                unsafe { device.cmd_bind_pipeline(cmd, point, made.pipelines[0]) };
                // SAFETY: as above.
                unsafe { device.cmd_dispatch_indirect(cmd, buffer, offset) };
            }
            Work::Raster { target, draw, .. } => {
                self.begin_render_pass(made, target);
                let drawn = self.set_viewport(frame, made, pass);
                match draw {
                    Draw::Layer { layer, view } => {
                        for (draw, matrix) in frame.draws(layer.meshes(), view) {
                            match &draw.mesh.geometry {
                                Geometry::Buffers(buffers) => {
                                    self.mesh(made, draw, matrix, buffers);
                                }
                                &Geometry::HostDrawn(mesh) => (self.draw)(&HostDraw {
                                    cmd,
                                    mesh,
                                    layer,
                                    clip_from_mesh: in_corner(matrix, drawn),
                                    faces: draw.faces,
                                }),
                            }
                        }
                    }
                    Draw::Indirect { arguments, offset } => {
                        self.indirect(made, arguments, offset);
                    }
                }
                // SAFETY: the render pass was begun above.
                unsafe { device.cmd_end_render_pass(cmd) };
            }
        }
    }

    fn begin_render_pass(&self, made: &PassObjects, target: Target) {
        let clear = match target {
            Target::Depth { clear, .. } => vk::ClearValue {
                depth_stencil: vk::ClearDepthStencilValue { depth: clear, stencil: 0 },
            },
            Target::Add => vk::ClearValue { color: vk::ClearColorValue { float32: [0.0; 4] } },
        };
        let clear = [clear; COLOR_ATTACHMENTS];
        let begin = vk::RenderPassBeginInfo::default()
            .render_pass(made.render_pass)
            .framebuffer(made.framebuffer)
            .render_area(vk::Rect2D { extent: made.extent, ..Default::default() })
            .clear_values(&clear[..made.colors.max(1)]);
        // SAFETY: Host::borrow's promise: cmd is recording outside a render pass; the barriers
        // before put the attachment into the render pass's layout.
        unsafe {
            self.host.device.cmd_begin_render_pass(self.cmd, &begin, vk::SubpassContents::INLINE);
        }
    }

    /// Sets viewport and scissor to the part of the attachments that the frame uses; returns its shares of both sides.
    fn set_viewport(&self, frame: &FramePlan, made: &PassObjects, pass: &Pass) -> [f32; 2] {
        let used = |id| match frame.plan.graph.resource(id).shape {
            Shape::Image { width, height, .. } => Some(vk::Extent2D { width, height }),
            Shape::Buffer { .. } => None,
        };
        let extent = pass.writes().find_map(used).unwrap_or(made.extent);
        let [width, height] = [extent.width as f32, extent.height as f32];
        let viewport = vk::Viewport { width, height, max_depth: 1.0, ..Default::default() };
        let scissor = vk::Rect2D { extent, ..Default::default() };
        let (device, cmd) = (&self.host.device, self.cmd);
        // SAFETY: Host::borrow's promise: cmd is recording; the pass's pipelines have this state dynamic.
        unsafe { device.cmd_set_viewport(cmd, 0, &[viewport]) };
        // SAFETY: as above.
        unsafe { device.cmd_set_scissor(cmd, 0, &[scissor]) };
        [width / made.extent.width as f32, height / made.extent.height as f32]
    }

    fn indirect(&self, made: &PassObjects, arguments: ResourceId, offset: u64) {
        let Object::Buffer(buffer) = self.objects.get(arguments) else { return };
        let (device, cmd) = (&self.host.device, self.cmd);
        let point = vk::PipelineBindPoint::GRAPHICS;
        // SAFETY: inside the pass's render pass, with a pipeline made for it.
        unsafe { device.cmd_bind_pipeline(cmd, point, made.pipelines[0]) };
        // SAFETY: the buffer holds one VkDrawIndirectCommand, which an earlier pass wrote.
        unsafe { device.cmd_draw_indirect(cmd, buffer, offset, 1, 0) };
    }

    fn barriers(&self, frame: &FramePlan, barriers: &[ResourceBarrier]) {
        for batch in barriers.chunks(BATCH) {
            let mut images = [vk::ImageMemoryBarrier::default(); BATCH];
            let mut buffers = [vk::BufferMemoryBarrier::default(); BATCH];
            let (mut image_count, mut buffer_count) = (0, 0);
            let mut src = vk::PipelineStageFlags::empty();
            let mut dst = vk::PipelineStageFlags::empty();
            for ResourceBarrier { resource, barrier } in batch {
                src |= barrier.src_stage;
                dst |= barrier.dst_stage;
                match self.object_of(frame, *resource) {
                    Object::Image { image, .. } => {
                        images[image_count] = vk::ImageMemoryBarrier::default()
                            .src_access_mask(barrier.src_access)
                            .dst_access_mask(barrier.dst_access)
                            .old_layout(barrier.old_layout)
                            .new_layout(barrier.new_layout)
                            .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
                            .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
                            .image(image)
                            .subresource_range(self.range(frame, *resource));
                        image_count += 1;
                    }
                    Object::Buffer(buffer) => {
                        buffers[buffer_count] = vk::BufferMemoryBarrier::default()
                            .src_access_mask(barrier.src_access)
                            .dst_access_mask(barrier.dst_access)
                            .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
                            .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
                            .buffer(buffer)
                            .size(vk::WHOLE_SIZE);
                        buffer_count += 1;
                    }
                    Object::None => {}
                }
            }
            // SAFETY: Host::borrow's promise: cmd is recording outside a render pass, and the
            // images are in the layouts that the host said.
            unsafe {
                self.host.device.cmd_pipeline_barrier(
                    self.cmd,
                    src,
                    dst,
                    vk::DependencyFlags::empty(),
                    &[],
                    &buffers[..buffer_count],
                    &images[..image_count],
                );
            }
        }
    }

    fn label(&self, kind: usize) {
        if let (Some(debug_utils), Some(label)) = (&self.host.debug_utils, self.labels.get(kind)) {
            let info = vk::DebugUtilsLabelEXT::default().label_name(label);
            // SAFETY: Host::borrow's promise: cmd is recording; `unlabel` follows.
            unsafe { debug_utils.cmd_begin_debug_utils_label(self.cmd, &info) };
        }
    }

    fn unlabel(&self) {
        if let Some(debug_utils) = &self.host.debug_utils {
            // SAFETY: `label` came before.
            unsafe { debug_utils.cmd_end_debug_utils_label(self.cmd) };
        }
    }

    /// The object of a resource: the one the host lends for this frame, the visibility image, or one of the
    /// technique's.
    fn object_of(&self, frame: &FramePlan, id: ResourceId) -> Object {
        if let Some((_, host)) = frame.imports.iter().find(|(r, _)| *r == id) {
            return Object::Image { image: host.image, view: host.view };
        }
        if let Some(result) = self.result.filter(|_| id == frame.visibility) {
            return result.layer(frame.light_index().0);
        }
        match frame.plan.graph.resource(id).owner {
            Owner::HostRead => self.measured.map_or(Object::None, |m| m.object(self.place)),
            _ => self.objects.get(id),
        }
    }

    /// The layers that a barrier for a resource covers: the light's layer of the visibility image, all layers of
    /// others.
    fn range(&self, frame: &FramePlan, id: ResourceId) -> vk::ImageSubresourceRange {
        let aspect = graph::aspects(frame.plan.graph.resource(id).shape);
        match self.result.filter(|_| id == frame.visibility) {
            Some(_) => layers(aspect, frame.light_index().0, 1),
            None => whole(aspect),
        }
    }

    /// The object of a use, and its layout while the shader uses it.
    fn look_up(&self, frame: &FramePlan, u: &Use) -> (Object, vk::ImageLayout) {
        let border = frame.plan.boundary.iter().find(|b| b.resource == u.resource);
        let layout = border.map_or(u.access.scope().layout, |b| b.entry.layout);
        (self.object_of(frame, u.resource), layout)
    }
}

/// A matrix to clip space with the window moved to the first corner of a viewport and made smaller by these shares.
///
/// A host's own pipeline draws through a viewport as large as the attachment, of which a frame may use a part.
fn in_corner(matrix: &[f32; 16], shares: [f32; 2]) -> [f32; 16] {
    let mut moved = *matrix;
    for column in moved.chunks_exact_mut(4) {
        for (i, share) in shares.into_iter().enumerate() {
            column[i] = share * column[i] + (share - 1.0) * column[3];
        }
    }
    moved
}
