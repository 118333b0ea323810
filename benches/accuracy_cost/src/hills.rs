//! A hilly receiver: no plane that a projected shadow could lie on.

use antumbra::scene::Mesh;
use glam::DVec3;

/// The height at a place: three waves whose lengths share no period, so that no two hills are alike.
/// From 0 to 0.6 m.
fn height(x: f64, z: f64) -> f64 {
    let waves = (1.9 * x + 0.6 * z).sin() + (2.6 * z - 1.1 * x).sin() + (3.7 * x + 2.9 * z).cos();
    0.1 * (waves + 3.0)
}

/// A square of the given side round the origin, `cells` × `cells` quads of two triangles, with the
/// normals of the surface itself.
pub fn hills(side: f64, cells: u32) -> Mesh {
    let cells = cells.max(1);
    let mut mesh = Mesh::default();
    let step = side / f64::from(cells);
    let at = |i: u32| f64::from(i) * step - 0.5 * side;
    for (row, column) in (0..=cells).flat_map(|r| (0..=cells).map(move |c| (r, c))) {
        let (x, z) = (at(column), at(row));
        // A central difference over a hundredth of a wave's length: its error is 1e-5 of the slope.
        let d = 1e-2;
        let slope =
            |dx: f64, dz: f64| (height(x + dx, z + dz) - height(x - dx, z - dz)) / (2.0 * d);
        let normal = DVec3::new(-slope(d, 0.0), 1.0, -slope(0.0, d)).normalize();
        mesh.positions.push(DVec3::new(x, height(x, z), z).as_vec3().to_array());
        mesh.normals.push(normal.as_vec3().to_array());
    }
    for (row, column) in (0..cells).flat_map(|r| (0..cells).map(move |c| (r, c))) {
        let a = row * (cells + 1) + column;
        let b = a + cells + 1;
        mesh.indices.extend([a, b, b + 1, a, b + 1, a + 1]);
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::range;

    #[test]
    fn hills_face_up_and_are_the_same_each_time() {
        let mesh = hills(8.0, 96);
        assert_eq!(mesh.positions, hills(8.0, 96).positions);
        assert_eq!(mesh.indices.len(), 96 * 96 * 6);
        let corner = |i: u32| DVec3::from_array(mesh.positions[i as usize].map(f64::from));
        for triangle in mesh.indices.chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|k| corner(triangle[k]));
            let normal = (b - a).cross(c - a);
            assert!(normal.y > 0.0);
            let vertex = DVec3::from_array(mesh.normals[triangle[0] as usize].map(f64::from));
            assert!(normal.normalize().dot(vertex) > 0.9);
        }
        let [low, high] = range(mesh.positions.iter().map(|p| f64::from(p[1]))).unwrap();
        assert!(low >= 0.0 && high <= 0.6 && high - low > 0.3, "{low} to {high}");
    }
}
