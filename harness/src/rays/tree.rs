//! The tree: obvhs's binary one, made wide, over blocks of triangles in leaf order.

use antumbra::Error;
use antumbra::scene::{Instance, Scene};
use glam::DVec3;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::leaf_collapser::collapse;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

/// The relative error of one rounding to f32.
pub(super) const ROUNDING: f64 = 1.0 / (1 << 24) as f64;

/// Padding of the boxes, in roundings of the scene's extent: a box test rounds the ray's origin, its direction's
/// reciprocal, a product and a difference, each relative to coordinates of at most five times the extent.
const PAD_ROUNDINGS: f64 = 16.0;

/// The largest coordinate, in metres, for which products of three of them do not overflow f32.
const LARGEST_COORDINATE: f64 = 1e12;

/// The most triangles of a leaf: a block of them is tested at once.
pub(super) const LEAF: u32 = 8;

/// The cost of a step down the binary tree over that of a triangle, with which leaves are collapsed.
const STEP_COST: f32 = 6.0;

/// Marks a child that is a block of triangles.
const BLOCK: u32 = 1 << 31;

/// Eight boxes, relative to the scene's centre, and what is in them.
#[derive(Clone)]
#[repr(C, align(64))]
pub(super) struct Node {
    pub(super) low: [[f32; 8]; 3],
    pub(super) high: [[f32; 8]; 3],
    children: [u32; 8],
}

/// What one of a node's boxes holds.
#[derive(Clone, Copy)]
pub(super) enum Child {
    Node(u32),
    Block(u32),
}

impl Node {
    /// Boxes that nothing meets: their low ends are above everything.
    const EMPTY: Self =
        Self { low: [[f32::INFINITY; 8]; 3], high: [[f32::NEG_INFINITY; 8]; 3], children: [0; 8] };

    /// What the i-th box holds.
    #[inline(always)]
    pub(super) fn child(&self, i: usize) -> Child {
        match self.children[i] {
            child if child & BLOCK != 0 => Child::Block(child ^ BLOCK),
            child => Child::Node(child),
        }
    }
}

/// Eight triangles, relative to the scene's centre; those that are missing lie in no plane and block nothing.
#[derive(Clone, Default)]
#[repr(C, align(32))]
pub(super) struct Block {
    /// The first, second and third corners.
    pub(super) corners: [[[f32; 8]; 3]; 3],
    /// The unit normals, computed in f64: the plane of a long thin triangle is lost between corners in f32.
    pub(super) normals: [[f32; 8]; 3],
    /// The planes' distances: a point's height over the plane is normal · point + distance.
    pub(super) distances: [f32; 8],
}

impl Block {
    fn set(&mut self, lane: usize, corners: &[DVec3; 3]) {
        let [a, b, c] = *corners;
        // The distance is that of the plane with the rounded normal through the middle of the triangle.
        let normal = (b - a).cross(c - a).normalize_or_zero().as_vec3();
        let middle = (a + b + c) / 3.0;
        self.distances[lane] = -normal.as_dvec3().dot(middle) as f32;
        for axis in 0..3 {
            self.normals[axis][lane] = normal[axis];
            for (of, corner) in self.corners.iter_mut().zip(corners) {
                of[axis][lane] = corner[axis] as f32;
            }
        }
    }
}

/// The tree over the triangles of a scene that block light.
pub(super) struct Tree {
    /// World space; everything else is relative to it.
    pub(super) origin: DVec3,
    /// The largest coordinate of any instance, relative to `origin`.
    pub(super) extent: f64,
    pub(super) triangles: usize,
    /// Without triangles there is none.
    pub(super) nodes: Vec<Node>,
    pub(super) blocks: Vec<Block>,
    pub(super) depth: usize,
    /// The binary tree that it was made of.
    pub(super) binary: Option<Bvh2>,
}

impl Tree {
    pub(super) fn new(scene: &Scene) -> Result<Self, Error> {
        let (mut low, mut high) = (DVec3::MAX, DVec3::MIN);
        let mut triangles = Vec::new();
        for instance in &scene.instances {
            let world = corners(scene, instance)?;
            for corner in world.iter().flatten() {
                (low, high) = (low.min(*corner), high.max(*corner));
            }
            if instance.role.blocks() {
                triangles.extend(world);
            }
        }
        let (origin, extent) = if low.cmple(high).all() {
            ((low + high) / 2.0, ((high - low) / 2.0).max_element())
        } else {
            (DVec3::ZERO, 0.0)
        };
        triangles.iter_mut().flatten().for_each(|corner| *corner -= origin);
        triangles.retain(|[a, b, c]| (b - a).cross(c - a) != DVec3::ZERO);
        let count = triangles.len();
        let (nodes, blocks) = (Vec::new(), Vec::new());
        let mut tree =
            Self { origin, extent, triangles: count, nodes, blocks, depth: 0, binary: None };
        if count > 0 {
            let binary = binary(&triangles, PAD_ROUNDINGS * ROUNDING * extent);
            tree.widen(&binary, &triangles);
            tree.binary = Some(binary);
        }
        Ok(tree)
    }

