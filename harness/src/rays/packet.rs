//! The rays of one point to a light, all at once, and one ray alone.
//!
//! They begin at one point, so the plane through it and an edge of a triangle serves all of them: a ray meets the
//! triangle where it is inside three such planes (Plücker coordinates, as in Shevtsov, Soupikov and Kapustin 2007),
//! and the sign is the same for both triangles of an edge, so that nothing leaks between them.

use super::lanes::{Lanes, cross, dot, flip, load, splat, sub};
use super::tree::{Block, Child, Node, Tree};
use glam::Vec3;

/// The largest reciprocal of a direction: beyond, the box test would multiply 0 by infinity.
const LARGEST_RECIPROCAL: f32 = 1e18;

/// The pyramid from a point to a light. Everything is relative to the tree's origin or to the apex.
#[derive(Clone, Copy)]
pub(super) struct Pyramid {
    /// The point, relative to the tree's origin.
    pub(super) apex: Vec3,
    /// The light's centre and half its sides, relative to the apex; the rays end on this rectangle.
    pub(super) center: Vec3,
    pub(super) halves: [Vec3; 2],
}

/// Points on a light, eight at once: where they are between −1 and 1 on either half side.
#[derive(Clone, Copy)]
pub(super) struct Points<const K: usize> {
    pub(super) at: [[[f32; 8]; 2]; K],
    /// Which of them there are.
    pub(super) there: [u32; K],
}

/// What outlives a ray: the block that was hit last, and the nodes to be visited.
pub(super) struct Scratch {
    hit: Option<u32>,
    stack: Vec<u32>,
}

impl Scratch {
    pub(super) fn new(tree: &Tree) -> Self {
        Self { hit: None, stack: Vec::with_capacity(7 * tree.depth + 1) }
    }
}

/// The rays that nothing has blocked yet.
struct Rays<const K: usize> {
    /// From the apex to where they end.
    directions: [[[f32; 8]; 3]; K],
    reciprocals: [[[f32; 8]; 3]; K],
    alive: [u32; K],
}

impl<const K: usize> Rays<K> {
    #[inline(always)]
    fn new<V: Lanes>(pyramid: &Pyramid, points: &Points<K>) -> Self {
        let mut rays = Self {
            directions: [[[0.0; 8]; 3]; K],
            reciprocals: [[[0.0; 8]; 3]; K],
            alive: points.there,
        };
        for k in 0..K {
            let [s, t] = [V::load(&points.at[k][0]), V::load(&points.at[k][1])];
            for axis in 0..3 {
                let [x, y] = [V::splat(pyramid.halves[0][axis]), V::splat(pyramid.halves[1][axis])];
                let direction = s.mul_add(x, t.mul_add(y, V::splat(pyramid.center[axis])));
                let size = direction.abs().max(V::splat(1.0 / LARGEST_RECIPROCAL));
                rays.directions[k][axis] = direction.store();
                rays.reciprocals[k][axis] = V::splat(1.0).div(size).flip(direction).store();
            }
        }
        rays
    }

    #[inline(always)]
    fn none_left(&self) -> bool {
        self.alive.iter().all(|&alive| alive == 0)
    }

    /// Whether one of them meets a box, given relative to the apex.
    #[inline(always)]
    fn meet<V: Lanes>(&self, low: Vec3, high: Vec3) -> bool {
        let (low, high) = (splat::<V>(low), splat::<V>(high));
        for k in 0..K {
            if self.alive[k] == 0 {
                continue;
            }
            let reciprocal = load::<V>(&self.reciprocals[k]);
            let (mut near, mut far) = (V::splat(0.0), V::splat(1.0));
            for axis in 0..3 {
                let (a, b) = (low[axis].mul(reciprocal[axis]), high[axis].mul(reciprocal[axis]));
                near = near.max(a.min(b));
                far = far.min(a.max(b));
            }
            if near.le(far) & self.alive[k] != 0 {
                return true;
            }
        }
        false
    }

