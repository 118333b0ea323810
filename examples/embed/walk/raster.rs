//! What each pixel shows, worked out on the processor from the triangles.

use antumbra::scene::Scene;
use antumbra::truth::Receiver;
use glam::{DMat4, DVec2, DVec3};

/// The depth of each pixel, 0 where it shows nothing, and the receiver there.
///
/// Depth is reversed, and every triangle in front of the eye.
pub fn receivers(
    scene: &Scene,
    clip_from_world: &DMat4,
    eye: DVec3,
    [width, height]: [u32; 2],
) -> Vec<(f64, Receiver)> {
    let nothing = Receiver { position: DVec3::ZERO, normal: DVec3::ZERO };
    let mut pixels = vec![(0.0, nothing); (width * height) as usize];
    let size = DVec2::new(f64::from(width), f64::from(height));
    let world_from_clip = clip_from_world.inverse();
    for instance in &scene.instances {
        let mesh = &scene.meshes[instance.mesh];
        let at = |corner: &u32| {
            let position = DVec3::from_array(mesh.positions[*corner as usize].map(f64::from));
            instance.world_from_mesh.transform_point3(position)
        };
        for corners in mesh.indices.chunks(3) {
            let corners = [at(&corners[0]), at(&corners[1]), at(&corners[2])];
            let clip = corners.map(|corner| *clip_from_world * corner.extend(1.0));
            assert!(clip.iter().all(|c| c.w > 0.0), "a triangle behind the eye");
            let ndc = clip.map(|c| c.truncate() / c.w);
            let screen = ndc.map(|c| 0.5 * (c.truncate() + 1.0) * size);
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            let normal = if normal.dot(eye - corners[0]) < 0.0 { -normal } else { normal };
            let area = (screen[1] - screen[0]).perp_dot(screen[2] - screen[0]);
            let low = screen[0].min(screen[1]).min(screen[2]).max(DVec2::ZERO);
            let high = screen[0].max(screen[1]).max(screen[2]).min(size);
            for y in low.y as u32..(high.y.ceil() as u32) {
                for x in low.x as u32..(high.x.ceil() as u32) {
                    let pixel = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
                    let shares = [[1, 2], [2, 0], [0, 1]]
                        .map(|[i, j]| (screen[i] - pixel).perp_dot(screen[j] - pixel) / area);
                    let depth = (0..3).map(|i| shares[i] * ndc[i].z).sum::<f64>();
                    let shown = &mut pixels[(y * width + x) as usize];
                    if shares.iter().all(|share| *share >= 0.0) && depth > shown.0 {
                        let at = 2.0 * pixel / size - 1.0;
                        let world = world_from_clip * at.extend(depth).extend(1.0);
                        let position = world.truncate() / world.w;
                        *shown = (depth, Receiver { position, normal });
                    }
                }
            }
        }
    }
    pixels
}
