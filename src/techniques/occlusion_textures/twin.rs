//! The CPU twins of `glsl/occlusion_textures/`, in any float type, and the published formulas in f64, by a method that
//! shares nothing with the device's: texels are visited one by one.

use super::settings::Combine;
use crate::RectangleLight;
use crate::stages::depth_layers::{Eye, MapView};
use glam::{DVec2, DVec3};
use num_traits::Float;

/// The number of bins of distances (`slices.glsl`).
pub const BINS: i32 = 960;

/// The bin of a depth that a projection from behind the light stores.
pub fn bin_of<T: Float>(stored: T, near: T, span: T) -> i32 {
    let bins = T::from(BINS).unwrap_or_else(T::one);
    let t = (near / stored - near) / span * bins;
    t.to_i32().unwrap_or(i32::MAX).clamp(0, BINS - 1)
}

/// The rectangle of texels, least x and y, largest x and y, that the light's rays to `position` fill in the
/// plane at distance `plane` (eq. 4).
pub fn kernel_of<T: Float>(
    [per_x, per_y, first_x, first_y, eye]: [T; 5],
    [x, y, z]: [T; 3],
    plane: T,
    half_light: [T; 2],
) -> [T; 4] {
    let half = T::one() / (T::one() + T::one());
    let share = plane / z;
    let away = (T::one() - share).max(T::zero());
    let axis = |at: T, per: T, first: T, light: T| {
        let per_metre = per / (plane + eye);
        let centre = at * share * per_metre + first;
        let reach = (light * away * per_metre).max(half);
        (centre - reach, centre + reach)
    };
    let (x0, x1) = axis(x, per_x, first_x, half_light[0]);
    let (y0, y1) = axis(y, per_y, first_y, half_light[1]);
    [x0, y0, x1, y1]
}

/// A rectangle that holds the kernels of a tile's points in a plane. `[least t, largest t]` are the points' places
/// seen from the light's centre, in texels from u = v = 0; the last argument is their least w (`slices.glsl`).
pub fn tile_kernel_of<T: Float>(
    [per_x, per_y, first_x, first_y, eye]: [T; 5],
    [min_x, min_y, max_x, max_y]: [T; 4],
    w_min: T,
    plane: T,
    half_light: [T; 2],
) -> [T; 4] {
    let power = |n: i32| (T::one() + T::one()).powi(n);
    let half = power(-1);
    let share = plane / (plane + eye);
    let axis = |min: T, max: T, per: T, first: T, light: T| {
        let widest = light * per / (plane + eye);
        let reach = (widest * (T::one() - plane * w_min).max(T::zero())).max(half);
        let reach = reach + (first.abs() + widest) * power(-20) + power(-10);
        (min * share + first - reach, max * share + first + reach)
    };
    let (x0, x1) = axis(min_x, max_x, per_x, first_x, half_light[0]);
    let (y0, y1) = axis(min_y, max_y, per_y, first_y, half_light[1]);
    [x0, y0, x1, y1]
}

/// The share of a slice that counts for a point at distance `z` (section 3.4).
pub fn slice_weight<T: Float>(z: T, upper: T, lower: T, blocks: bool) -> T {
    let begins = if blocks { lower } else { upper };
    ((z - begins) / (lower - upper)).max(T::zero()).min(T::one())
}

/// The hidden part of the light behind one more slice that hides `more` by itself, by the published combinations.
pub fn hidden_with<T: Float>(combine: Combine, hidden: T, more: T) -> T {
    match combine {
        Combine::Sum => (hidden + more).min(T::one()),
        Combine::Max => hidden.max(more),
        Combine::Product | Combine::Correlated => {
            T::one() - (T::one() - hidden) * (T::one() - more)
        }
    }
}

