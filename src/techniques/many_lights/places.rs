//! The places of the points on the light.
//!
//! ```text
//!    ┌──────────────┐        ___________
//!    │ ·  │·   │  · │       /· │ · /      rows of as many cells as their share of the area
//!    ├────┴─┬──┴────┤      /──┬┴──/       cut across so that all cells have one area:
//!    │   ·  │    ·  │     / · │ ·│        a rectangle, or any outline
//!    └──────┴───────┘     ‾‾‾‾‾‾‾‾
//! ```

use std::f64::consts::FRAC_PI_4;

/// Uniform in [0, 1): the finalizer of MurmurHash3 over seed, point and axis.
fn uniform(seed: u32, point: u32, axis: u32) -> f64 {
    let mut h = (seed.wrapping_mul(0x9e37_79b9) ^ (2 * point + axis)).wrapping_mul(0xcc9e_2d51);
    h = (h ^ (h >> 16)).wrapping_mul(0x85eb_ca6b);
    h = (h ^ (h >> 13)).wrapping_mul(0xc2b2_ae35);
    f64::from(h ^ (h >> 16)) / 2f64.powi(32)
}

/// A cell of the light: its place among all cells, and its point's place in it.
struct Cell {
    /// The number of points before the first cell of the row, and before that of the next row.
    row: [u32; 2],
    /// The point's number among all.
    point: u32,
    /// The point's place in the cell, as shares of the area: across the row, and along it.
    at: [f64; 2],
}

/// The n cells of a light, row by row, in the given number of rows, at most n.
fn cells(n: u32, rows: f64, seed: u32) -> impl Iterator<Item = Cell> {
    let rows = rows.round().clamp(1.0, f64::from(n.max(1))) as u32;
    let start = move |row: u32| (u64::from(row) * u64::from(n) / u64::from(rows)) as u32;
    (0..rows).map(move |row| [start(row), start(row + 1)]).flat_map(move |row| {
        (row[0]..row[1]).map(move |point| Cell {
            row,
            point,
            at: [0, 1].map(|axis| if seed == 0 { 0.5 } else { uniform(seed, point, axis) }),
        })
    })
}

/// The places of n points, one in each of n cells of equal area, on a light with these half-extents; metres from its
/// centre. The number of rows makes the cells as square as they can be.
pub fn places(half: [f64; 2], n: u32, seed: u32) -> Vec<[f64; 2]> {
    let rows = (f64::from(n) * half[1] / half[0]).sqrt();
    cells(n, rows, seed)
        .map(|Cell { row: [first, end], point, at: [x, y] }| {
            let cells = f64::from(end - first);
            let across = (f64::from(point - first) + x) / cells;
            let down = (f64::from(first) + cells * y) / f64::from(n);
            [(2.0 * across - 1.0) * half[0], (2.0 * down - 1.0) * half[1]]
        })
        .collect()
}

/// The places of n points, one in each of n parts of equal area, on a disc of this radius; metres from its centre. They
/// are those of [`places`] on the square around it, moved by the map that keeps areas and brings the square's rim to
/// the disc's (Shirley and Chiu 1997).
pub fn places_on_disc(radius: f64, n: u32, seed: u32) -> Vec<[f64; 2]> {
    let onto_disc = |[x, y]: [f64; 2]| {
        // The square's quarter that the point lies in, by the axis that it is furthest along.
        let (far, near) = if x.abs() > y.abs() { (x, y) } else { (y, x) };
        let angle = if far == 0.0 { 0.0 } else { FRAC_PI_4 * near / far };
        let (across, along) = (far * angle.sin(), far * angle.cos());
        if x.abs() > y.abs() { [along, across] } else { [across, along] }
    };
    places([radius; 2], n, seed).into_iter().map(onto_disc).collect()
}

/// The places of n points on a light with this outline: a simple polygon, counter-clockwise, x and y in metres from the
/// light's centre. A rectangle's outline gives the places of [`places`], up to rounding.
///
/// In a polygon that is not convex a row may have several parts, and a cell may lie in two of them.
pub fn places_within(outline: &[[f64; 2]], n: u32, seed: u32) -> Vec<[f64; 2]> {
    let swapped: Vec<[f64; 2]> = outline.iter().rev().map(|&[x, y]| [y, x]).collect();
    let up = Profile::new(&swapped);
    let (area, [low, high]) = (up.area(), up.reach());
    let rows = ((high - low) * (f64::from(n) / area).sqrt()).max(1.0);
    // All cells of a row share its strip of the polygon.
    let mut strip: Option<([u32; 2], [f64; 2], Profile)> = None;
    cells(n, rows, seed)
        .map(|Cell { row, point, at: [x, y] }| {
            let (_, [bottom, top], profile) = match strip.take().filter(|s| s.0 == row) {
                Some(same) => strip.insert(same),
                None => {
                    let height = |points: u32| up.at(f64::from(points) / f64::from(n));
                    let ends = row.map(height);
                    let part = below(&below(&swapped, ends[1], 1.0), ends[0], -1.0);
                    let part: Vec<_> = part.iter().rev().map(|&[y, x]| [x, y]).collect();
                    strip.insert((row, ends, Profile::new(&part)))
                }
            };
            let x = profile.at((f64::from(point - row[0]) + x) / f64::from(row[1] - row[0]));
            [x, on_section(outline, x, [*bottom, *top], y)]
        })
        .collect()
}

/// The last place within a slab of width 1; at its very end a polygon may be over.
const INNER: f64 = 1.0 - 1e-12;

