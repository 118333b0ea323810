//! Scenes as people have them, in which every mesh blocks and receives: rooms, streets, halls.
//!
//! ```text
//!   room       a table, chairs, shelves, a sofa      a ceiling panel, a window, a tube under a shelf
//!   street     houses, a fence, a car, trees, posts  a sun, two lamps
//!   colonnade  columns, plinths, balls, two walls    eight lamps in two rows
//! ```
//! They are made in code, in metres and with y up, and the same each time. Lights have names, and each is measured alone.

mod colonnade;
mod room;
mod street;

use crate::Problem;
use antumbra::scene::{AreaLight, Camera, Lens, Mesh, Role, Scene, generate};
use antumbra::{Light, RectangleLight};
use glam::{DMat3, DMat4, DVec3};
use std::f64::consts::TAU;

pub use room::ROOM;
pub use street::{STREET, SUN};

/// A scene that is made in code with lights and a camera of its own.
#[derive(Clone, Copy, Debug)]
pub struct Made {
    pub name: &'static str,
    pub make: fn() -> Result<Scene, Problem>,
    /// Where somebody who walks through it stands and looks, from 0, the beginning, to 1.
    pub walk: fn(f64) -> Camera,
}

/// All of them.
pub const ALL: [Made; 3] = [
    Made { name: ROOM, make: room::room, walk: room::walk },
    Made { name: STREET, make: street::street, walk: street::walk },
    Made { name: colonnade::COLONNADE, make: colonnade::colonnade, walk: colonnade::walk },
];

/// The scene of that name.
pub fn made(name: &str) -> Option<Made> {
    ALL.into_iter().find(|made| made.name == name)
}

/// A scene in the making.
struct Builder(Scene);

impl Builder {
    fn new() -> Self {
        Self(Scene::default())
    }

    fn add(&mut self, name: &str, mesh: Mesh, at: DMat4) {
        self.0.add(name, mesh, at, Role::Both);
    }

    /// A box of a size, with the middle of its bottom at a place.
    fn stand(&mut self, name: &str, size: [f64; 3], at: [f64; 3]) {
        self.turned(name, size, at, 0.0);
    }

    /// The same, turned about the vertical by an angle in radians.
    fn turned(&mut self, name: &str, size: [f64; 3], at: [f64; 3], turn: f64) {
        let middle = DMat4::from_translation(DVec3::Y * 0.5 * size[1]);
        let place = DMat4::from_translation(at.into()) * DMat4::from_rotation_y(turn) * middle;
        self.add(name, generate::cuboid(size.into()), place);
    }

    /// A ball about a place.
    fn ball(&mut self, name: &str, radius: f64, at: [f64; 3]) {
        let mesh = generate::uv_sphere(radius, 32, 16);
        self.add(name, mesh, DMat4::from_translation(at.into()));
    }

    /// An upright prism of 24 sides, with the middle of its bottom at a place.
    fn column(&mut self, name: &str, radius: f64, height: f64, at: [f64; 3]) {
        self.add(name, prism(radius, height, 24), DMat4::from_translation(at.into()));
    }

    fn light(&mut self, name: &str, light: impl Into<Light>) {
        let light = light.into();
        self.0.lights.push(AreaLight { name: name.into(), light, color: [1.0; 3], intensity: 1.0 });
    }

    /// A rectangle that shines in a direction, of a width and of a height along `up`, m.
    fn lamp(
        &mut self,
        name: &str,
        at: [f64; 3],
        to: DVec3,
        up: DVec3,
        size: [f64; 2],
    ) -> Result<(), Problem> {
        self.light(name, RectangleLight::facing(at, to, up, size)?);
        Ok(())
    }
}

/// A closed upright prism on the plane y = 0.
fn prism(radius: f64, height: f64, sides: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let rim = |i: u32| {
        let (sin, cos) = (TAU * f64::from(i % sides) / f64::from(sides)).sin_cos();
        DVec3::new(sin, 0.0, cos)
    };
    let mut face = |corners: &[DVec3], normals: &[DVec3]| {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(corners.iter().map(|c| c.as_vec3().to_array()));
        mesh.normals.extend(normals.iter().map(|n| n.as_vec3().to_array()));
        for i in 2..corners.len() as u32 {
            mesh.indices.extend([first, first + i - 1, first + i]);
        }
    };
    let up = DVec3::Y * height;
    for i in 0..sides {
        let [a, b] = [rim(i), rim(i + 1)];
        face(&[a * radius, b * radius, b * radius + up, a * radius + up], &[a, b, b, a]);
        face(&[up, a * radius + up, b * radius + up], &[DVec3::Y; 3]);
        face(&[DVec3::ZERO, b * radius, a * radius], &[DVec3::NEG_Y; 3]);
    }
    mesh
}

/// Somebody's eye.
fn looking(eye: DVec3, target: DVec3, yfov: f64) -> Camera {
    let z = (eye - target).normalize();
    let x = DVec3::Y.cross(z).normalize();
    let axes = DMat3::from_cols(x, z.cross(x), z);
    let world_from_view = DMat4::from_translation(eye) * DMat4::from_mat3(axes);
    Camera { world_from_view, lens: Lens::Perspective { yfov }, near: 0.05 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_mesh_is_whole_and_blocks_and_receives() {
        for made in ALL {
            let scene = (made.make)().unwrap();
            assert!(scene.instances.iter().all(|i| i.role == Role::Both), "{}", made.name);
            assert!(scene.lights.len() >= 3 && scene.camera.is_some(), "{}", made.name);
            for instance in &scene.instances {
                let mesh = &scene.meshes[instance.mesh];
                assert_eq!(mesh.positions.len(), mesh.normals.len());
                for t in mesh.indices.chunks_exact(3) {
                    let at =
                        |i: usize| DVec3::from_array(mesh.positions[t[i] as usize].map(f64::from));
                    let flat = (at(1) - at(0)).cross(at(2) - at(0));
                    let normal = mesh.normals[t[0] as usize].map(f64::from);
                    let named = (made.name, &instance.name);
                    assert!(flat.length() > 1e-12, "{named:?}: a triangle without area");
                    assert!(flat.dot(normal.into()) > 0.0, "{named:?}: it faces the other way");
                }
            }
        }
    }

    /// The walk goes on without a jump: no further than a step and a turn of the head in a two hundredth of it.
    #[test]
    fn walks_have_no_jumps() {
        for Made { name, walk, .. } in ALL {
            let at = |i: u32| walk(f64::from(i) / 200.0).world_from_view;
            for i in 0..200 {
                let (a, b) = (at(i), at(i + 1));
                let step = (b.w_axis - a.w_axis).length();
                let turn = b.z_axis.dot(a.z_axis).min(1.0).acos();
                assert!(
                    step > 0.0 && step < 0.2 && turn < 0.02,
                    "{name} {i}: {step} m, {turn} rad"
                );
            }
        }
    }
}
