//! The vertices that the device poses, beside the same sum in 64 bits; and the boxes around them.

use super::*;
use crate::skin::{Influence, Pose, Skin, Target};
use antumbra::scene::Role;
use glam::{DMat4, DVec3};

/// A rounding of 32 bits.
const ROUNDING: f64 = 1.0 / 16_777_216.0;

/// Numbers from −1 to 1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as f64 / f64::from(1u32 << 30) - 1.0
    }

    fn three(&mut self) -> [f32; 3] {
        [0; 3].map(|_| self.next() as f32)
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::from_array([0; 3].map(|_| self.next()))
    }
}

/// Three numbers, each with the sum of its terms' sizes.
type Sum = [[f64; 2]; 3];

/// a × b, with the sizes of the terms.
fn cross(a: Sum, b: Sum) -> Sum {
    [[1, 2], [2, 0], [0, 1]].map(|[i, j]| {
        [a[i][0] * b[j][0] - a[j][0] * b[i][0], a[i][1] * b[j][1] + a[j][1] * b[i][1]]
    })
}

fn dot(a: Sum, b: Sum) -> [f64; 2] {
    [0, 1].map(|which| (0..3).map(|i| a[i][which] * b[i][which]).sum())
}

/// A vertex in 64 bits: position and normal, and how far the device's may be off in 32.
///
/// Each term of a sum is rounded once when it is a product, and once in each addition that it goes through; n roundings
/// change it by n · 2⁻²⁴ of its size, to first order. A morphed number goes through one product and `targets` sums, an
/// element of the blended matrix through `width` products and sums, and a row times a position through four. A cofactor has
/// two elements, a product and a sum; three of them times the morphed normal are four roundings more. Where the error of the
/// sum is e of its length, the unit vector is off by at most 2 e; a root and a quotient, of 3 roundings each in Vulkan, add
/// less than 8.
fn reference(skin: &Skin, pose: &Pose, rest: [[f32; 3]; 2], vertex: usize) -> [([f64; 3], f64); 2] {
    let wide = f64::from;
    let morphed = |which: usize| -> Sum {
        [0, 1, 2].map(|axis| {
            let start = wide(rest[which][axis]);
            skin.targets.iter().zip(&pose.weights).fold(
                [start, start.abs()],
                |sum, (of, weight)| {
                    let term = wide(*weight) * wide(of[vertex][which][axis]);
                    [sum[0] + term, sum[1] + term.abs()]
                },
            )
        })
    };
    let mut rows = [[[0.0; 2]; 4]; 3];
    for Influence { joint, weight } in &skin.influences[skin.width * vertex..][..skin.width] {
        for (row, of) in rows.iter_mut().zip(&pose.joints[*joint as usize]) {
            for (sum, element) in row.iter_mut().zip(of) {
                let term = wide(*weight) * wide(*element);
                *sum = [sum[0] + term, sum[1] + term.abs()];
            }
        }
    }
    let linear = rows.map(|[x, y, z, _]| [x, y, z]);
    let position = morphed(0);
    let position = [0, 1, 2].map(|row| {
        let turned = dot(linear[row], position);
        [turned[0] + rows[row][3][0], turned[1] + rows[row][3][1]]
    });
    let cofactors = [[1, 2], [2, 0], [0, 1]].map(|[i, j]| cross(linear[i], linear[j]));
    let normal = cofactors.map(|row| dot(row, morphed(1)));
    let sign = dot(linear[0], cofactors[0])[0].signum();
    let [length, size] =
        [0, 1].map(|which| normal.map(|n| n[which] * n[which]).iter().sum::<f64>().sqrt());
    let roundings = (skin.targets.len() + 1 + skin.width) as f64;
    let size_of = |sum: Sum| sum.map(|n| n[1] * n[1]).iter().sum::<f64>().sqrt();
    let off = (roundings + 4.0) * ROUNDING * size_of(position);
    let turned = roundings + skin.width as f64 + 2.0 + 4.0;
    let turned = (2.0 * turned * size / length + 8.0) * ROUNDING;
    [(position.map(|p| p[0]), off), (normal.map(|n| sign * n[0] / length), turned)]
}