/// The hidden part of the light behind one more slice, by its overlap with the slices above it: the window holds its
/// share, theirs, and that of both; `before` is the share of the slice right above.
pub fn hidden_with_correlated<T: Float>(hidden: T, before: T, [own, covered, both]: [T; 3]) -> T {
    let few = T::from(1.0e-3).unwrap_or_else(T::epsilon);
    let (zero, one) = (T::zero(), T::one());
    // The shares that two sets can have in common, at most and at least.
    let most = |a: T, b: T| a.min(b);
    let least = |a: T, b: T| (a + b - one).max(zero);
    let independent = own * covered;
    let excess = both - independent;
    let nested = if own > zero { before.min(both) / own } else { zero };
    let common = if excess >= zero {
        let r = (excess + few * nested) / (most(own, covered) - independent + few);
        own * hidden + r * (most(own, hidden) - own * hidden)
    } else {
        let r = excess / (independent - least(own, covered) + few);
        own * hidden + r * (own * hidden - least(own, hidden))
    };
    (hidden + own - common).max(zero).min(one)
}

/// The slices that block a column, with a bit each: `faces` counts, slice by slice, the faces that look at the light
/// and those that look away from it.
pub fn solid_of(faces: &[(u32, u32)]) -> u32 {
    let mut depth = 0i64;
    let (mut there, mut inside) = (0u32, 0u32);
    for (slice, &(fronts, backs)) in faces.iter().enumerate() {
        if depth > 0 {
            inside |= 1 << slice;
        }
        depth += i64::from(fronts) - i64::from(backs);
        if fronts + backs > 0 {
            there |= 1 << slice;
        }
        if depth > 0 {
            inside |= 1 << slice;
        }
    }
    if depth == 0 { there | inside } else { there }
}

/// The numbers that a tile of a summed-area table holds for a texel: four slices; or a pair of them, and whether any
/// slice blocks above the pair, above its second, and above the slice that follows the pair.
pub fn tile_sums(mask: u32, tile: u32, correlated: bool) -> [u32; 5] {
    let blocks = |slice: u32| mask >> slice & 1 == 1;
    let bits = if correlated {
        let first = 2 * tile;
        let any_before = |slice: u32| (0..slice).any(blocks);
        [
            blocks(first),
            blocks(first + 1),
            any_before(first),
            any_before(first + 1),
            any_before(first + 2),
        ]
    } else {
        let [a, b, c, d] = [0, 1, 2, 3].map(|i| blocks(4 * tile + i));
        [a, b, c, d, false]
    };
    bits.map(u32::from)
}

/// The numbers that a tile of levels holds for a texel: four slices; or for one slice whether it blocks, whether any
/// slice above it does, and whether both do.
pub fn tile_means(mask: u32, tile: u32, correlated: bool) -> [u32; 4] {
    if !correlated {
        let [a, b, c, d, _] = tile_sums(mask, tile, false);
        return [a, b, c, d];
    }
    let own = mask >> tile & 1;
    let above = u32::from((0..tile).any(|slice| mask >> slice & 1 == 1));
    [own, above, own & above, 0]
}

/// A texel of a summed-area table: four sums of 25 bits, and a fifth sum in the bits that they leave.
pub fn packed([a, b, c, d, e]: [u32; 5]) -> [u32; 4] {
    let all = [a, b, c, d].iter().rev().fold(0u128, |all, &x| all << 32 | u128::from(x));
    let all = (0..4).fold(all, |all, i| all | u128::from(e >> (7 * i) & 127) << (32 * i + 25));
    [0, 1, 2, 3].map(|i| (all >> (32 * i)) as u32)
}

/// Occlusion textures as published: uniform slices, flattened to their lower planes.
pub struct Published {
    view: MapView,
    eye: f64,
    half_light: DVec2,
    slices: u32,
    /// Whether a slice blocks, texel by texel, slice by slice.
    textures: Vec<Vec<bool>>,
}

impl Published {
    /// Sorts triangles in light space into slices; with `fill` each goes into the next slice too.
    pub fn new(
        light: &RectangleLight,
        view: &MapView,
        slices: u32,
        fill: bool,
        triangles: &[[DVec3; 3]],
    ) -> Self {
        let eye = match view.eye {
            Eye::Behind(behind) => behind,
            Eye::Infinity => 0.0,
        };
        let texels = (view.side * view.side) as usize;
        let mut made = Self {
            view: *view,
            eye,
            half_light: DVec2::from_array(light.half_extents()),
            slices,
            textures: vec![vec![false; texels]; slices as usize],
        };
        triangles.iter().for_each(|t| made.add(t, fill));
        made
    }

