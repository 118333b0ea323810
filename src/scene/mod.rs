//! Scenes: meshes, their roles, area lights and cameras.
//!
//! Plain data in world space, f64 where a transform is concerned. A scene comes from a glTF file
//! (feature `gltf`, `from_gltf`) or from the generators in [`generate`]; a host with its own
//! scene needs none of this.

pub use crate::lent::Role;

use crate::error::quoted;
use crate::lent::{MeshBounds, origin_of};
use crate::{Error, Light};
use glam::{DMat3, DMat4, DVec3, DVec4};

mod framing;
pub mod generate;
mod opacity;
pub use opacity::{OpacityMap, Wrap};
#[cfg(feature = "gltf")]
mod gltf;
#[cfg(feature = "gltf")]
pub use gltf::{GltfOptions, from_gltf, from_gltf_as, from_gltf_bytes};

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
    /// The alpha of a texture cuts holes into it, or lets light through, which its triangles do not tell.
    pub cut_out: bool,
    /// Index into [`Scene::opacity_maps`] of the texture that tells where; a mesh that is [`Self::cut_out`] and has none
    /// counts whole.
    pub opacity_map: Option<usize>,
    /// One place in the opacity map a vertex, (0, 0) at the map's first texel's corner and (1, 1) at the last one's; as long
    /// as `positions`, or empty where there is no opacity map.
    pub texture_coordinates: Vec<[f32; 2]>,
}

impl Mesh {
    /// The box around its positions, least and largest corner; inverted where there are none.
    pub fn bounds(&self) -> MeshBounds {
        let extreme = |pick: fn(f32, f32) -> f32, start: f32| {
            self.positions.iter().fold([start; 3], |m, p| [0, 1, 2].map(|i| pick(m[i], p[i])))
        };
        [extreme(f32::min, f32::INFINITY), extreme(f32::max, f32::NEG_INFINITY)]
    }

    /// Moves a mesh that lies far from the origin of its own space, as one in the coordinates of a country does, to around
    /// that origin. Returns the way that it was moved back by: its instances stay where they are with a translation by that
    /// behind their transforms. Along axes on which the mesh lies within three half-extents of the origin it stays.
    ///
    /// Nothing is rounded: f32 holds the difference of positions that are less than twice as large as each other. But what
    /// transforms the positions in f32 then rounds at the size of the mesh, not at that of its distance.
    pub fn move_to_origin(&mut self) -> DVec3 {
        let origin = origin_of(&self.bounds());
        if origin != [0.0; 3] {
            for position in &mut self.positions {
                *position = [0, 1, 2].map(|i| position[i] - origin[i]);
            }
        }
        DVec3::from_array(origin.map(f64::from))
    }
}

/// A mesh placed in the world.
#[derive(Clone, Debug)]
pub struct Instance {
    /// The node's name, or `node N` where it has none.
    pub name: String,
    /// Index into [`Scene::meshes`].
    pub mesh: usize,
    /// Mesh space to world space; any affine transform, mirrored and flattening ones included, so
    /// it may have no inverse.
    pub world_from_mesh: DMat4,
    /// Occluder, receiver or both.
    pub role: Role,
}

impl Instance {
    /// Whether the transform mirrors: a triangle that is counter-clockwise in the mesh is then
    /// clockwise in the world, and that side is still its front, as glTF 2.0 §3.7.4 has it.
    pub fn mirrored(&self) -> bool {
        self.world_from_mesh.determinant() < 0.0
    }

    /// Takes normals from mesh space to world space; the results still have to be normalized.
    ///
    /// These are the cofactors of the transform, which equal its inverse transpose but for a
    /// positive factor, and exist where the inverse does not.
    pub fn world_from_normal(&self) -> DMat3 {
        let m = DMat3::from_mat4(self.world_from_mesh);
        let cofactors = DMat3::from_cols(
            m.y_axis.cross(m.z_axis),
            m.z_axis.cross(m.x_axis),
            m.x_axis.cross(m.y_axis),
        );
        if self.mirrored() { -cofactors } else { cofactors }
    }
}

/// A light placed in the world.
#[derive(Clone, Debug)]
pub struct AreaLight {
    /// The node's name, or `node N` where it has none.
    pub name: String,
    /// Shape, size and place.
    pub light: Light,
    /// Linear RGB, 1 each by default.
    pub color: [f32; 3],
    /// A factor on the color, 1 by default.
    pub intensity: f32,
}

