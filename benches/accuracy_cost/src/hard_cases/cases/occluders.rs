//! Hard by what blocks.

use super::{ASIDE, CARD, HardCase, LIGHT, Limit, Noise, TWO_LINES, base, card, moved, sheet};
use crate::hard_cases::set::{Block, Set, Shape, tiled};
use antumbra::scene::{Mesh, Role, generate};
use glam::{DMat4, DVec3};

fn of(name: impl Into<String>, blocks: Vec<Block>) -> HardCase {
    HardCase::new(Limit::Occluder, name, Set { blocks, ..base() })
}

pub(super) fn all() -> Vec<HardCase> {
    [places(), sizes(), triangles()].concat()
}

/// Touching the receiver and the light.
fn places() -> Vec<HardCase> {
    let above = |height: f64| of(format!("{height:e} m above the receiver"), vec![card(height)]);
    let mut all: Vec<_> = [1e-1, 1e-2, 1e-3, 1e-4].map(above).into();
    all.push(of("in the receiver's plane", vec![card(0.0)]));
    let turned = DMat4::from_rotation_y(0.3);
    let standing = Block {
        shape: Shape::Box(DVec3::splat(0.5)),
        at: moved(0.0371, 0.25, -0.0193) * turned,
        role: Role::Occluder,
    };
    all.push(of("a box that stands on the receiver", vec![standing]));
    // Half of the light is covered.
    let below = |gap: f64| {
        let half = sheet([0.5; 2], moved(0.25, LIGHT - gap, 0.0));
        of(format!("over half the light, {gap:e} m before it"), vec![half])
    };
    all.push(below(1e-1));
    let centred = ["soft-shadow-map", "soft-shadow-map, blended", "back-projection"];
    all.extend([1e-2, 1e-3].map(|gap| below(gap).known_for(&centred, ASIDE)));
    all
}

fn sizes() -> Vec<HardCase> {
    let at = || card(CARD).at;
    vec![
        of("thinner than a texel", vec![sheet([1.0, 1e-3], at())]),
        of(
            "thinner than a texel, another beneath",
            vec![sheet([1.0, 1e-3], at()), sheet([0.3; 2], moved(0.0, 1.0, 0.0))],
        ),
        of(
            "smaller than a texel, another beside",
            vec![sheet([1e-3; 2], at()), sheet([0.3; 2], moved(0.9, CARD, 0.9))],
        ),
        of("fills the frustum", vec![sheet([100.0; 2], at())]),
    ]
}

/// Where each map draws all triangles.
const FEW_POINTS: Noise = Noise {
    technique: "many-lights",
    words: "technique=many-lights samples=16",
    worst: 14.0 / 16.0,
    mean: 0.054,
    why: "half a texel's diagonal; 16 points, of which each of two edges meets 7 cells: 14/16, in the mean 0.054",
};

fn triangles() -> Vec<HardCase> {
    let like = |name, mesh, shape: Option<Shape>| {
        let shape = shape.map(Box::new);
        of(name, vec![Block { shape: Shape::Like(mesh, shape), ..card(CARD) }])
    };
    let square = || Some(Shape::Card([1.0; 2]));
    let slab = DVec3::new(1.0, 0.1, 1.0);
    let one_sided = Mesh { double_sided: false, ..generate::quad(1.0, 1.0) };
    let million = || Mesh { double_sided: true, ..tiled([1.0; 2], 708) };
    let many = HardCase {
        noise: vec![FEW_POINTS, TWO_LINES],
        ..like("a million triangles", million(), square())
    };
    vec![
        like("no triangles", Mesh::default(), None),
        many,
        like("triangles of no area", degenerate(), square()),
        of("each triangle twice", vec![card(CARD), card(CARD)]),
        like("a card seen from behind", turned(one_sided), square()),
        like("a slab inside out", turned(generate::cuboid(slab)), Some(Shape::Box(slab))),
    ]
}

/// A mesh with its triangles turned the other way round.
fn turned(mut mesh: Mesh) -> Mesh {
    mesh.indices.chunks_exact_mut(3).for_each(|triangle| triangle.swap(1, 2));
    mesh
}

/// A card with triangles of no area: three equal corners, two, and three in a line.
fn degenerate() -> Mesh {
    let mut mesh = Mesh { double_sided: true, ..generate::quad(1.0, 1.0) };
    mesh.positions.extend([[0.0, 0.0, 0.0], [0.25, 0.0, 0.25], [-0.25, 0.0, -0.25]]);
    mesh.normals.extend([[0.0, 1.0, 0.0]; 3]);
    mesh.indices.extend([4, 4, 4, 0, 0, 2, 1, 3, 3, 4, 5, 6]);
    mesh
}