    /// Makes nodes of eight: of a node's children the one with the largest box is opened, until there are eight
    /// (Wald, Benthin and Boulos 2008, section 3.2).
    fn widen(&mut self, binary: &Bvh2, triangles: &[[DVec3; 3]]) {
        let node = |i: u32| &binary.nodes[i as usize];
        let area = |i: u32| node(i).aabb().half_area();
        self.nodes.push(Node::EMPTY);
        let mut open = vec![(0, 0, 1)];
        while let Some((from, to, depth)) = open.pop() {
            self.depth = self.depth.max(depth);
            let mut children = vec![from];
            while children.len() < 8 {
                let inner = (0..children.len()).filter(|&i| !node(children[i]).is_leaf());
                let largest =
                    inner.max_by(|&i, &j| area(children[i]).total_cmp(&area(children[j])));
                let Some(i) = largest else { break };
                let first = node(children[i]).first_index;
                children[i] = first;
                children.push(first + 1);
            }
            // The last on the stack is visited first, and what is large is hit soonest.
            children.sort_by(|&i, &j| area(i).total_cmp(&area(j)));
            for (lane, &child) in children.iter().enumerate() {
                let child = node(child);
                for axis in 0..3 {
                    self.nodes[to].low[axis][lane] = child.aabb().min[axis];
                    self.nodes[to].high[axis][lane] = child.aabb().max[axis];
                }
                self.nodes[to].children[lane] = if child.is_leaf() {
                    let mut block = Block::default();
                    let first = child.first_index as usize;
                    let leaf = &binary.primitive_indices[first..first + child.prim_count as usize];
                    let leaf = leaf.iter().map(|&i| &triangles[i as usize]);
                    leaf.enumerate().for_each(|(lane, corners)| block.set(lane, corners));
                    self.blocks.push(block);
                    BLOCK | (self.blocks.len() - 1) as u32
                } else {
                    self.nodes.push(Node::EMPTY);
                    open.push((children[lane], self.nodes.len() - 1, depth + 1));
                    (self.nodes.len() - 1) as u32
                };
            }
        }
    }
}

/// A binary tree by obvhs: PLOC (Meister and Bittner 2018), improved by reinsertion (Meister and Bittner 2017), with
/// leaves of up to [`LEAF`] triangles.
fn binary(triangles: &[[DVec3; 3]], pad: f64) -> Bvh2 {
    let boxes: Vec<Aabb> = triangles
        .iter()
        .map(|[a, b, c]| {
            let (low, high) = (a.min(*b).min(*c) - pad, a.max(*b).max(*c) + pad);
            Aabb::new(low.as_vec3a(), high.as_vec3a())
        })
        .collect();
    let all = (0..boxes.len() as u32).collect();
    let (search, precision) = (PlocSearchDistance::Medium, SortPrecision::U64);
    let mut tree = PlocBuilder::with_capacity(boxes.len()).build(search, &boxes, all, precision, 3);
    let mut reinsertion = ReinsertionOptimizer::default();
    reinsertion.run(&mut tree, 0.05, None);
    collapse(&mut tree, LEAF, STEP_COST);
    reinsertion.run(&mut tree, 0.1, None);
    tree
}

/// The corners of an instance's triangles in world space.
fn corners(scene: &Scene, instance: &Instance) -> Result<Vec<[DVec3; 3]>, Error> {
    let refuse = |problem: String| Error::Scene(format!("{}: {problem}", instance.name));
    let mesh = scene.meshes.get(instance.mesh).ok_or_else(|| {
        refuse(format!("mesh {} does not exist (there are {})", instance.mesh, scene.meshes.len()))
    })?;
    let corner = |index: u32| {
        let position = mesh.positions.get(index as usize).ok_or_else(|| {
            refuse(format!("index {index} is past its {} positions", mesh.positions.len()))
        })?;
        let world = DVec3::from_array(position.map(f64::from));
        let world = instance.world_from_mesh.transform_point3(world);
        // The largest element alone would pass over a NaN beside it.
        if world.is_finite() && world.abs().max_element() <= LARGEST_COORDINATE {
            return Ok(world);
        }
        let problem = format!("must be within {LARGEST_COORDINATE:e} m (it is at {world})");
        Err(refuse(format!("vertex {index} {problem}")))
    };
    let triangle = |t: &[u32]| Ok([corner(t[0])?, corner(t[1])?, corner(t[2])?]);
    mesh.indices.chunks_exact(3).map(triangle).collect()
}
