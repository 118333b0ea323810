//! Scenes: meshes, their roles, area lights and cameras.
//!
//! Plain data in world space, f64 where a transform is concerned. A scene comes from a glTF file
//! (feature `gltf`, `from_gltf`) or from the generators in [`generate`]; a host with its own
//! scene needs none of this.

use crate::RectangleLight;
use glam::{DMat4, DVec3};

pub mod generate;
#[cfg(feature = "gltf")]
mod gltf;
#[cfg(feature = "gltf")]
pub use gltf::from_gltf;

/// What a mesh does with light: blocks it, shows shadows, or both.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Role {
    /// Blocks light; its own pixels are never shadowed (visible fraction 1).
    Occluder,
    /// Shows shadows and blocks nothing.
    Receiver,
    /// Blocks light and shows shadows, its own included.
    #[default]
    Both,
}

impl Role {
    /// Whether a mesh of this role blocks light.
    pub fn blocks(self) -> bool {
        self != Self::Receiver
    }

    /// Whether a mesh of this role shows shadows.
    pub fn receives(self) -> bool {
        self != Self::Occluder
    }
}

/// Triangles in mesh space, metres once its instance's transform is applied.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// One position a vertex.
    pub positions: Vec<[f32; 3]>,
    /// One unit normal a vertex; as long as `positions`.
    pub normals: Vec<[f32; 3]>,
    /// Three indices a triangle, counter-clockwise seen from its front.
    pub indices: Vec<u32>,
    /// Both sides of each triangle are front faces.
    pub double_sided: bool,
}

/// A mesh placed in the world.
#[derive(Clone, Debug)]
pub struct Instance {
    /// The node's name, or `node N` where it has none.
    pub name: String,
    /// Index into [`Scene::meshes`].
    pub mesh: usize,
    /// Mesh space to world space; any affine transform, mirrored ones included.
    pub world_from_mesh: DMat4,
    /// Occluder, receiver or both.
    pub role: Role,
}

/// A rectangle light placed in the world.
#[derive(Clone, Debug)]
pub struct AreaLight {
    /// The node's name, or `node N` where it has none.
    pub name: String,
    /// Centre and half-axes.
    pub light: RectangleLight,
    /// Linear RGB, 1 each by default.
    pub color: [f32; 3],
    /// A factor on the color, 1 by default.
    pub intensity: f32,
}

/// A perspective camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// View space (x right, y up, looking along −z) to world space; rigid.
    pub world_from_view: DMat4,
    /// The vertical field of view, in radians, in (0, π).
    pub yfov: f64,
    /// The distance of the near plane, in metres, above 0.
    pub near: f64,
}

/// All that an image is made of.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// The triangles, each set once.
    pub meshes: Vec<Mesh>,
    /// Where they stand.
    pub instances: Vec<Instance>,
    /// The area lights, in the order of the file.
    pub lights: Vec<AreaLight>,
    /// The file's first camera; without one, see [`Camera::framing`].
    pub camera: Option<Camera>,
}

impl Scene {
    /// How many triangles all instances draw together.
    pub fn triangles(&self) -> usize {
        self.instances.iter().map(|i| self.meshes[i.mesh].indices.len() / 3).sum()
    }

    /// Every vertex of the instances that `keep` accepts, in world space.
    pub fn world_positions<'a>(
        &'a self,
        keep: impl Fn(&Instance) -> bool + 'a,
    ) -> impl Iterator<Item = DVec3> + 'a {
        self.instances.iter().filter(move |i| keep(i)).flat_map(|i| {
            self.meshes[i.mesh]
                .positions
                .iter()
                .map(|p| i.world_from_mesh.transform_point3(DVec3::from_array(p.map(f64::from))))
        })
    }
}
