//! Scenes of what people report of shadows, each of a few simple shapes: where a map of the scene from its lamp leaks, is
//! dotted, or is too coarse. Every mesh blocks and receives.

use antumbra::scene::{AreaLight, Camera, Lens, Mesh, Role, Scene, generate};
use antumbra::{Light, RectangleLight};
use glam::{DMat3, DMat4, DVec3};
use std::f64::consts::PI;

/// A scene, and how somebody looks at it.
#[derive(Clone, Debug)]
pub struct Situation {
    /// The meshes and the one lamp.
    pub scene: Scene,
    /// The eye.
    pub camera: Camera,
}

/// A camera at `eye` that looks at `target`; `yfov` in radians.
pub fn looking(eye: [f64; 3], target: [f64; 3], yfov: f64) -> Camera {
    let (eye, target) = (DVec3::from_array(eye), DVec3::from_array(target));
    let z = (eye - target).normalize();
    let x = DVec3::Y.cross(z).normalize();
    let world_from_view =
        DMat4::from_translation(eye) * DMat4::from_mat3(DMat3::from_cols(x, z.cross(x), z));
    Camera { world_from_view, lens: Lens::Perspective { yfov }, near: 0.05 }
}

/// A square lamp at `at` of this side that faces `target`.
pub(crate) fn lamp(at: [f64; 3], target: [f64; 3], side: f64) -> RectangleLight {
    let (at, target) = (DVec3::from_array(at), DVec3::from_array(target));
    let towards = (target - at).normalize();
    let up = if towards.y.abs() > 0.99 { DVec3::NEG_Z } else { DVec3::Y };
    RectangleLight::facing(at, towards, up, [side; 2]).unwrap()
}

impl Situation {
    /// Nothing under a light.
    fn new(light: impl Into<Light>, camera: Camera) -> Self {
        let mut scene = Scene::default();
        scene.lights.push(AreaLight {
            name: "lamp".into(),
            light: light.into(),
            color: [1.0; 3],
            intensity: 1.0,
        });
        Self { scene, camera }
    }

    /// A floor of 8 m around the origin.
    pub(crate) fn on_floor(light: impl Into<Light>, camera: Camera) -> Self {
        Self::new(light, camera).and("floor", generate::ground(8.0), [0.0; 3])
    }

    /// The same and a mesh more.
    #[must_use]
    pub fn and(self, name: &str, mesh: Mesh, at: [f64; 3]) -> Self {
        self.with(name, mesh, DMat4::from_translation(DVec3::from_array(at)))
    }

    fn with(mut self, name: &str, mesh: Mesh, at: DMat4) -> Self {
        self.scene.add(name, mesh, at, Role::Both);
        self
    }

    /// The same and a box between two corners.
    #[must_use]
    pub fn and_box(self, name: &str, low: [f64; 3], high: [f64; 3]) -> Self {
        let (low, high) = (DVec3::from_array(low), DVec3::from_array(high));
        self.and(name, generate::cuboid(high - low), low.midpoint(high).to_array())
    }
}

/// A mesh whose fronts are its backs.
fn inside_out(mesh: Mesh) -> Mesh {
    let mut mesh = mesh;
    mesh.indices.chunks_exact_mut(3).for_each(|t| t.swap(1, 2));
    mesh.normals.iter_mut().for_each(|n| *n = n.map(|x| -x));
    mesh
}

/// A standing sheet with two fronts, `width` along its x and `height` along its y, round the origin.
pub(crate) fn sheet(width: f64, height: f64) -> Mesh {
    let mut mesh = generate::quad(width, height);
    for p in mesh.positions.iter_mut().chain(&mut mesh.normals) {
        *p = [p[0], -p[2], p[1]];
    }
    Mesh { double_sided: true, ..mesh }
}

/// A post on the floor, and a board that leans and whose lowest edge is `lift` above the floor, or below it.
pub fn post_and_board(lift: f64) -> Situation {
    let light = lamp([-2.2, 2.6, 0.6], [0.0, 0.3, -0.2], 0.6);
    let camera = looking([1.5, 2.0, 2.4], [0.5, 0.4, 0.05], 0.75);
    let (half, turn) = (DVec3::new(0.3, 0.6, 0.02), 0.4_f64);
    let up = lift + half.y * turn.cos() + half.z * turn.sin();
    let place = DMat4::from_translation(DVec3::new(0.3, up, -0.4)) * DMat4::from_rotation_x(-turn);
    Situation::on_floor(light, camera)
        .and_box("post", [-0.46, 0.0, -0.06], [-0.34, 1.5, 0.06])
        .with("board", generate::cuboid(2.0 * half), place)
}

