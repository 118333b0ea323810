//! The hierarchy finds what each triangle by itself finds; what is visible is tested in `tests/scenes/truth`.
#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

use super::*;
use crate::scene::{Mesh, Role};
use crate::truth::random::Random;
use glam::DMat4;

#[test]
fn the_tree_loses_no_triangle() {
    let mut random = Random(5);
    // Triangles of all shapes, needles and axis-aligned flat ones included, and a pile of copies.
    let mut scene = Scene::default();
    let mut add = |mesh: &Mesh, at: DVec3| {
        scene.add("quad", mesh.clone(), DMat4::from_translation(at), Role::Both);
    };
    let mut copy = None;
    for i in 0..300 {
        let at = random.vector(1.0);
        let [mut u, v] = [(); 2].map(|()| random.vector(0.3));
        u *= if i % 3 == 0 { 1e-3 } else { 1.0 };
        let flat = DVec3::from_array([0, 1, 2].map(|k| f64::from(u8::from(i % 5 != k))));
        let positions = [DVec3::ZERO, u, u + v, v].map(|p| (p * flat).as_vec3().to_array());
        let indices = vec![0, 1, 2, 0, 2, 3];
        let mesh = Mesh { positions: positions.into(), indices, ..Mesh::default() };
        add(&mesh, at);
        copy.get_or_insert((mesh, at));
    }
    if let Some((mesh, at)) = copy {
        (0..500).for_each(|_| add(&mesh, at));
    }
    let tracer = Tracer::new(&scene).unwrap();
    let mut hits = 0;
    for i in 0..8000 {
        let from = random.vector(1.5);
        let mut along = random.vector(1.5) - from;
        if i % 4 == 0 {
            along *= [DVec3::X, DVec3::Y, DVec3::Z][i / 4 % 3];
        }
        if i % 2 == 1 {
            // Just inside a corner, where a box in f32 would cut it off without its padding.
            let Triangle { corner, edges, .. } = tracer.blockers.triangles[i % 600];
            along = (corner + (edges[0] + edges[1]) * 1e-8 - from) * 1.5;
        }
        let expected = tracer.blockers.triangles.iter().any(|t| t.crosses(from, along).is_some());
        let passes = if expected { 0.0 } else { 1.0 };
        assert_eq!(tracer.passes(from, along, &mut None), passes, "{from} along {along}");
        hits += usize::from(expected);
    }
    assert!((2000..7000).contains(&hits), "{hits} hits do not test both answers");
}
