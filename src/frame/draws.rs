//! The meshes that a frame draws, and the matrices that transform them into each view.

use super::{CutOutList, Description};
use crate::Error;
use crate::lent::{Geometry, MeshBuffers, MeshInstance, from_origin, origin_of};
use glam::DMat4;

/// Which of a mesh's triangles face the light: the winding of front faces, as the light sees them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Faces {
    /// Front faces are counter-clockwise.
    CounterClockwise,
    /// Front faces are clockwise: the mesh's transform mirrors it.
    Clockwise,
    /// Every face counts as a front and a back face: the mesh is double-sided.
    Both,
}

/// A mesh with the state that draws it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshDraw {
    /// The host's mesh.
    pub mesh: MeshInstance,
    /// The index of the mesh's stride in [`Description::position_strides`]; 0 for a mesh that the host draws.
    pub stride: usize,
    /// Which faces are front faces.
    pub faces: Faces,
    /// What is subtracted from positions before the matrix; 0 for a mesh that the host draws.
    pub origin: [f32; 3],
    /// The mesh's number among those of the frame that textures cut out; `None` for one that is drawn whole.
    pub cut_out: Option<u32>,
}

/// A list of meshes, and the matrices that transform them into each of the list's views.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct DrawList {
    pub meshes: Vec<MeshDraw>,
    /// Matrices from mesh space, moved by each mesh's origin, to clip space, column-major: all meshes of view 0, then those
    /// of view 1, and so on.
    pub clip_from_mesh: Vec<[f32; 16]>,
}

impl DrawList {
    /// Empties the list.
    pub fn clear(&mut self) {
        self.meshes.clear();
        self.clip_from_mesh.clear();
    }

    /// Fills the list with `meshes` for `views`, matrices from light space to clip space. The product with the mesh's
    /// transform is made in light space and 64 bits, so that a scene far from the world's origin loses no precision.
    ///
    /// # Errors
    /// [`Error::Frame`] for a mesh whose stride is not in the description.
    pub fn fill<'a>(
        &mut self,
        description: &Description,
        meshes: impl ExactSizeIterator<Item = (u32, &'a MeshInstance)>,
        cut_outs: &CutOutList,
        light_from_world: &DMat4,
        views: &[DMat4],
    ) -> Result<(), Error> {
        self.clear();
        let count = meshes.len();
        self.clip_from_mesh.resize(views.len() * count, [0.0; 16]);
        for (nth, (place, mesh)) in meshes.enumerate() {
            let cut_out = cut_outs.number_of(place as usize);
            let draw = MeshDraw { cut_out, ..draw_of(description, mesh)? };
            let light_from_origin =
                *light_from_world * from_origin(&mesh.world_from_mesh, draw.origin);
            self.meshes.push(draw);
            for (view, clip) in views.iter().enumerate() {
                let matrix = (*clip * light_from_origin).as_mat4().to_cols_array();
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
    let origin = match mesh.geometry {
        Geometry::HostDrawn(_) => [0.0; 3],
        Geometry::Buffers(_) => origin_of(&mesh.bounds),
    };
    Ok(MeshDraw { mesh: *mesh, stride, faces, origin, cut_out: None })
}
