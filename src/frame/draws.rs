//! What a frame draws: meshes, and the matrices that bring them into each view.

use super::Description;
use crate::Error;
use crate::lent::{Geometry, MeshBuffers, MeshInstance};
use glam::DMat4;

/// How a mesh's triangles are wound as the light sees them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Faces {
    /// Fronts are counter-clockwise.
    CounterClockwise,
    /// Fronts are clockwise: the mesh is mirrored.
    Clockwise,
    /// Every face is a front and a back.
    Both,
}

/// A mesh of a list, ready to be drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshDraw {
    /// The host's mesh.
    pub mesh: MeshInstance,
    /// Index into [`Description::position_strides`]; 0 for what the host draws.
    pub stride: usize,
    /// Which faces are fronts.
    pub faces: Faces,
}

/// The meshes of a list, and the matrices that bring them into each view of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct DrawList {
    pub meshes: Vec<MeshDraw>,
    /// Mesh space to clip space, by column; view by view, mesh by mesh.
    pub clip_from_mesh: Vec<[f32; 16]>,
}

impl DrawList {
    /// Draws nothing.
    pub fn clear(&mut self) {
        self.meshes.clear();
        self.clip_from_mesh.clear();
    }

    /// The meshes as each of some views sees them, which are given as light space to clip space. Meshes come into light
    /// space first: there a scene's distance from the world's origin is gone, before anything is rounded.
    pub fn fill<'a>(
        &mut self,
        description: &Description,
        meshes: impl ExactSizeIterator<Item = &'a MeshInstance>,
        light_from_world: &DMat4,
        views: &[DMat4],
    ) -> Result<(), Error> {
        self.clear();
        let count = meshes.len();
        self.clip_from_mesh.resize(views.len() * count, [0.0; 16]);
        for (nth, mesh) in meshes.enumerate() {
            self.meshes.push(draw_of(description, mesh)?);
            let light_from_mesh = *light_from_world * mesh.world_from_mesh;
            for (view, clip) in views.iter().enumerate() {
                let matrix = (*clip * light_from_mesh).as_mat4().to_cols_array();
                self.clip_from_mesh[view * count + nth] = matrix;
            }
        }
        Ok(())
    }
}

fn draw_of(description: &Description, mesh: &MeshInstance) -> Result<MeshDraw, Error> {
    let strides = &description.position_strides;
    let stride = match mesh.geometry {
        Geometry::HostDrawn(_) => 0,
        Geometry::Buffers(MeshBuffers { positions_stride: wanted, .. }) => {
            strides.iter().position(|&s| s == wanted).ok_or_else(|| {
                Error::Frame(format!(
                    "a mesh has a position stride of {wanted} bytes, which the description's \
                     position_strides {strides:?} do not hold"
                ))
            })?
        }
    };
    let faces = if mesh.double_sided {
        Faces::Both
    } else if mesh.world_from_mesh.determinant() < 0.0 {
        Faces::Clockwise
    } else {
        Faces::CounterClockwise
    };
    Ok(MeshDraw { mesh: *mesh, stride, faces })
}