/// A camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// View space (x right, y up, looking along −z) to world space; rigid.
    pub world_from_view: DMat4,
    /// How view space is projected.
    pub lens: Lens,
    /// The distance of the near plane, in metres: above 0, or 0 too for an orthographic camera.
    pub near: f64,
}

/// How a camera projects what it sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lens {
    /// A perspective without a far plane.
    Perspective {
        /// The vertical field of view, in radians, in (0, π).
        yfov: f64,
    },
    /// Parallel rays.
    Orthographic {
        /// Half the width and height of what is seen at least, in metres, above 0.
        half: [f64; 2],
        /// The distance of the far plane, in metres, beyond the near one.
        far: f64,
    },
}

impl Camera {
    /// View space to Vulkan's clip space, y down, with reversed depth: 1 at the near plane, and 0 infinitely far away or
    /// at an orthographic camera's far plane. `aspect` is the image's width over its height; where an orthographic
    /// camera's differs, the image shows more than it says, and not less.
    pub fn clip_from_view(&self, aspect: f64) -> DMat4 {
        match self.lens {
            Lens::Perspective { yfov } => {
                let scale = 1.0 / (0.5 * yfov).tan();
                DMat4::from_cols(
                    DVec4::new(scale / aspect, 0.0, 0.0, 0.0),
                    DVec4::new(0.0, -scale, 0.0, 0.0),
                    DVec4::new(0.0, 0.0, 0.0, -1.0),
                    DVec4::new(0.0, 0.0, self.near, 0.0),
                )
            }
            Lens::Orthographic { half: [x, y], far } => {
                let half = y.max(x / aspect);
                let range = far - self.near;
                DMat4::from_cols(
                    DVec4::new(1.0 / (half * aspect), 0.0, 0.0, 0.0),
                    DVec4::new(0.0, -1.0 / half, 0.0, 0.0),
                    DVec4::new(0.0, 0.0, 1.0 / range, 0.0),
                    DVec4::new(0.0, 0.0, far / range, 1.0),
                )
            }
        }
    }
}

/// The meshes, lights and camera of an image.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// The meshes, each once however often it is placed.
    pub meshes: Vec<Mesh>,
    /// The placements of the meshes.
    pub instances: Vec<Instance>,
    /// The textures that say where meshes stop light.
    pub opacity_maps: Vec<OpacityMap>,
    /// The area lights, in the order of the file.
    pub lights: Vec<AreaLight>,
    /// The camera that shows the scene: the file's first, or another by [`Self::set_camera`]; without one, see
    /// [`Camera::framing`].
    pub camera: Option<Camera>,
    /// All of the file's cameras with their nodes' names, in the order of the nodes.
    pub cameras: Vec<(String, Camera)>,
    /// What the scene's file says and this reading of it leaves out, a sentence each; a user should see them.
    pub notes: Vec<String>,
}

/// An axis-aligned box in world space, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The least coordinates.
    pub min: DVec3,
    /// The greatest coordinates.
    pub max: DVec3,
}

impl Bounds {
    /// The middle of the box.
    pub fn center(&self) -> DVec3 {
        self.min.midpoint(self.max)
    }

    /// The lengths of its edges.
    pub fn size(&self) -> DVec3 {
        self.max - self.min
    }

    /// The eight corners.
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            let pick = |bit: usize, low: f64, high: f64| if i >> bit & 1 == 0 { low } else { high };
            DVec3::new(
                pick(0, self.min.x, self.max.x),
                pick(1, self.min.y, self.max.y),
                pick(2, self.min.z, self.max.z),
            )
        })
    }
}

