//! Meshes whose vertices lie far from the origin of their own space.

use super::*;

/// The square around a place, in the coordinates that f32 has there.
fn square_at(at: [f32; 3]) -> [[f32; 3]; 4] {
    SQUARE.map(|p| [0, 1, 2].map(|i| p[i] + at[i]))
}

/// The scene of squares, each a mesh of its own at one of these places, under these nodes.
fn squares(places: &[[f32; 3]], nodes: &Value) -> Scene {
    let mut file = File::default();
    let meshes: Vec<Value> = places
        .iter()
        .map(|at| {
            let position = file.vectors(&square_at(*at));
            let indices = file.indices(&TWO_TRIANGLES);
            json!({"primitives": [{"attributes": {"POSITION": position}, "indices": indices}]})
        })
        .collect();
    let roots: Vec<usize> = (0..nodes.as_array().unwrap().len()).collect();
    let members = json!({"meshes": meshes, "nodes": nodes, "scenes": [{"nodes": roots}]});
    file.scene(&json!([]), members).unwrap()
}

/// Vertices around (10⁵, 0, 10⁵) are brought to their mesh's origin, and stay where they are in the world to the bit.
#[test]
fn a_mesh_far_from_its_origin_is_moved_there() {
    let at = [100_000.0, 0.0, -70_000.0];
    let scene = squares(&[at], &json!([{"mesh": 0}]));
    let placed = square_at(at).map(|p| DVec3::from_array(p.map(f64::from)));
    assert_eq!(corners(&scene), [[0, 1, 2], [0, 2, 3]].map(|t| t.map(|i: usize| placed[i])));
    let far = scene.meshes[0].positions.as_flattened().iter().fold(0.0_f32, |m, x| m.max(x.abs()));
    assert!(far <= 1.0, "a coordinate is {far}");
    // Along y it lies at its origin, and stays.
    assert_eq!(scene.instances[0].world_from_mesh.w_axis.y, 0.0);
}

/// A node's rotation and scale apply to the place of the mesh, too.
#[test]
fn a_far_mesh_goes_where_its_node_puts_it() {
    let at = [4096.0, 512.0, 0.0];
    let node = json!([{"mesh": 0, "scale": [2, 2, -2], "rotation": [0, 0, 1, 0], "translation": [8192, 0, 0]}]);
    let found = corners(&squares(&[at], &node));
    for (t, triangle) in [[0, 1, 2], [0, 2, 3]].into_iter().zip(found) {
        for (i, corner) in t.into_iter().zip(triangle) {
            let [x, y, z] = square_at(at)[i].map(f64::from);
            assert_eq!(corner, DVec3::new(8192.0 - 2.0 * x, -2.0 * y, -2.0 * z));
        }
    }
}

/// A mesh that holds the origin, or lies within a few of its extents, keeps the file's positions.
#[test]
fn a_mesh_near_its_origin_stays() {
    for at in [[0.0; 3], [-0.5, 0.25, 0.0], [0.9, -0.9, 0.0]] {
        let scene = squares(&[at], &json!([{"mesh": 0}]));
        assert_eq!(scene.instances[0].world_from_mesh, DMat4::IDENTITY, "{at:?}");
        let low = scene.meshes[0].bounds()[0];
        assert_eq!(low[..2], at[..2], "{at:?}");
    }
}
