//! A closed shape of as many triangles as one likes, which looks the same with any number of them.

use antumbra::scene::Mesh;
use glam::DVec3;

/// The waves of the surface: a direction times waves a radius, and the height as a share of the radius.
const WAVES: [(DVec3, f64); 6] = [
    (DVec3::new(3.1, 1.7, -2.3), 0.10),
    (DVec3::new(-2.2, 3.9, 1.4), 0.08),
    (DVec3::new(5.3, -4.1, 6.2), 0.04),
    (DVec3::new(-7.7, 6.4, 5.9), 0.03),
    (DVec3::new(13.0, 11.3, -9.8), 0.012),
    (DVec3::new(-17.4, 15.1, 19.6), 0.008),
];

/// The number of cells along a side of each of six faces that comes nearest to a number of triangles.
pub fn cells_of(triangles: u32) -> u32 {
    (f64::from(triangles) / 12.0).sqrt().round().max(1.0) as u32
}

/// A bumpy ball about 1 m across: a cube's six faces of `cells` × `cells` quads, 12 · cells² triangles of much the same
/// size, blown up to a sphere with smooth noise on it. The shape does not depend on `cells`.
pub fn bumpy_ball(cells: u32) -> Mesh {
    let cells = cells.max(1);
    let mut mesh = Mesh::default();
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    for face in 0..6 {
        let (axis, sign) = (face % 3, if face < 3 { 1.0 } else { -1.0 });
        let (out, u) = (axes[axis] * sign, axes[(axis + 1) % 3]);
        add_face(&mut mesh, cells, [out, u, out.cross(u)]);
    }
    mesh
}

fn add_face(mesh: &mut Mesh, cells: u32, [out, u, v]: [DVec3; 3]) {
    let first = mesh.positions.len() as u32;
    // Angles in equal steps make cells of much the same size.
    let across =
        |i: u32| (std::f64::consts::FRAC_PI_2 * (f64::from(i) / f64::from(cells) - 0.5)).tan();
    for (row, column) in (0..=cells).flat_map(|r| (0..=cells).map(move |c| (r, c))) {
        let direction = (out + u * across(column) + v * across(row)).normalize();
        let bumps: f64 = WAVES.iter().map(|(k, height)| height * k.dot(direction).sin()).sum();
        mesh.positions.push((direction * 0.4 * (1.0 + bumps)).as_vec3().to_array());
        mesh.normals.push(direction.as_vec3().to_array());
    }
    for (row, column) in (0..cells).flat_map(|r| (0..cells).map(move |c| (r, c))) {
        let a = first + row * (cells + 1) + column;
        let b = a + cells + 1;
        mesh.indices.extend([a, a + 1, b + 1, a, b + 1, b]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn balls_are_closed_and_face_outwards() {
        for cells in [1, 9] {
            let mesh = bumpy_ball(cells);
            assert_eq!(mesh.indices.len() as u32, 36 * cells * cells);
            let corner = |i: u32| DVec3::from_array(mesh.positions[i as usize].map(f64::from));
            let mut volume = 0.0;
            let mut sum = DVec3::ZERO;
            for t in mesh.indices.chunks_exact(3) {
                let [a, b, c] = [corner(t[0]), corner(t[1]), corner(t[2])];
                let area = (b - a).cross(c - a);
                assert!(area.dot(a + b + c) > 0.0, "{cells}");
                volume += a.dot(b.cross(c)) / 6.0;
                sum += area;
            }
            // The area vectors of a closed surface cancel.
            assert!(sum.length() < 1e-6 && volume > 0.05, "{sum}, {volume}");
        }
    }

    #[test]
    fn counts_of_triangles_are_met() {
        for wanted in [1_000, 64_000, 871_000] {
            let cells = cells_of(wanted);
            let off = f64::from(12 * cells * cells) / f64::from(wanted) - 1.0;
            assert!(off.abs() < 0.06, "{wanted}: {off}");
        }
    }
}
