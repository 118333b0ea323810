//! The hierarchy of triangles as a device has built it, read back.

use crate::Stage;
use crate::rays::{CostNode, surface_area_cost};
use antumbra::stages::hierarchy::LEAF;
use antumbra::{Error, FramePlan};
use glam::Vec3;

/// The texels before the first node (`glsl/hierarchy/texels.glsl`).
const HEAD: usize = 2;
/// The bit that marks a leaf.
const IS_LEAF: u32 = 1 << 31;

/// A hierarchy as it is walked, in its own space: the world's axes, metres, an origin near the meshes.
pub struct DeviceTree {
    /// How many nodes there are.
    pub nodes: usize,
    /// The texels of the image of nodes, which are in depth-first order behind the root's box: each has its box in
    /// steps, 16 bits a corner, and a link.
    pub texels: Vec<[u32; 4]>,
    /// The triangles' corners, leaf by leaf.
    pub triangles: Vec<[f32; 4]>,
    /// The least corner of the root's box.
    pub low: Vec3,
    /// The step of all boxes, metres.
    pub step: Vec3,
}

/// What a node holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Link {
    /// The node behind the subtree.
    End(usize),
    /// The number of a leaf.
    Leaf(usize),
}

impl DeviceTree {
    /// Reads the hierarchy of a plan that has run; it has `leaves` leaves.
    ///
    /// # Errors
    /// As [`Stage::inspect`].
    pub fn read(stage: &mut Stage, plan: &FramePlan, leaves: usize) -> Result<Self, Error> {
        let (texels, _): (Vec<[u32; 4]>, _) = stage.inspect(plan, "hierarchy.nodes")?;
        let (mut triangles, _): (Vec<[f32; 4]>, _) = stage.inspect(plan, "hierarchy.triangles")?;
        // Behind the last leaf there is whatever the memory held.
        triangles.truncate(3 * LEAF as usize * leaves);
        let of = |nth: usize| {
            let [x, y, z, _] = texels[nth].map(f32::from_bits);
            Vec3::new(x, y, z)
        };
        let (low, step) = (of(0), of(1));
        Ok(Self { nodes: 2 * leaves - 1, texels, triangles, low, step })
    }

    /// The least and largest corner of a node's box.
    pub fn bounds(&self, node: usize) -> [Vec3; 2] {
        let [x, y, z, _] = self.texels[HEAD + node];
        let at = |pick: fn(u32) -> u32| {
            let steps = Vec3::new(pick(x) as f32, pick(y) as f32, pick(z) as f32);
            self.low + steps * self.step
        };
        [at(|word| word & 0xffff), at(|word| word >> 16)]
    }

    /// What a node holds.
    pub fn link(&self, node: usize) -> Link {
        match self.texels[HEAD + node][3] {
            word if word & IS_LEAF == 0 => Link::End(word as usize),
            word => Link::Leaf((word & !IS_LEAF) as usize),
        }
    }

    /// A triangle's corners; none for a place that only fills a leaf.
    pub fn triangle(&self, nth: usize) -> Option<[Vec3; 3]> {
        let corner = |i: usize| self.triangles[3 * nth + i];
        let there = corner(0)[3] > 0.0;
        there.then(|| [0, 1, 2].map(|i| Vec3::new(corner(i)[0], corner(i)[1], corner(i)[2])))
    }

    /// The places of a leaf's triangles.
    pub fn places(leaf: usize) -> std::ops::Range<usize> {
        leaf * LEAF as usize..(leaf + 1) * LEAF as usize
    }

    /// The tree's surface-area cost: what [`surface_area_cost`] says of it.
    pub fn cost(&self) -> f64 {
        surface_area_cost((0..self.nodes).map(|node| {
            let [low, high] = self.bounds(node);
            let triangles = match self.link(node) {
                Link::End(_) => 0,
                Link::Leaf(leaf) => Self::places(leaf).filter_map(|i| self.triangle(i)).count(),
            };
            CostNode { low, high, triangles: triangles as u32 }
        }))
    }
}
