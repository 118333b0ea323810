//! The plane parts of a mesh, and their outlines.

use glam::DVec3;
use std::collections::BTreeMap;

/// How far a triangle may leave the plane of its part, and a corner the line between its neighbours, as a share of the mesh's
/// size: positions are f32.
const FLAT: f64 = 1e-6;

/// The least cosine between the normals of two triangles of a part.
const LEVEL: f64 = 0.999;

/// The most corners of an outline that is made simpler, which takes time as their square.
const MOST_CORNERS: usize = 2048;

/// Triangles of one plane that hang together.
pub(super) struct Part {
    /// The area of its triangles.
    pub area: f64,
    /// The corners around it, counter-clockwise as seen from its front, none of them in line with its neighbours; none where
    /// no single line leads around it.
    pub corners: Vec<DVec3>,
    /// The area within the corners, which holes take a part of.
    pub enclosed: f64,
}

/// Triangles by the numbers of their points, of which no two are in one place.
pub(super) struct Triangles {
    points: Vec<DVec3>,
    corners: Vec<[u32; 3]>,
    size: f64,
}

impl Triangles {
    /// The triangles of these indices into positions, each of which is at its own place in `world`.
    pub fn new(
        positions: &[[f32; 3]],
        indices: &[u32],
        world: impl Fn(DVec3) -> DVec3,
        mirrored: bool,
    ) -> Self {
        let mut points: Vec<DVec3> = Vec::new();
        let mut known: BTreeMap<[u32; 3], u32> = BTreeMap::new();
        let mut number = |index: &u32| {
            let position = positions.get(*index as usize).copied().unwrap_or_default();
            // Both zeros are one place.
            let key = position.map(|of| (of + 0.0).to_bits());
            *known.entry(key).or_insert_with(|| {
                points.push(world(DVec3::from_array(position.map(f64::from))));
                points.len() as u32 - 1
            })
        };
        let mut corners = Vec::with_capacity(indices.len() / 3);
        for triangle in indices.chunks_exact(3) {
            if let [a, b, c] = triangle {
                let [a, b, c] = [a, b, c].map(&mut number);
                corners.push(if mirrored { [a, c, b] } else { [a, b, c] });
            }
        }
        let first = points.first().copied().unwrap_or_default();
        let size = points.iter().map(|p| (p - first).abs().max_element()).fold(0.0, f64::max);
        Self { points, corners, size }
    }

    fn point(&self, number: u32) -> DVec3 {
        self.points.get(number as usize).copied().unwrap_or_default()
    }

    /// Twice the area of a triangle along its normal.
    fn doubled(&self, triangle: [u32; 3]) -> DVec3 {
        let [a, b, c] = triangle.map(|number| self.point(number));
        (b - a).cross(c - a)
    }

    /// The parts, from the largest on. Triangles without area are in none.
    pub fn parts(&self) -> Vec<Part> {
        let mut owners: BTreeMap<[u32; 2], usize> = BTreeMap::new();
        for (nth, triangle) in self.corners.iter().enumerate() {
            for edge in edges(*triangle) {
                owners.entry(edge).or_insert(nth);
            }
        }
        let mut taken: Vec<bool> =
            self.corners.iter().map(|of| self.doubled(*of) == DVec3::ZERO).collect();
        let mut parts = Vec::new();
        for seed in 0..self.corners.len() {
            let Some(of_seed) = self.corners.get(seed).filter(|_| taken.get(seed) == Some(&false))
            else {
                continue;
            };
            let (normal, at) = (self.doubled(*of_seed).normalize_or_zero(), self.point(of_seed[0]));
            let level = |triangle: [u32; 3]| {
                let flat = |number| (self.point(number) - at).dot(normal).abs() <= FLAT * self.size;
                self.doubled(triangle).normalize_or_zero().dot(normal) >= LEVEL
                    && triangle.into_iter().all(flat)
            };
            let (mut waiting, mut all) = (vec![seed], Vec::new());
            if let Some(flag) = taken.get_mut(seed) {
                *flag = true;
            }
            while let Some(next) = waiting.pop() {
                let Some(triangle) = self.corners.get(next) else { continue };
                all.push(*triangle);
                for [from, to] in edges(*triangle) {
                    let Some(other) = owners.get(&[to, from]) else { continue };
                    let is_level = self.corners.get(*other).is_some_and(|of| level(*of));
                    if let Some(flag) = taken.get_mut(*other).filter(|flag| !**flag && is_level) {
                        *flag = true;
                        waiting.push(*other);
                    }
                }
            }
            parts.push(self.part(&all, normal));
        }
        parts.sort_by(|a, b| b.area.total_cmp(&a.area));
        parts
    }