/// Wires of 4 mm that reach from `foot` up to 1.5 m, before a cable.
pub fn fence(foot: f64) -> Situation {
    let light = lamp([0.4, 2.6, -1.6], [0.1, 0.0, 0.3], 0.3);
    let camera = looking([1.5, 1.9, 2.6], [0.2, 0.5, 0.3], 0.75);
    let mut made = Situation::on_floor(light, camera);
    for i in 0..32 {
        let x = -1.0 + f64::from(i) / 16.0;
        made = made.and_box("wire", [x, foot, -0.002], [x + 0.004, 1.5, 0.002]);
    }
    made.and_box("cable", [-1.5, 1.24, 0.494], [1.5, 1.252, 0.506])
}

/// A rug 1 mm and a mat 5 mm over the floor, both without thickness, and a cup on the mat.
pub fn decal() -> Situation {
    let light = lamp([0.8, 1.5, -0.5], [0.1, 0.0, 0.1], 0.3);
    let camera = looking([0.9, 0.8, 1.2], [0.1, 0.0, 0.1], 0.75);
    Situation::on_floor(light, camera)
        .and("rug", generate::quad(1.2, 1.0), [0.0, 0.001, 0.0])
        .and("mat", generate::quad(0.4, 0.4), [0.1, 0.005, 0.1])
        .and_box("cup", [0.06, 0.005, 0.06], [0.14, 0.105, 0.14])
}

/// A lamp 5 cm up in a fixture whose rim alone makes the penumbra on the floor, and a post.
pub fn downlight() -> Situation {
    let light = lamp([0.0, 2.0, 0.0], [0.0; 3], 0.3);
    let camera = looking([1.9, 1.7, 1.9], [0.3, 0.4, 0.3], 0.75);
    Situation::on_floor(light, camera)
        .and_box("rim 0", [0.19, 1.92, -0.2], [0.21, 2.02, 0.2])
        .and_box("rim 1", [-0.21, 1.92, -0.2], [-0.19, 2.02, 0.2])
        .and_box("rim 2", [-0.2, 1.92, 0.19], [0.2, 2.02, 0.21])
        .and_box("rim 3", [-0.2, 1.92, -0.21], [0.2, 2.02, -0.19])
        .and_box("top", [-0.2, 2.02, -0.2], [0.2, 2.04, 0.2])
        .and_box("post", [0.25, 0.0, 0.15], [0.35, 0.6, 0.25])
}

/// One surface of 2,048 facets, all of which the lamp reaches whole.
pub fn facets() -> Situation {
    const SIDE: u32 = 32;
    let light = lamp([0.4, 4.0, 0.3], [0.0; 3], 1.0);
    let camera = looking([0.0, 2.4, 3.4], [0.0, -0.05, -0.17], 0.75);
    // Half of the facets are steeper than 27°, and none steeper than 65°.
    let height = |i: u32, k: u32| {
        let mixed =
            (i.wrapping_mul(374_761_393) ^ k.wrapping_mul(668_265_263)).wrapping_add(0x9e37);
        let mixed = (mixed ^ mixed >> 13).wrapping_mul(1_274_126_177);
        0.14 * (f64::from(mixed >> 8) / f64::from(1_u32 << 24) - 0.5)
    };
    let at = |i: u32, k: u32| {
        let of = |i: u32| 3.6 * (f64::from(i) / f64::from(SIDE) - 0.5);
        DVec3::new(of(i), height(i, k), of(k))
    };
    let mut mesh = Mesh::default();
    for (i, k) in (0..SIDE).flat_map(|i| (0..SIDE).map(move |k| (i, k))) {
        let [a, b, c, d] = [at(i, k), at(i, k + 1), at(i + 1, k + 1), at(i + 1, k)];
        for triangle in [[a, b, c], [a, c, d]] {
            let [p, q, r] = triangle;
            let normal = (q - p).cross(r - p).normalize();
            mesh.indices.extend([0, 1, 2].map(|n| n + mesh.positions.len() as u32));
            mesh.positions.extend(triangle.map(|p| p.as_vec3().to_array()));
            mesh.normals.extend([normal.as_vec3().to_array(); 3]);
        }
    }
    Situation::new(light, camera).and("field", mesh, [0.0; 3])
}

