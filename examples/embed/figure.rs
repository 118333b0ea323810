//! A figure that walks: limbs on thirteen joints, a chest that breathes, and a walk without end.

use crate::Outcome;
use crate::skin::{Pose, Skin, Target};
use antumbra::scene::Mesh;
use glam::{DMat4, DVec3};
use std::f64::consts::{PI, TAU};

const HIPS: usize = 0;
const CHEST: usize = 1;
const HEAD: usize = 2;
// The left side's joints: that of the right side is the next of each.
const ARM: usize = 3;
const FOREARM: usize = 5;
const THIGH: usize = 7;
const SHIN: usize = 9;
const FOOT: usize = 11;

/// The joint that each joint hangs on, and where it is at rest, in metres: y is up, the figure looks along z and its left
/// is x.
const SKELETON: [(usize, [f64; 3]); 13] = [
    (HIPS, [0.0, 0.95, 0.0]),
    (HIPS, [0.0, 1.12, 0.0]),
    (CHEST, [0.0, 1.5, 0.0]),
    (CHEST, [0.21, 1.41, 0.0]),
    (CHEST, [-0.21, 1.41, 0.0]),
    (ARM, [0.21, 1.13, 0.0]),
    (ARM + 1, [-0.21, 1.13, 0.0]),
    (HIPS, [0.1, 0.89, 0.0]),
    (HIPS, [-0.1, 0.89, 0.0]),
    (THIGH, [0.1, 0.49, 0.0]),
    (THIGH + 1, [-0.1, 0.49, 0.0]),
    (SHIN, [0.1, 0.09, 0.0]),
    (SHIN + 1, [-0.1, 0.09, 0.0]),
];

/// The radius of a foot, and the two ends of the left one at rest.
const SOLE: f64 = 0.045;
const FOOT_ENDS: [[f64; 3]; 2] = [[0.1, SOLE, -0.05], [0.1, SOLE, 0.14]];

/// The walk's cycles of two steps each, and its metres, a second.
const CYCLES: f64 = 0.55;
const SPEED: f64 = 0.8;

/// Vertices around a limb, and rings over each of its round ends.
const AROUND: u32 = 20;
const CAP: u32 = 5;

/// The figure's mesh at rest, and the skin by which it walks.
pub fn walking() -> Outcome<(Mesh, Skin)> {
    let mut body = Body::default();
    let torso = |p: DVec3| {
        // The thighs pull a little at the pelvis.
        let (pulled, left) = (0.35 * (1.0 - step(p.y, 0.93, 0.08)), step(p.x, 0.0, 0.1));
        let mut hangs = chain(p.y, &[HIPS, CHEST], &[(1.1, 0.12)]);
        hangs.iter_mut().for_each(|(_, weight)| *weight *= 1.0 - pulled);
        hangs.extend([(THIGH, pulled * left), (THIGH + 1, pulled * (1.0 - left))]);
        hangs
    };
    body.limb([[0.0, 0.97, 0.0], [0.0, 1.33, 0.0]], [0.15, 0.17], 0.62, torso);
    let chest = body.mesh.positions.len();
    let neck = |p: DVec3| chain(p.y, &[CHEST, HEAD], &[(1.5, 0.05)]);
    body.limb([[0.0, 1.42, 0.0], [0.0, 1.58, 0.0]], [0.055; 2], 1.0, neck);
    body.limb([[0.0, 1.62, 0.01], [0.0, 1.68, 0.01]], [0.085, 0.095], 1.1, |_| vec![(HEAD, 1.0)]);
    for (side, sign) in [(0, 1.0), (1, -1.0)] {
        let ends = |ends: [[f64; 3]; 2]| ends.map(|[x, y, z]| [sign * x, y, z]);
        let arm = [FOREARM + side, ARM + side, CHEST];
        let arm = |p: DVec3| chain(p.y, &arm, &[(1.13, 0.06), (1.41, 0.07)]);
        body.limb(ends([[0.21, 0.8, 0.0], [0.21, 1.4, 0.0]]), [0.035, 0.055], 1.0, arm);
        let leg = [FOOT + side, SHIN + side, THIGH + side, HIPS];
        let leg = |p: DVec3| chain(p.y, &leg, &[(0.09, 0.04), (0.49, 0.08), (0.89, 0.08)]);
        body.limb(ends([[0.1, 0.09, 0.0], [0.1, 0.88, 0.0]]), [0.05, 0.09], 1.0, leg);
        body.limb(ends(FOOT_ENDS), [SOLE; 2], 1.0, |_| vec![(FOOT + side, 1.0)]);
    }
    let Body { mut mesh, hangs } = body;
    mesh.normals = normals(&mesh.positions, &mesh.indices);
    let breath = breath(&mesh, chest);
    let skin = Skin::new(&mesh, SKELETON.len(), &hangs, vec![breath], walk)?;
    Ok((mesh, skin))
}