    fn part(&self, triangles: &[[u32; 3]], normal: DVec3) -> Part {
        let area = triangles.iter().map(|of| 0.5 * self.doubled(*of).dot(normal)).sum();
        let none = Part { area, corners: Vec::new(), enclosed: 0.0 };
        let all: BTreeMap<[u32; 2], usize> = {
            let mut count = BTreeMap::new();
            for edge in triangles.iter().flat_map(|of| edges(*of)) {
                *count.entry(edge).or_insert(0) += 1;
            }
            count
        };
        let mut next: BTreeMap<u32, u32> = BTreeMap::new();
        for ([from, to], count) in &all {
            if *count > 1 {
                return none;
            }
            // Two ways from one point are no single line.
            if !all.contains_key(&[*to, *from]) && next.insert(*from, *to).is_some() {
                return none;
            }
        }
        let mut outer: (f64, Vec<DVec3>) = (0.0, Vec::new());
        while let Some((start, mut to)) = next.pop_first() {
            let mut around = vec![self.point(start)];
            while to != start {
                around.push(self.point(to));
                match next.remove(&to) {
                    Some(after) => to = after,
                    None => return none,
                }
            }
            let enclosed = enclosed(&around, normal);
            if enclosed > outer.0 {
                outer = (enclosed, around);
            }
        }
        let corners = straightened(&outer.1, FLAT * self.size);
        Part { area, enclosed: enclosed(&corners, normal), corners }
    }
}

fn edges([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

/// The area within corners, above 0 where they run counter-clockwise around the normal.
fn enclosed(corners: &[DVec3], normal: DVec3) -> f64 {
    let Some(first) = corners.first() else { return 0.0 };
    let of = |pair: &[DVec3]| match pair {
        [a, b] => 0.5 * (a - first).cross(b - first).dot(normal),
        _ => 0.0,
    };
    corners.windows(2).map(of).sum()
}

/// How far a corner is from the line between its neighbours.
fn bend([before, at, after]: [DVec3; 3]) -> f64 {
    let line = after - before;
    match line.try_normalize() {
        Some(line) => (at - before).reject_from_normalized(line).length(),
        None => 0.0,
    }
}

/// The corners that are further than so much from the line between their neighbours.
fn straightened(corners: &[DVec3], least: f64) -> Vec<DVec3> {
    let mut kept: Vec<DVec3> = Vec::new();
    for (nth, at) in corners.iter().enumerate() {
        let before = kept.last().or(corners.last()).copied().unwrap_or_default();
        let after = corners.get(nth + 1).or(kept.first()).or(corners.first());
        if bend([before, *at, after.copied().unwrap_or_default()]) > least {
            kept.push(*at);
        }
    }
    kept
}

/// The outline with no more corners than so many: each time the one goes whose triangle with its neighbours is least.
/// `None` where there are too many to begin with.
pub(super) fn simplified(corners: &[DVec3], most: usize) -> Option<Vec<DVec3>> {
    let mut kept = corners.to_vec();
    if kept.len() > MOST_CORNERS {
        return None;
    }
    while kept.len() > most {
        let size = |nth: usize| {
            let of = |nth: usize| kept.get(nth % kept.len()).copied().unwrap_or_default();
            let [a, b, c] = [of(nth + kept.len() - 1), of(nth), of(nth + 1)];
            (b - a).cross(c - a).length()
        };
        let least = (0..kept.len()).min_by(|a, b| size(*a).total_cmp(&size(*b)))?;
        kept.remove(least);
    }
    Some(kept)
}