    /// Blocks those that meet a triangle; whether there was one.
    #[inline(always)]
    fn meet_block<V: Lanes>(&mut self, block: &Block, pyramid: &Pyramid) -> bool {
        let edges = Edges::<V>::of(block, pyramid.apex);
        let center = splat::<V>(pyramid.center);
        let halves = [splat::<V>(pyramid.halves[0]), splat::<V>(pyramid.halves[1])];
        // The triangles that the pyramid may meet, and those that hide the whole light.
        let (mut some, mut whole) = (edges.off_plane, edges.off_plane);
        for normal in edges.sides {
            let at_center = dot(normal, center);
            let reach = dot(normal, halves[0]).abs().add(dot(normal, halves[1]).abs());
            some &= at_center.le(reach);
            whole &= at_center.add(reach).le(V::splat(0.0));
        }
        let at_center = dot(edges.normal, center).add(edges.height);
        let reach = dot(edges.normal, halves[0]).abs().add(dot(edges.normal, halves[1]).abs());
        some &= at_center.le(reach);
        whole &= at_center.add(reach).le(V::splat(0.0));
        if whole != 0 {
            self.alive = [0; K];
            return true;
        }
        if some == 0 {
            return false;
        }
        let [a, b, c] = [store(edges.sides[0]), store(edges.sides[1]), store(edges.sides[2])];
        let (normal, height) = (store(edges.normal), edges.height.store());
        let mut any = false;
        while some != 0 {
            let i = some.trailing_zeros() as usize;
            some &= some - 1;
            let [a, b, c] = [lane::<V>(&a, i), lane::<V>(&b, i), lane::<V>(&c, i)];
            let (normal, height) = (lane::<V>(&normal, i), V::splat(height[i]));
            for k in 0..K {
                if self.alive[k] == 0 {
                    continue;
                }
                let d = load::<V>(&self.directions[k]);
                let worst = dot(a, d).max(dot(b, d)).max(dot(c, d)).max(dot(normal, d).add(height));
                let hit = worst.le(V::splat(0.0)) & self.alive[k];
                any |= hit != 0;
                self.alive[k] &= !hit;
            }
        }
        any
    }
}

#[inline(always)]
fn corner(of: &[[f32; 8]; 3], i: usize) -> Vec3 {
    Vec3::new(of[0][i], of[1][i], of[2][i])
}

#[inline(always)]
fn store<V: Lanes>(of: [V; 3]) -> [[f32; 8]; 3] {
    [of[0].store(), of[1].store(), of[2].store()]
}

#[inline(always)]
fn lane<V: Lanes>(of: &[[f32; 8]; 3], i: usize) -> [V; 3] {
    [V::splat(of[0][i]), V::splat(of[1][i]), V::splat(of[2][i])]
}

/// Eight triangles as a point sees them: a direction to where a ray ends meets the triangle where its products with
/// all three `sides` are at most 0, and that with `normal` at most −`height`.
struct Edges<V> {
    sides: [[V; 3]; 3],
    normal: [V; 3],
    height: V,
    /// The triangles in whose plane the point does not lie: from there they are seen edge-on.
    off_plane: u32,
}

impl<V: Lanes> Edges<V> {
    #[inline(always)]
    fn of(block: &Block, apex: Vec3) -> Self {
        let apex = splat::<V>(apex);
        let normal = load::<V>(&block.normals);
        let height = dot(normal, apex).add(V::load(&block.distances));
        let [a, b, c] = &block.corners;
        let [a, b, c] = [sub(load::<V>(a), apex), sub(load::<V>(b), apex), sub(load::<V>(c), apex)];
        // Seen from behind, all signs turn.
        Self {
            sides: [
                flip(cross(a, b), height),
                flip(cross(b, c), height),
                flip(cross(c, a), height),
            ],
            normal: flip(normal, height),
            height: height.abs(),
            off_plane: !height.abs().le(V::splat(0.0)) & 0xff,
        }
    }
}

/// How many of the rays from a point to a light nothing blocks.
///
/// A node's boxes are held against the pyramid, all at once; those that it meets, against the rays, so that in a dense
/// mesh no more is visited than rays go through. The rays are made when the first box is met: over most pixels of a
/// picture there is none.
#[inline(always)]
pub(super) fn packet<V: Lanes, const K: usize>(
    tree: &Tree,
    pyramid: &Pyramid,
    points: &Points<K>,
    scratch: &mut Scratch,
) -> u32 {
    let mut made = None;
    if let Some(hit) = scratch.hit {
        let rays = made.insert(Rays::new::<V>(pyramid, points));
        rays.meet_block::<V>(&tree.blocks[hit as usize], pyramid);
        if rays.none_left() {
            return 0;
        }
    }
    let sides = Sides::of(pyramid);
    scratch.stack.clear();
    scratch.stack.push(0);
    while let Some(node) = scratch.stack.pop() {
        let node = &tree.nodes[node as usize];
        let mut met = sides.meet::<V>(node);
        if met == 0 {
            continue;
        }
        // Code in a closure would not be compiled for AVX2.
        if made.is_none() {
            made = Some(Rays::new::<V>(pyramid, points));
        }
        let Some(rays) = &mut made else { continue };
        while met != 0 {
            let i = met.trailing_zeros() as usize;
            met &= met - 1;
            let [low, high] = [corner(&node.low, i), corner(&node.high, i)];
            if !rays.meet::<V>(low - pyramid.apex, high - pyramid.apex) {
                continue;
            }
            match node.child(i) {
                Child::Node(child) => scratch.stack.push(child),
                Child::Block(block) => {
                    if rays.meet_block::<V>(&tree.blocks[block as usize], pyramid) {
                        scratch.hit = Some(block);
                        if rays.none_left() {
                            return 0;
                        }
                    }
                }
            }
        }
    }
    let alive = made.map_or(points.there, |rays| rays.alive);
    alive.iter().map(|alive| alive.count_ones()).sum()
}

