//! Scenes whose meshes textures cut out, each beside one of the same shapes as triangles.

use crate::rig::Random;
use crate::situations::{Situation, lamp, looking, sheet};
use antumbra::scene::{Mesh, OpacityMap, Role, Wrap, generate};
use glam::{DMat3, DMat4, DVec3};
use std::f64::consts::TAU;

/// How a scene's shapes are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Made {
    /// Of an opacity texture on quads.
    Textured,
    /// Of triangles.
    Cut,
    /// Of the quads alone.
    Whole,
}

/// The texels of a picket fence's texture, width and height.
const FENCE: [u32; 2] = [128, 48];

/// Whether a texel of the fence is wood: sixteen pickets, two rails.
fn is_wood(x: u32, y: u32) -> bool {
    x % 8 < 5 || matches!(y, 8..12 | 34..38)
}

fn fence_map() -> OpacityMap {
    let [width, height] = FENCE;
    let texels = (0..width * height).map(|i| 255 * u8::from(is_wood(i % width, i / width)));
    OpacityMap {
        size: FENCE,
        texels: texels.collect(),
        wrap: [Wrap::Clamp; 2],
        linear: false,
        cutoff: Some(0.5),
    }
}

/// Gives a mesh a texture on each of its vertices' x and y, which lie around 0.
fn textured(mut mesh: Mesh, [width, height]: [f64; 2]) -> Mesh {
    mesh.texture_coordinates = mesh
        .positions
        .iter()
        .map(|p| [p[0] / width as f32 + 0.5, 0.5 - p[1] / height as f32])
        .collect();
    Mesh { cut_out: true, opacity_map: Some(0), ..mesh }
}

/// A picket fence that stands on a floor, 3.2 m long and 1.2 m high, before a lamp.
pub fn picket_fence(made: Made) -> Situation {
    const SIZE: [f64; 2] = [3.2, 1.2];
    let light = lamp([0.5, 2.4, -1.8], [0.1, 0.3, 0.0], 0.4);
    let camera = looking([1.7, 2.1, 3.0], [0.1, 0.3, 0.6], 0.75);
    let scene = Situation::on_floor(light, camera);
    let whole = sheet(SIZE[0], SIZE[1]);
    let at = [0.0, 0.5 * SIZE[1], 0.0];
    match made {
        Made::Whole => scene.and("fence", whole, at),
        Made::Textured => {
            let mut scene = scene.and("fence", textured(whole, SIZE), at);
            scene.scene.opacity_maps.push(fence_map());
            scene
        }
        Made::Cut => {
            let texel = [0, 1].map(|i| SIZE[i] / f64::from(FENCE[i]));
            let mut fence = Mesh { double_sided: true, ..Mesh::default() };
            let mut add = |from: [u32; 2], to: [u32; 2]| {
                let part = sheet(
                    texel[0] * f64::from(to[0] - from[0]),
                    texel[1] * f64::from(to[1] - from[1]),
                );
                let middle =
                    [0, 1].map(|i| texel[i] * 0.5 * f64::from(from[i] + to[i]) - 0.5 * SIZE[i]);
                let first = fence.positions.len() as u32;
                let moved = |p: &[f32; 3]| [p[0] + middle[0] as f32, p[1] - middle[1] as f32, p[2]];
                fence.positions.extend(part.positions.iter().map(moved));
                fence.normals.extend(&part.normals);
                fence.indices.extend(part.indices.iter().map(|i| i + first));
            };
            (0..FENCE[0] / 8).for_each(|nth| add([8 * nth, 0], [8 * nth + 5, FENCE[1]]));
            for nth in 0..FENCE[0] / 8 {
                // What is a picket already is no rail once more.
                add([8 * nth + 5, 8], [8 * nth + 8, 12]);
                add([8 * nth + 5, 34], [8 * nth + 8, 38]);
            }
            scene.and("fence", fence, at)
        }
    }
}

/// Texels along a leaf's texture.
const LEAF: u32 = 64;
/// The half-axes of the ellipse that a leaf is, as shares of its texture.
const ELLIPSE: [f64; 2] = [0.24, 0.47];