    /// The distances of a slice's upper and lower plane from the light.
    fn planes(&self, slice: u32) -> (f64, f64) {
        let at = |k: u32| {
            let share = f64::from(k) / f64::from(self.slices);
            self.view.near - self.eye + share * (self.view.far - self.view.near)
        };
        (at(slice), at(slice + 1))
    }

    /// The place of a point in the map, in texels.
    fn texel_of(&self, p: DVec3) -> DVec2 {
        let (per, first) = (self.view.texels_per_uv(), self.view.first());
        DVec2::from_array([0, 1].map(|i| [p.x, p.y][i] / (p.z + self.eye) * per[i] + first[i]))
    }

    fn add(&mut self, triangle: &[DVec3; 3], fill: bool) {
        let corners = triangle.map(|p| self.texel_of(p));
        let [a, b, c] = corners;
        let area = (b - a).perp_dot(c - a);
        if area == 0.0 || !area.is_finite() {
            return;
        }
        let side = f64::from(self.view.side);
        let least = corners.iter().fold(a, |m, p| m.min(*p)).max(DVec2::ZERO).floor();
        let most = corners.iter().fold(a, |m, p| m.max(*p)).min(DVec2::splat(side)).ceil();
        for y in least.y as u32..most.y as u32 {
            for x in least.x as u32..most.x as u32 {
                let p = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
                let weights = [(c - b).perp_dot(p - b), (a - c).perp_dot(p - c)].map(|w| w / area);
                let weights = [weights[0], weights[1], 1.0 - weights[0] - weights[1]];
                if weights.iter().any(|w| *w < 0.0) {
                    continue;
                }
                // The map interpolates 1/distance linearly.
                let w: f64 = weights.iter().zip(triangle).map(|(w, p)| w / (p.z + self.eye)).sum();
                let depth = (1.0 / w - self.view.near) / (self.view.far - self.view.near);
                let slice = (depth * f64::from(self.slices)).floor();
                let slice = slice.clamp(0.0, f64::from(self.slices) - 1.0) as usize;
                let texel = (y * self.view.side + x) as usize;
                for texture in self.textures.iter_mut().skip(slice).take(if fill { 2 } else { 1 }) {
                    texture[texel] = true;
                }
            }
        }
    }

    /// The mean of a slice over a rectangle, summed texel by texel.
    fn mean(&self, slice: u32, lo: DVec2, hi: DVec2) -> f64 {
        let side = f64::from(self.view.side);
        let part = |i: f64, lo: f64, hi: f64| ((i + 1.0).min(hi) - i.max(lo)).max(0.0);
        let range = |lo: f64, hi: f64| lo.max(0.0) as u32..hi.min(side).ceil().max(0.0) as u32;
        let texture = &self.textures[slice as usize];
        let mut sum = 0.0;
        for y in range(lo.y, hi.y) {
            for x in range(lo.x, hi.x) {
                if texture[(y * self.view.side + x) as usize] {
                    sum += part(x.into(), lo.x, hi.x) * part(y.into(), lo.y, hi.y);
                }
            }
        }
        sum / ((hi.x - lo.x) * (hi.y - lo.y))
    }

    /// The visible fraction from a point of light space.
    pub fn visible(&self, p: DVec3, combine: Combine) -> f64 {
        let mut hidden = 0.0;
        for slice in 0..self.slices {
            let (upper, lower) = self.planes(slice);
            // The point's own slice does not count, and the one above it fades in (section 3.4).
            let weight = ((p.z - lower) / (lower - upper)).clamp(0.0, 1.0);
            if weight == 0.0 {
                continue;
            }
            // The rays from the light's rim cross the plane here.
            let crossing = |light: DVec2| {
                let q = p + (light.extend(0.0) - p) * ((p.z - lower) / p.z);
                self.texel_of(q)
            };
            let (a, b) = (crossing(-self.half_light), crossing(self.half_light));
            let (centre, half) = (0.5 * (a + b), (0.5 * (b - a)).max(DVec2::splat(0.5)));
            let own = self.mean(slice, centre - half, centre + half);
            hidden = hidden_with(combine, hidden, weight * own);
        }
        1.0 - hidden
    }
}