/// The largest share of its bound by which a position, and a normal, is off.
fn off(model: &Model, pose: &Pose, vertices: &[[f32; 6]]) -> [f64; 2] {
    let (skin, mesh) = (&model.skinned.as_ref().unwrap().skin, &model.object.mesh);
    assert_eq!(vertices.len(), mesh.positions.len());
    let mut most = [0.0f64; 2];
    for (vertex, &[a, b, c, d, e, f]) in vertices.iter().enumerate() {
        let rest = [mesh.positions[vertex], mesh.normals[vertex]];
        let expected = reference(skin, pose, rest, vertex);
        for ((most, found), (expected, bound)) in
            most.iter_mut().zip([[a, b, c], [d, e, f]]).zip(expected)
        {
            let found = DVec3::from_array(found.map(f64::from));
            *most = most.max(found.distance(DVec3::from_array(expected)) / bound);
        }
    }
    most
}

/// Whether a box contains every vertex, and how much larger it is than the least one, in the mean over the axes.
fn around(vertices: &[[f32; 6]], [low, high]: MeshBounds) -> f64 {
    let all = |axis: usize| vertices.iter().map(move |v| v[axis]);
    let size = |axis: usize| {
        let least = all(axis).fold(f32::INFINITY, f32::min);
        let most = all(axis).fold(f32::NEG_INFINITY, f32::max);
        assert!(low[axis] <= least && most <= high[axis], "axis {axis}: {least} to {most}");
        f64::from(high[axis] - low[axis]) / f64::from(most - least)
    };
    [0, 1, 2].map(size).iter().sum::<f64>() / 3.0
}

#[test]
fn the_figure_is_posed_as_in_64_bits() {
    let mut engine = Engine::new(World::walk().unwrap(), "hard");
    let (mut most, mut larger) = ([0.0f64; 2], 0.0f64);
    for frame in (0..FRAMES).step_by(7) {
        engine.one(seconds(frame));
        let vertices = engine.vertices();
        let model = engine.models.last().unwrap();
        let pose = &model.skinned.as_ref().unwrap().pose;
        let now = off(model, pose, &vertices);
        most = [0, 1].map(|i| most[i].max(now[i]));
        larger = larger.max(around(&vertices, model.bounds));
        // A pose a thousandth of a second away is another one.
        let mut other = pose.clone();
        (model.skinned.as_ref().unwrap().skin.stands)(seconds(frame) + 1e-3, &mut other);
        assert!(off(model, &other, &vertices)[0] > 10.0, "frame {frame}: any pose will do");
    }
    println!("off by {most:.3?} of the bounds; boxes are up to {larger:.2} times the least");
    assert!(most.iter().all(|off| *off <= 1.0), "{most:?}");
    assert!(larger < 1.4, "{larger}");
    engine.finish();
}

/// Nine joints that stretch and shear, and five targets that go either way.
fn shaken(seconds: f64, pose: &mut Pose) {
    let mut random = Random(seconds.to_bits());
    for joint in 0..pose.joints.len() {
        let [x, y, z, at] = [0; 4].map(|_| random.vector());
        let [x, y, z] = [DVec3::X + 0.3 * x, DVec3::Y + 0.3 * y, DVec3::Z + 0.3 * z];
        let matrix = DMat4::from_cols(x.extend(0.0), y.extend(0.0), z.extend(0.0), at.extend(1.0));
        pose.set(joint, &matrix);
    }
    pose.weights.iter_mut().for_each(|weight| *weight = random.next() as f32);
}

/// The same in a mirror, in which normals still point out.
fn mirrored(seconds: f64, pose: &mut Pose) {
    shaken(seconds, pose);
    pose.joints.iter_mut().for_each(|rows| rows[0] = rows[0].map(|element| -element));
}