/// The walk at a number of seconds: it begins at the origin and goes along z, with a foot on the ground.
fn walk(seconds: f64, pose: &mut Pose) {
    let (sin, cos) = (TAU * CYCLES * seconds).sin_cos();
    let mut turns = [DMat4::IDENTITY; SKELETON.len()];
    let about_x = DMat4::from_rotation_x; // above 0: what hangs down goes back
    turns[HIPS] = DMat4::from_rotation_z(0.04 * cos) * DMat4::from_rotation_y(-0.1 * sin);
    turns[CHEST] = DMat4::from_rotation_y(0.22 * sin) * about_x(0.05);
    turns[HEAD] = DMat4::from_rotation_y(-0.1 * sin);
    for (side, sign) in [(0, 1.0), (1, -1.0)] {
        let (forward, going_forward) = (sign * sin, (sign * cos).max(0.0));
        let (thigh, shin) = (-0.1 - 0.4 * forward, 0.15 + 0.8 * going_forward * going_forward);
        turns[THIGH + side] = about_x(thigh);
        turns[SHIN + side] = about_x(shin);
        turns[FOOT + side] = about_x(-0.6 * (thigh + shin));
        turns[ARM + side] = DMat4::from_rotation_z(sign * 0.08) * about_x(0.45 * forward);
        turns[FOREARM + side] = about_x(-0.35 - 0.2 * forward);
    }
    let mut joints = [DMat4::IDENTITY; SKELETON.len()];
    for (joint, &(parent, at)) in SKELETON.iter().enumerate() {
        // The joints' matrices take the mesh at rest along: each turns about where its joint is at rest.
        let at = DVec3::from_array(at);
        let turn = DMat4::from_translation(at) * turns[joint] * DMat4::from_translation(-at);
        joints[joint] = if joint == HIPS { turn } else { joints[parent] * turn };
    }
    let bottom = |side: usize, end: [f64; 3]| {
        let [x, y, z] = end;
        let end = DVec3::new(if side == 0 { x } else { -x }, y, z);
        joints[FOOT + side].transform_point3(end).y - SOLE
    };
    let feet = [0, 1].map(|side| bottom(side, FOOT_ENDS[0]).min(bottom(side, FOOT_ENDS[1])));
    let place = DMat4::from_translation(DVec3::new(0.0, -feet[0].min(feet[1]), SPEED * seconds));
    for (joint, matrix) in joints.iter().enumerate() {
        pose.set(joint, &(place * *matrix));
    }
    pose.weights[0] = (0.5 + 0.5 * (TAU * 0.4 * seconds).sin()) as f32;
}

/// Limbs in one mesh, and what each vertex hangs on.
#[derive(Default)]
struct Body {
    mesh: Mesh,
    hangs: Vec<Vec<(usize, f64)>>,
}