/// What bounds a pyramid: its box, and the planes through its apex and the light's sides.
struct Sides {
    apex: Vec3,
    low: Vec3,
    high: Vec3,
    /// Inward normals.
    planes: [Vec3; 4],
}

impl Sides {
    #[inline(always)]
    fn of(pyramid: &Pyramid) -> Self {
        let Pyramid { apex, center, halves: [x, y] } = *pyramid;
        let reach = x.abs() + y.abs();
        // A plane by the light's side and a corner: two corners of a far light are nearly the same direction.
        let inward = |side: Vec3, to: Vec3| {
            let normal = side.cross(center + to);
            if normal.dot(to) > 0.0 { -normal } else { normal }
        };
        Self {
            apex,
            low: apex + (center - reach).min(Vec3::ZERO),
            high: apex + (center + reach).max(Vec3::ZERO),
            planes: [inward(x, y), inward(x, -y), inward(y, x), inward(y, -x)],
        }
    }

    /// Which of a node's boxes the pyramid may meet.
    #[inline(always)]
    fn meet<V: Lanes>(&self, node: &Node) -> u32 {
        let (low, high) = (load::<V>(&node.low), load::<V>(&node.high));
        let mut met = 0xff;
        for axis in 0..3 {
            met &= low[axis].le(V::splat(self.high[axis]));
            met &= V::splat(self.low[axis]).le(high[axis]);
        }
        if met == 0 {
            return 0;
        }
        let apex = splat::<V>(self.apex);
        let (low, high) = (sub(low, apex), sub(high, apex));
        for plane in self.planes {
            let x = if plane.x > 0.0 { high[0] } else { low[0] };
            let y = if plane.y > 0.0 { high[1] } else { low[1] };
            let z = if plane.z > 0.0 { high[2] } else { low[2] };
            met &= V::splat(0.0).le(dot([x, y, z], splat(plane)));
        }
        met
    }
}

#[inline(always)]
fn crosses<V: Lanes>(block: &Block, from: Vec3, along: Vec3) -> bool {
    let edges = Edges::<V>::of(block, from);
    let (d, [a, b, c]) = (splat::<V>(along), edges.sides);
    let worst = dot(a, d).max(dot(b, d)).max(dot(c, d)).max(dot(edges.normal, d).add(edges.height));
    worst.le(V::splat(0.0)) & edges.off_plane != 0
}

/// Whether a triangle crosses the segment from a point along a direction to its end.
#[inline(always)]
pub(super) fn single<V: Lanes>(
    tree: &Tree,
    from: Vec3,
    along: Vec3,
    scratch: &mut Scratch,
) -> bool {
    if let Some(hit) = scratch.hit
        && crosses::<V>(&tree.blocks[hit as usize], from, along)
    {
        return true;
    }
    let reciprocal = Vec3::from_array(along.to_array().map(|x| {
        let size = x.abs().max(1.0 / LARGEST_RECIPROCAL);
        (1.0 / size).copysign(x)
    }));
    let (by, shift) = (splat::<V>(reciprocal), splat::<V>(-from * reciprocal));
    scratch.stack.clear();
    scratch.stack.push(0);
    while let Some(node) = scratch.stack.pop() {
        let node = &tree.nodes[node as usize];
        let (mut near, mut far) = (V::splat(0.0), V::splat(1.0));
        for axis in 0..3 {
            let ends = [&node.low[axis], &node.high[axis]];
            let [first, last] = if reciprocal[axis] < 0.0 { [ends[1], ends[0]] } else { ends };
            near = near.max(V::load(first).mul_add(by[axis], shift[axis]));
            far = far.min(V::load(last).mul_add(by[axis], shift[axis]));
        }
        let mut met = near.le(far);
        while met != 0 {
            let i = met.trailing_zeros() as usize;
            met &= met - 1;
            match node.child(i) {
                Child::Node(child) => scratch.stack.push(child),
                Child::Block(block) => {
                    if crosses::<V>(&tree.blocks[block as usize], from, along) {
                        scratch.hit = Some(block);
                        return true;
                    }
                }
            }
        }
    }
    false
}