impl Scene {
    /// The number of triangles that all instances draw together; `usize::MAX` where it overflows.
    pub fn triangles(&self) -> usize {
        let of_each = self.instances.iter().map(|i| self.meshes[i.mesh].indices.len() / 3);
        of_each.fold(0, usize::saturating_add)
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

    /// The box around the instances that `keep` accepts; `None` where they hold no vertex.
    pub fn bounds(&self, keep: impl Fn(&Instance) -> bool) -> Option<Bounds> {
        self.world_positions(keep).fold(None, |bounds, p| {
            let b = bounds.unwrap_or(Bounds { min: p, max: p });
            Some(Bounds { min: b.min.min(p), max: b.max.max(p) })
        })
    }

    /// Adds a mesh, placed once.
    pub fn add(&mut self, name: &str, mesh: Mesh, world_from_mesh: DMat4, role: Role) {
        let instance =
            Instance { name: name.into(), mesh: self.meshes.len(), world_from_mesh, role };
        self.meshes.push(mesh);
        self.instances.push(instance);
    }

    /// The light of that name, or the first one.
    ///
    /// # Errors
    /// [`Error::Scene`] where there is no such light; the sentence names those there are.
    pub fn light(&self, name: Option<&str>) -> Result<&AreaLight, Error> {
        let Some(first) = self.lights.first() else {
            return Err(Error::Scene(
                "the scene has no area light; give a node the extras \"area_light\": \"rectangle\", \
                 \"width\" and \"height\", \"disk\" or \"sphere\" and \"radius\", \"capsule\", \"radius\" and \
                 \"length\", \"polygon\" and \"corners\", or \"sun\" and \"angular_size\""
                    .into(),
            ));
        };
        let Some(name) = name else { return Ok(first) };
        self.lights.iter().find(|l| l.name == name).ok_or_else(|| {
            Error::Scene(format!(
                "no light is named {}; the lights are {}",
                quoted(name),
                listed(self.lights.iter().map(|l| l.name.as_str()))
            ))
        })
    }

    /// Shows the scene from the first camera whose node has that name.
    ///
    /// # Errors
    /// [`Error::Scene`] where no camera has that name; the sentence names those there are.
    pub fn set_camera(&mut self, node: &str) -> Result<(), Error> {
        let Some((_, camera)) = self.cameras.iter().find(|(name, _)| name == node) else {
            let names = || self.cameras.iter().map(|(name, _)| name.as_str());
            return Err(Error::Scene(match self.cameras.is_empty() {
                true => format!("no camera is named {}; the scene has none", quoted(node)),
                false => {
                    format!(
                        "no camera is named {}; the cameras are {}",
                        quoted(node),
                        listed(names())
                    )
                }
            }));
        };
        self.camera = Some(*camera);
        Ok(())
    }

    /// Gives every instance of the node of that name another role.
    ///
    /// # Errors
    /// [`Error::Scene`] where no node with a mesh has that name; the sentence names those there are.
    pub fn set_role(&mut self, node: &str, role: Role) -> Result<(), Error> {
        let mut found = false;
        for instance in self.instances.iter_mut().filter(|i| i.name == node) {
            instance.role = role;
            found = true;
        }
        if found {
            return Ok(());
        }
        Err(Error::Scene(format!(
            "no node with a mesh is named {}; the nodes are {}",
            quoted(node),
            listed(self.instances.iter().map(|i| i.name.as_str()))
        )))
    }
}

/// The number of names that a sentence lists before it counts the rest.
const NAMES_LISTED: usize = 6;

/// The first of some names, each once, and how many more there are.
fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let mut seen: Vec<&str> = Vec::new();
    for name in names {
        // An instance shares its node's name with the others of that node, which are its neighbours.
        if seen.last() != Some(&name) {
            seen.push(name);
        }
    }
    if seen.is_empty() {
        return "none".into();
    }
    let shown: Vec<String> = seen.iter().take(NAMES_LISTED).map(|n| quoted(n)).collect();
    let more = seen.len().saturating_sub(NAMES_LISTED);
    if more > 0 { format!("{} and {more} more", shown.join(", ")) } else { shown.join(", ") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::NAME_SHOWN;

    #[test]
    fn a_sentence_lists_a_few_names_on_one_line() {
        let names: Vec<String> = (0..9).map(|i| format!("n\n{i}")).collect();
        let sentence = listed(names.iter().map(String::as_str));
        assert!(sentence.ends_with(r#""n\n5" and 3 more"#), "{sentence}");
        assert!(!sentence.contains('\n'));
        assert_eq!(listed(["a", "a", "b"].into_iter()), r#""a", "b""#);
        assert_eq!(quoted(&"é".repeat(100)).chars().count(), NAME_SHOWN + 3);
    }
}