fn leaf_map() -> OpacityMap {
    let texel = |i: u32| {
        let at = |i: u32| (f64::from(i) + 0.5) / f64::from(LEAF) - 0.5;
        let [x, y] = [at(i % LEAF) / ELLIPSE[0], at(i / LEAF) / ELLIPSE[1]];
        // A ramp of two texels with a half at the ellipse.
        let inside = (1.0 - x.hypot(y)) * 0.3 * f64::from(LEAF);
        (255.0 * (0.5 + 0.5 * inside).clamp(0.0, 1.0)).round() as u8
    };
    OpacityMap {
        size: [LEAF; 2],
        texels: (0..LEAF * LEAF).map(texel).collect(),
        wrap: [Wrap::Clamp; 2],
        linear: true,
        cutoff: Some(0.5),
    }
}

/// A tree of 300 leaves of 20 cm on a floor, before a lamp.
pub fn tree(made: Made) -> Situation {
    const SIDE: f64 = 0.2;
    let light = lamp([-1.6, 3.4, 0.9], [0.0, 0.6, 0.0], 0.5);
    let camera = looking([2.1, 2.6, 3.0], [0.3, 0.5, 0.0], 0.75);
    let leaf = match made {
        Made::Whole => sheet(SIDE, SIDE),
        Made::Textured => textured(sheet(SIDE, SIDE), [SIDE; 2]),
        Made::Cut => {
            let corner = |i: u32| {
                let (sin, cos) = (TAU * f64::from(i) / 24.0).sin_cos();
                [ELLIPSE[0] * SIDE * cos, ELLIPSE[1] * SIDE * sin, 0.0].map(|x| x as f32)
            };
            Mesh {
                positions: (0..24).map(corner).collect(),
                normals: vec![[0.0, 0.0, 1.0]; 24],
                indices: (1..23).flat_map(|i| [0, i, i + 1]).collect(),
                double_sided: true,
                ..Mesh::default()
            }
        }
    };
    let mut random = Random(11);
    let mut crown = Mesh { positions: vec![], normals: vec![], indices: vec![], ..leaf.clone() };
    crown.texture_coordinates.clear();
    for _ in 0..300 {
        let mut vector = || DVec3::from_array([(); 3].map(|()| 2.0 * random.unit() - 1.0));
        let (towards, z, x) = (vector(), vector(), vector());
        let z = z.normalize_or(DVec3::Z);
        let x = x.reject_from(z).normalize_or(z.any_orthonormal_vector());
        let middle = towards.normalize_or(DVec3::Y) * 0.55 * (0.3 + 0.7 * random.unit()).cbrt();
        let turn =
            DMat4::from_translation(middle) * DMat4::from_mat3(DMat3::from_cols(x, z.cross(x), z));
        let first = crown.positions.len() as u32;
        let point = |p: &[f32; 3]| {
            turn.transform_point3(DVec3::from_array(p.map(f64::from))).as_vec3().to_array()
        };
        let vector = |n: &[f32; 3]| {
            turn.transform_vector3(DVec3::from_array(n.map(f64::from))).as_vec3().to_array()
        };
        crown.positions.extend(leaf.positions.iter().map(point));
        crown.normals.extend(leaf.normals.iter().map(vector));
        crown.texture_coordinates.extend(&leaf.texture_coordinates);
        crown.indices.extend(leaf.indices.iter().map(|i| i + first));
    }
    let mut scene = Situation::on_floor(light, camera)
        .and_box("trunk", [-0.04, 0.0, -0.04], [0.04, 0.7, 0.04])
        .and("crown", crown, [0.0, 1.0, 0.0]);
    if made == Made::Textured {
        scene.scene.opacity_maps.push(leaf_map());
    }
    scene
}

/// Panes that stand behind each other over a floor, of these opacities, and a box before them.
pub fn panes(opacities: &[u8]) -> Situation {
    let light = lamp([0.4, 2.4, -1.9], [0.0, 0.2, 0.0], 0.4);
    let camera = looking([1.6, 2.1, 2.8], [0.0, 0.3, 0.6], 0.75);
    let mut scene = Situation::on_floor(light, camera);
    for (nth, &opacity) in opacities.iter().enumerate() {
        let pane = textured(sheet(1.4, 1.0), [1.4, 1.0]);
        let pane = Mesh { opacity_map: Some(nth), ..pane };
        scene = scene.and("pane", pane, [0.15 * nth as f64, 0.52, 0.1 * nth as f64]);
        // A pixel of a pane shows what is behind it.
        scene.scene.instances.last_mut().unwrap().role = Role::Occluder;
        scene.scene.opacity_maps.push(OpacityMap {
            size: [1, 1],
            texels: vec![opacity],
            ..OpacityMap::default()
        });
    }
    scene.and("box", generate::cuboid(DVec3::splat(0.3)), [-0.9, 0.15, 0.3])
}