/// A mesh without shape, each of whose vertices hangs on one to `most` of nine joints.
fn shapeless(most: usize, targets: usize, stands: Stands) -> Object {
    let mut random = Random(most as u64);
    let mut mesh = Mesh::default();
    let mut hangs = Vec::new();
    for vertex in 0..500 {
        mesh.positions.push(random.three());
        mesh.normals.push(random.vector().normalize().as_vec3().to_array());
        let joint = |random: &mut Random| ((4.5 + 4.5 * random.next()) as usize).min(8);
        let count = 1 + vertex % most;
        hangs.push((0..count).map(|_| (joint(&mut random), random.next().abs() + 0.01)).collect());
    }
    mesh.indices = (0..498).collect();
    let target = |_| (0..500).map(|_| [random.three(), random.three().map(|n| 0.1 * n)]).collect();
    let targets: Vec<Target> = (0..targets).map(target).collect();
    let skin = Skin::new(&mesh, 9, &hangs, targets, stands).unwrap();
    assert_eq!(skin.width, if most > 4 { 8 } else { 4 });
    let mut object = World::walk().unwrap().objects.pop().unwrap();
    (object.mesh, object.skin, object.role) = (mesh, Some(skin), Role::Both);
    object
}

#[test]
fn eight_influences_five_targets_and_mirrors_are_posed_as_in_64_bits() {
    for (most, targets, stands) in [
        (8, 5, shaken as Stands),
        (8, 5, mirrored),
        (4, 1, shaken),
        (4, 0, mirrored),
        (1, 4, shaken),
    ] {
        let mut world = World::walk().unwrap();
        world.objects = vec![shapeless(most, targets, stands)];
        let mut engine = Engine::new(world, "hard");
        for seconds in [0.0, 1.0, 2.0] {
            engine.one(seconds);
            let vertices = engine.vertices();
            let model = engine.models.last().unwrap();
            let off = off(model, &model.skinned.as_ref().unwrap().pose, &vertices);
            let larger = around(&vertices, model.bounds);
            println!(
                "{most} joints, {targets} targets: {off:.3?} of the bounds, {larger:.2} times the box"
            );
            assert!(off.iter().all(|off| *off <= 1.0), "{off:?}");
        }
        engine.finish();
    }
}

/// The box holds the mesh in poses far from those of a walk too, here without a device.
#[test]
fn a_box_holds_what_any_pose_moves() {
    let object = shapeless(8, 5, shaken);
    let (mesh, skin) = (&object.mesh, object.skin.as_ref().unwrap());
    let mut pose = skin.rest();
    for seconds in 0..200 {
        shaken(f64::from(seconds), &mut pose);
        // Further away, where roundings are larger than the mesh's own.
        pose.joints.iter_mut().flatten().for_each(|row| row[3] += 1000.0);
        let vertices: Vec<[f32; 6]> = (0..mesh.positions.len())
            .map(|vertex| {
                let rest = [mesh.positions[vertex], mesh.normals[vertex]];
                let [([x, y, z], _), _] = reference(skin, &pose, rest, vertex);
                [x as f32, y as f32, z as f32, 0.0, 0.0, 0.0]
            })
            .collect();
        around(&vertices, skin.bounds(&pose));
    }
}

#[test]
fn skins_that_do_not_fit_are_refused() {
    let mesh = Mesh { positions: vec![[0.0; 3]; 2], normals: vec![[0.0; 3]; 2], ..Mesh::default() };
    let refused = |of: &[(usize, f64)], targets: Vec<Target>, words: &[&str]| {
        let made = Skin::new(&mesh, 2, &[vec![(0, 1.0)], of.to_vec()], targets, shaken);
        let sentence = made.err().unwrap().to_string();
        assert!(words.iter().all(|word| sentence.contains(word)), "{sentence}");
    };
    refused(&[(2, 1.0)], Vec::new(), &["vertex 1", "2 joints"]);
    refused(&[(0, 1.0), (1, -0.5)], Vec::new(), &["vertex 1", "0 or more"]);
    refused(&[(0, 0.0)], Vec::new(), &["vertex 1", "not all 0"]);
    refused(&[(0, f64::NAN)], Vec::new(), &["vertex 1"]);
    refused(&[], Vec::new(), &["vertex 1"]);
    refused(&[(0, 0.1); 9], Vec::new(), &["vertex 1", "up to 8"]);
    refused(&[(0, 1.0)], vec![vec![[[0.0; 3]; 2]; 3]], &["target 0", "3 of 2 vertices"]);
    let few = Skin::new(&mesh, 2, &[vec![(0, 1.0)]], Vec::new(), shaken);
    assert!(few.err().unwrap().to_string().contains("1 of 2 vertices"));
}
