//! What a ray through a tree is expected to cost, by the surfaces of its boxes.

use glam::Vec3;
use obvhs::bvh2::Bvh2;

/// A node of any tree of boxes over triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CostNode {
    /// The box's least coordinates, in any unit of length.
    pub low: Vec3,
    /// The box's greatest coordinates, in the same unit.
    pub high: Vec3,
    /// The number of triangles of a leaf; 0 for a node with children.
    pub triangles: u32,
}

/// The surface-area cost of a tree (MacDonald and Booth 1990, section 3): the number of nodes entered and triangles
/// tested by a long ray that meets the root's box, in the mean over all such rays, where a node with children and a
/// triangle cost 1 each. It has no unit, and does not depend on the scene's scale.
///
/// The root is the first node; the others may have any order. It is 0 without nodes, and NaN where the root's box has
/// no surface.
pub fn surface_area_cost(nodes: impl IntoIterator<Item = CostNode>) -> f64 {
    let mut root = None;
    let mut sum = 0.0;
    for CostNode { low, high, triangles } in nodes {
        let size = (high - low).as_dvec3();
        let area = size.x * size.y + size.y * size.z + size.z * size.x;
        root.get_or_insert(area);
        sum += area * f64::from(triangles.max(1));
    }
    root.map_or(0.0, |root| sum / root)
}

/// The cost of a tree of obvhs's.
pub(super) fn of_binary(tree: &Bvh2) -> f64 {
    let mut open = vec![0];
    surface_area_cost(std::iter::from_fn(|| {
        let node = &tree.nodes[open.pop()? as usize];
        if !node.is_leaf() {
            open.extend([node.first_index, node.first_index + 1]);
        }
        let (low, high) = (node.aabb().min.into(), node.aabb().max.into());
        Some(CostNode { low, high, triangles: node.prim_count })
    }))
}