/// The area of a polygon to the left of an x: between the x of neighbouring corners the polygon's height is linear.
struct Profile {
    slabs: Vec<Slab>,
}

struct Slab {
    /// The least and largest x of the slab.
    x: [f64; 2],
    /// The polygon's height at both, all parts together.
    height: [f64; 2],
    /// The polygon's area to the left of the slab.
    before: f64,
}

impl Slab {
    fn area(&self) -> f64 {
        0.5 * (self.x[1] - self.x[0]) * (self.height[0] + self.height[1])
    }
}

impl Profile {
    /// The profile of a polygon that runs counter-clockwise; edges that lie on each other and run opposite ways cancel.
    fn new(polygon: &[[f64; 2]]) -> Self {
        let mut xs: Vec<f64> = polygon.iter().map(|p| p[0]).collect();
        xs.sort_by(f64::total_cmp);
        xs.dedup();
        let mut slabs: Vec<Slab> = Vec::with_capacity(xs.len());
        for ends in xs.windows(2).map(|x| [x[0], x[1]]) {
            let mut height = [0.0; 2];
            for [a, b] in edges(polygon) {
                let (left, right, sign) = if a[0] < b[0] { (a, b, -1.0) } else { (b, a, 1.0) };
                if left[0] <= ends[0] && ends[1] <= right[0] {
                    let y = ends.map(|x| on_edge(left, right, x));
                    height = [0, 1].map(|i| height[i] + sign * y[i]);
                }
            }
            let before = slabs.last().map_or(0.0, |last| last.before + last.area());
            // Rounding may make a height negative.
            slabs.push(Slab { x: ends, height: height.map(|h: f64| h.max(0.0)), before });
        }
        Self { slabs }
    }

    fn area(&self) -> f64 {
        self.slabs.last().map_or(0.0, |last| last.before + last.area())
    }

    /// The least and largest x of the polygon.
    fn reach(&self) -> [f64; 2] {
        match (self.slabs.first(), self.slabs.last()) {
            (Some(first), Some(last)) => [first.x[0], last.x[1]],
            _ => [0.0; 2],
        }
    }

    /// The x that has a given share of the area to its left.
    fn at(&self, share: f64) -> f64 {
        if share >= 1.0 {
            return self.reach()[1];
        }
        let wanted = share * self.area();
        let after = self.slabs.partition_point(|slab| slab.before <= wanted);
        let Some(slab) = self.slabs.get(after.saturating_sub(1)) else { return 0.0 };
        let (width, [a, b]) = (slab.x[1] - slab.x[0], slab.height);
        // The area up to x + t · width is width · (a · t + (b − a) · t² / 2).
        let rest = (wanted - slab.before) / width;
        let root = (a * a + 2.0 * (b - a) * rest).max(0.0).sqrt();
        let t = if rest > 0.0 { 2.0 * rest / (a + root) } else { 0.0 };
        slab.x[0] + width * t.min(INNER)
    }
}

fn edges(polygon: &[[f64; 2]]) -> impl Iterator<Item = [[f64; 2]; 2]> + '_ {
    polygon.iter().zip(polygon.iter().cycle().skip(1)).map(|(&a, &b)| [a, b])
}

/// The y of an edge at an x; at the edge's ends it is exactly theirs.
fn on_edge(left: [f64; 2], right: [f64; 2], x: f64) -> f64 {
    if x == right[0] {
        return right[1];
    }
    left[1] + (right[1] - left[1]) * ((x - left[0]) / (right[0] - left[0]))
}

/// The part of a polygon with an x below a limit, or for a `side` of −1 above it (Sutherland and Hodgman 1974). The
/// parts of a polygon that is not convex are joined by edges along the limit, there and back.
fn below(polygon: &[[f64; 2]], limit: f64, side: f64) -> Vec<[f64; 2]> {
    let inside = |p: [f64; 2]| side * (limit - p[0]) >= 0.0;
    let mut kept = Vec::with_capacity(2 * polygon.len());
    for [a, b] in edges(polygon) {
        if inside(a) {
            kept.push(a);
        }
        if inside(a) != inside(b) {
            let (left, right) = if a[0] < b[0] { (a, b) } else { (b, a) };
            kept.push([limit, on_edge(left, right, limit)]);
        }
    }
    kept
}

/// The y below which a share of the polygon's section at an x lies, between two heights.
fn on_section(polygon: &[[f64; 2]], x: f64, [bottom, top]: [f64; 2], share: f64) -> f64 {
    let mut crossed: Vec<f64> = edges(polygon)
        .map(|[a, b]| if a[0] < b[0] { [a, b] } else { [b, a] })
        // Half-open, so that a corner counts once.
        .filter(|[left, right]| left[0] <= x && x < right[0])
        .map(|[left, right]| on_edge(left, right, x).clamp(bottom, top))
        .collect();
    crossed.sort_by(f64::total_cmp);
    let parts = || crossed.chunks_exact(2).map(|part| [part[0], part[1]]);
    let mut rest = share * parts().map(|[low, high]| high - low).sum::<f64>();
    let mut y = bottom;
    for [low, high] in parts() {
        // The end of one part is as good as the start of the next, but for parts of nothing.
        if high > low {
            y = low + rest.clamp(0.0, high - low);
        }
        if rest < high - low {
            break;
        }
        rest -= high - low;
    }
    y
}

#[cfg(test)]
#[path = "places_tests.rs"]
mod tests;
