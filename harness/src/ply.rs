//! Scanned models, as the Stanford repository has them.

use antumbra::scene::Mesh;
use glam::DVec3;
use std::path::Path;

/// An ASCII PLY of triangles: positions first on each vertex line, faces as `3 a b c`. A vertex's normal
/// is the mean of those of its faces, by their areas. Nothing where there is no such file or it is
/// something else.
pub fn ply(path: &Path) -> Option<Mesh> {
    let text = std::fs::read_to_string(path).ok()?;
    let count = |element: &str| -> Option<usize> {
        let line = text.lines().find(|l| l.starts_with(&format!("element {element} ")))?;
        line.rsplit(' ').next()?.trim().parse().ok()
    };
    let (vertices, faces) = (count("vertex")?, count("face")?);
    let mut lines = text.lines().skip_while(|l| l.trim() != "end_header").skip(1);
    let mut mesh = Mesh::default();
    for _ in 0..vertices {
        let mut numbers = lines.next()?.split_whitespace().map(str::parse::<f32>);
        let mut next = || numbers.next()?.ok();
        mesh.positions.push([next()?, next()?, next()?]);
    }
    for _ in 0..faces {
        let mut numbers = lines.next()?.split_whitespace().map(str::parse::<u32>);
        let mut next = || numbers.next()?.ok();
        if next()? != 3 {
            return None;
        }
        mesh.indices.extend([next()?, next()?, next()?]);
    }
    mesh.normals = normals(&mesh)?;
    Some(mesh)
}

fn normals(mesh: &Mesh) -> Option<Vec<[f32; 3]>> {
    let mut sums = vec![DVec3::ZERO; mesh.positions.len()];
    for face in mesh.indices.chunks_exact(3) {
        let corner = |i: usize| {
            let position = mesh.positions.get(face[i] as usize)?;
            Some(DVec3::from_array(position.map(f64::from)))
        };
        let [a, b, c] = [corner(0)?, corner(1)?, corner(2)?];
        let normal = (b - a).cross(c - a);
        face.iter().for_each(|&i| sums[i as usize] += normal);
    }
    Some(sums.iter().map(|n| n.normalize_or(DVec3::Y).as_vec3().to_array()).collect())
}