impl Body {
    /// A closed limb between two points that differ in y or z alone, with round ends, of a radius at each; across x it is
    /// `depth` times as deep as wide.
    fn limb(
        &mut self,
        ends: [[f64; 3]; 2],
        radii: [f64; 2],
        depth: f64,
        hangs: impl Fn(DVec3) -> Vec<(usize, f64)>,
    ) {
        let [low, high] = ends.map(DVec3::from_array);
        let (axis, length) = ((high - low).normalize(), low.distance(high));
        let deep = DVec3::X.cross(axis);
        let along = (length / 0.02).ceil() as u32;
        // Where each ring is along the axis, and its radius, from the high end to the low one.
        let round = |i: u32| (0.5 * PI * f64::from(i) / f64::from(CAP)).sin_cos();
        let upper = (0..CAP).map(round).map(|(sin, cos)| (length + radii[1] * cos, radii[1] * sin));
        let middle = (0..=along).map(|i| f64::from(i) / f64::from(along));
        let middle = middle.map(|t| (length * (1.0 - t), radii[1] + t * (radii[0] - radii[1])));
        let lower = (1..=CAP).map(round).map(|(sin, cos)| (-radii[0] * sin, radii[0] * cos));
        let rings: Vec<_> = upper.chain(middle).chain(lower).collect();
        let start = self.mesh.positions.len() as u32;
        let last = rings.len() - 1;
        for (ring, (at, radius)) in rings.into_iter().enumerate() {
            // Each pole is one vertex.
            let around = if ring == 0 || ring == last { 1 } else { AROUND };
            for i in 0..around {
                let (sin, cos) = (TAU * f64::from(i) / f64::from(AROUND)).sin_cos();
                let radius = if around == 1 { 0.0 } else { radius };
                let side = radius * (cos * DVec3::X + depth * sin * deep);
                let position = low + at * axis + side;
                self.mesh.positions.push(position.as_vec3().to_array());
                self.hangs.push(hangs(position));
            }
        }
        // A vertex of the ring behind another; the first pole is vertex 0, the last one ends the list.
        let vertex = |ring: u32, i: u32| start + 1 + (ring - 1) * AROUND + i % AROUND;
        let (rings, end) = (last as u32 - 1, self.mesh.positions.len() as u32 - 1);
        for i in 0..AROUND {
            self.mesh.indices.extend([start, vertex(1, i + 1), vertex(1, i)]);
            for ring in 1..rings {
                let [a, b] = [i, i + 1].map(|i| [vertex(ring, i), vertex(ring + 1, i)]);
                self.mesh.indices.extend([a[0], b[0], b[1], a[0], b[1], a[1]]);
            }
            self.mesh.indices.extend([vertex(rings, i), vertex(rings, i + 1), end]);
        }
    }
}

/// From 0 below to 1 above a height, smoothly over `half` to each side.
fn step(y: f64, height: f64, half: f64) -> f64 {
    let t = ((y - height) / (2.0 * half) + 0.5).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// What hangs at a height on joints one above the other, each passing on to the next around a height: the weights are
/// products of shares, 0 or more, and add up to 1.
fn chain(y: f64, joints: &[usize], bends: &[(f64, f64)]) -> Vec<(usize, f64)> {
    let mut left = 1.0;
    let mut hangs = Vec::with_capacity(joints.len() + 2);
    for (nth, &joint) in joints.iter().enumerate() {
        let above = bends.get(nth).map_or(0.0, |&(height, half)| step(y, height, half));
        hangs.push((joint, left * (1.0 - above)));
        left *= above;
    }
    hangs
}

/// The chest drawn out to the front, by up to 4 cm, at the first `chest` vertices.
fn breath(mesh: &Mesh, chest: usize) -> Target {
    let vertices = || mesh.positions.iter().zip(&mesh.normals).enumerate();
    let wide = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
    let moved: Vec<[f32; 3]> = vertices()
        .map(|(vertex, (&p, &n))| {
            let front = if vertex < chest { f64::from(n[2]).max(0.0) } else { 0.0 };
            let height = (f64::from(p[1]) - 1.27) / 0.11;
            let out = wide(n) * (0.04 * front * (-height * height).exp());
            (wide(p) + out).as_vec3().to_array()
        })
        .collect();
    let turned = normals(&moved, &mesh.indices);
    let minus = |a: [f32; 3], b: [f32; 3]| [0, 1, 2].map(|i| a[i] - b[i]);
    vertices().map(|(i, (&p, &n))| [minus(moved[i], p), minus(turned[i], n)]).collect()
}

/// The mean of the normals of the triangles around each vertex, by their areas.
fn normals(positions: &[[f32; 3]], indices: &[u32]) -> Vec<[f32; 3]> {
    let mut sums = vec![DVec3::ZERO; positions.len()];
    for corners in indices.chunks(3) {
        let corner = |i: usize| DVec3::from_array(positions[corners[i] as usize].map(f64::from));
        let across = (corner(1) - corner(0)).cross(corner(2) - corner(0));
        corners.iter().for_each(|&corner| sums[corner as usize] += across);
    }
    sums.into_iter().map(|sum| sum.normalize_or_zero().as_vec3().to_array()).collect()
}
