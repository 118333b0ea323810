//! How a mesh hangs on joints, and the box around it in any pose.

use crate::Outcome;
use antumbra::lent::MeshBounds;
use antumbra::scene::Mesh;
use glam::{DMat4, DVec3, DVec4};

/// One joint of a vertex, as `posing.comp` reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Influence {
    pub joint: u32,
    /// The weights of one vertex add up to 1.
    pub weight: f32,
}

/// What a morph target adds to each vertex at weight 1: to its position, and to its normal.
pub type Target = Vec<[[f32; 3]; 2]>;

/// Fills in the pose at a number of seconds.
pub type Stands = fn(f64, &mut Pose);

/// How the joints of a mesh stand in a frame, and how far its morph targets go.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// Three rows of each joint's matrix, which takes the mesh at rest to where the joint moves it.
    pub joints: Vec<[[f32; 4]; 3]>,
    /// A weight for each morph target.
    pub weights: Vec<f32>,
}

impl Pose {
    /// Sets a joint's matrix.
    pub fn set(&mut self, joint: usize, mesh_from_rest: &DMat4) {
        let rows = [0, 1, 2].map(|row| mesh_from_rest.row(row).as_vec4().to_array());
        self.joints[joint] = rows;
    }
}

/// What poses a mesh.
pub struct Skin {
    /// The number of influences of each vertex: 4, or 8.
    pub width: usize,
    /// `width` influences of each vertex, the unused ones with a weight of 0.
    pub influences: Vec<Influence>,
    pub targets: Vec<Target>,
    /// Fills in the pose at a number of seconds.
    pub stands: Stands,
    /// The box of what each joint moves; `None` for a joint that moves no vertex.
    boxes: Vec<Option<JointBox>>,
}

/// The vertices that a joint moves: the box of their positions at rest, and of what each target adds to them.
struct JointBox {
    rest: Range,
    added: Vec<Range>,
}

/// Least and largest corner.
type Range = [DVec3; 2];

/// A box around nothing.
const EMPTY: Range = [DVec3::INFINITY, DVec3::NEG_INFINITY];

fn widen([low, high]: Range, by: Range) -> Range {
    [low.min(by[0]), high.max(by[1])]
}

fn wide(v: [f32; 3]) -> DVec3 {
    DVec3::from_array(v.map(f64::from))
}

impl Skin {
    /// A skin of `joints` joints: `hangs` has joint and weight of up to eight influences of each vertex, whose weights are
    /// made to add up to 1.
    ///
    /// # Errors
    /// A sentence that names the vertex whose influences, or the target whose vertices, do not fit.
    pub fn new(
        mesh: &Mesh,
        joints: usize,
        hangs: &[Vec<(usize, f64)>],
        targets: Vec<Target>,
        stands: Stands,
    ) -> Outcome<Self> {
        let vertices = mesh.positions.len();
        if hangs.len() != vertices {
            return Err(format!("{} of {vertices} vertices hang on joints", hangs.len()).into());
        }
        if let Some(nth) = targets.iter().position(|of| of.len() != vertices) {
            let of = targets[nth].len();
            return Err(format!("target {nth} moves {of} of {vertices} vertices").into());
        }
        let most = hangs.iter().map(Vec::len).max().unwrap_or(0);
        let width = if most > 4 { 8 } else { 4 };
        let mut influences = Vec::with_capacity(width * vertices);
        for (vertex, of) in hangs.iter().enumerate() {
            let sum: f64 = of.iter().map(|(_, weight)| weight).sum();
            let legal = |(joint, weight): &(usize, f64)| *joint < joints && *weight >= 0.0;
            if of.len() > 8 || !of.iter().all(legal) || !(sum > 0.0 && sum.is_finite()) {
                return Err(format!(
                    "vertex {vertex} must hang on up to 8 of {joints} joints, by weights of 0 or more that are \
                     not all 0 (it has {of:?})"
                )
                .into());
            }
            let used = of.iter().map(|&(joint, weight)| Influence {
                joint: joint as u32,
                weight: (weight / sum) as f32,
            });
            let unused = std::iter::repeat(Influence { joint: 0, weight: 0.0 });
            influences.extend(used.chain(unused).take(width));
        }
        let mut skin = Self { width, influences, targets, stands, boxes: Vec::new() };
        skin.boxes = (0..joints).map(|joint| skin.box_of(mesh, joint as u32)).collect();
        Ok(skin)
    }

    /// How many joints the skin has.
    pub fn joints(&self) -> usize {
        self.boxes.len()
    }

    /// Every joint as at rest, and every target at 0.
    pub fn rest(&self) -> Pose {
        let mut rest = Pose {
            joints: vec![[[0.0; 4]; 3]; self.joints()],
            weights: vec![0.0; self.targets.len()],
        };
        (0..self.joints()).for_each(|joint| rest.set(joint, &DMat4::IDENTITY));
        rest
    }

    fn box_of(&self, mesh: &Mesh, joint: u32) -> Option<JointBox> {
        let mut found: Option<JointBox> = None;
        for (vertex, of) in self.influences.chunks(self.width).enumerate() {
            if !of.iter().any(|i| i.joint == joint && i.weight > 0.0) {
                continue;
            }
            let all = found.get_or_insert_with(|| JointBox {
                rest: EMPTY,
                added: vec![EMPTY; self.targets.len()],
            });
            all.rest = widen(all.rest, [wide(mesh.positions[vertex]); 2]);
            for (added, target) in all.added.iter_mut().zip(&self.targets) {
                *added = widen(*added, [wide(target[vertex][0]); 2]);
            }
        }
        found
    }

    /// A box around the mesh in a pose, without a look at its vertices.
    ///
    /// A posed vertex is Σ wⱼ · Mⱼ(x), where x is the vertex with the targets added, the wⱼ are 0 or more and add up to 1:
    /// a convex combination of the places to which its joints alone would take it. Each of these lies in its joint's box,
    /// transformed, hence in the union of these boxes; so does the box around that union, which is convex, and hence
    /// contains the combination too.
    pub fn bounds(&self, pose: &Pose) -> MeshBounds {
        let (mut all, mut size) = (EMPTY, 0.0f64);
        for (joint, rows) in self.boxes.iter().zip(&pose.joints) {
            let Some(joint) = joint else { continue };
            let mut morphed = joint.rest;
            for (added, &weight) in joint.added.iter().zip(&pose.weights) {
                // A weight below 0 turns the range round.
                let ends = added.map(|end| f64::from(weight) * end);
                morphed[0] += ends[0].min(ends[1]);
                morphed[1] += ends[0].max(ends[1]);
            }
            let middle = morphed[0].midpoint(morphed[1]).extend(1.0);
            let half = (0.5 * (morphed[1] - morphed[0])).extend(0.0);
            let rows = rows.map(|row| DVec4::from_array(row.map(f64::from)));
            let center = DVec3::from_array(rows.map(|row| row.dot(middle)));
            let reach = DVec3::from_array(rows.map(|row| row.abs().dot(half)));
            all = widen(all, [center - reach, center + reach]);
            let terms = rows.map(|row| row.abs().dot(middle.abs() + half));
            size = terms.into_iter().fold(size, f64::max);
        }
        // The device poses in 32 bits, where weights add up to 1 within their rounding: fewer than this many roundings of
        // 2⁻²⁴ of sums whose terms, all counted as positive, are at most `size`.
        let slack = DVec3::splat((32 + self.targets.len()) as f64 * size / f64::from(1 << 24));
        [(all[0] - slack).as_vec3().to_array(), (all[1] + slack).as_vec3().to_array()]
    }
}