/// A room of sheets with an open door, and the lamp outside before the door.
pub fn thin_room() -> Situation {
    let light = lamp([-5.0, 3.2, -0.8], [-2.0, 0.5, 0.0], 1.0);
    let camera = looking([1.2, 1.4, 0.8], [-0.8, 0.65, -0.1], 1.15);
    let along_z = |z: f64, y: f64, x: f64| {
        DMat4::from_translation(DVec3::new(x, y, z)) * DMat4::from_rotation_y(0.5 * PI)
    };
    Situation::new(light, camera)
        .and("floor", generate::ground(12.0), [0.0; 3])
        .and("back", sheet(4.0, 2.0), [0.0, 1.0, -1.5])
        .and("front", sheet(4.0, 2.0), [0.0, 1.0, 1.5])
        .with("end", sheet(3.0, 2.0), along_z(0.0, 1.0, 2.0))
        .with("beside the door", sheet(1.1, 2.0), along_z(-0.95, 1.0, -2.0))
        .with("on its other side", sheet(1.1, 2.0), along_z(0.95, 1.0, -2.0))
        .with("above it", sheet(0.8, 0.4), along_z(0.0, 1.8, -2.0))
        .and("ceiling", Mesh { double_sided: true, ..generate::quad(4.0, 3.0) }, [0.0, 2.0, 0.0])
}

/// A closed room of faces that look inwards; under its hanging lamp a box, and under that a table in umbra.
pub fn lamp_in_room() -> Situation {
    let light = lamp([0.0, 2.45, 0.0], [0.0; 3], 0.8);
    let camera = looking([1.7, 2.0, 1.7], [-0.15, 0.75, -0.3], 1.2);
    let walls = inside_out(generate::cuboid(DVec3::new(4.0, 2.6, 4.0)));
    Situation::new(light, camera)
        .and("room", walls, [0.0, 1.3, 0.0])
        .and_box("box", [-0.15, 1.8, -0.25], [0.35, 2.0, 0.25])
        .and_box("table", [-0.95, 0.675, -0.95], [-0.05, 0.725, -0.05])
}

/// A line of 1.2 m over a ball.
pub fn tube_light() -> Situation {
    let line =
        RectangleLight::line(DVec3::new(0.0, 2.4, 0.0), DVec3::X * 0.6, DVec3::NEG_Y).unwrap();
    let camera = looking([1.3, 2.1, 2.4], [0.1, 0.35, 0.28], 0.75);
    Situation::on_floor(line, camera).and("ball", generate::uv_sphere(0.3, 36, 20), [0.0, 0.6, 0.0])
}

/// Boxes that touch and overlap.
pub fn touching_boxes() -> Situation {
    let light = lamp([-1.5, 2.2, 1.0], [0.1, 0.3, 0.0], 0.5);
    let camera = looking([1.5, 1.6, 1.9], [0.1, 0.4, 0.15], 0.75);
    Situation::on_floor(light, camera)
        .and_box("a", [-0.3, 0.0, -0.3], [0.3, 0.6, 0.3])
        .and_box("b", [0.15, 0.0, 0.1], [0.65, 0.3, 0.6])
        .and_box("c", [-0.45, 0.0, -0.25], [-0.15, 0.9, 0.05])
        .and_box("d", [-0.3, 0.6, -0.3], [0.3, 0.8, 0.3])
}

/// A dome around a situation, whose faces look inwards.
#[must_use]
pub fn in_dome(situation: Situation, radius: f64) -> Situation {
    situation.and("dome", inside_out(generate::uv_sphere(radius, 40, 32)), [0.0; 3])
}

/// Houses around a situation, 400 m across, with a street's width of nothing in the middle.
#[must_use]
pub fn in_town(situation: Situation) -> Situation {
    let mut made = situation.and("streets", generate::ground(400.0), [0.0, -0.02, 0.0]);
    for (i, k) in (-8..=8).flat_map(|i: i32| (-8..=8).map(move |k: i32| (i, k))) {
        if i.abs().max(k.abs()) > 0 {
            let (x, z) = (24.0 * f64::from(i), 24.0 * f64::from(k));
            let height = 6.0 + f64::from((i * 5 + k * 11).rem_euclid(7));
            made = made.and_box("house", [x - 6.0, -0.02, z - 5.0], [x + 6.0, height, z + 5.0]);
        }
    }
    made
}
