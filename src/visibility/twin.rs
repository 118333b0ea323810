//! The CPU twins of `glsl/common/receiver.glsl` and of the part of the light above a plane.

use num_traits::Float;

/// The fraction of the square [−1, 1]² where slope·(p, q) > c: the part of a light above a plane,
/// with `slope` the plane's normal times the light's half-extents.
pub fn fraction_above<T: Float>(slope: [T; 2], c: T) -> T {
    let two = T::one() + T::one();
    let m = slope[0].abs().max(slope[1].abs());
    let l = slope[0].abs().min(slope[1].abs());
    if c >= m + l {
        return T::zero();
    }
    if c <= -(m + l) {
        return T::one();
    }
    if c.abs() <= m - l {
        return T::one() / two - c / (two * m);
    }
    let leg = m + l - c.abs();
    let corner = leg * leg / (two * two * two * m * l);
    if c > T::zero() { corner } else { T::one() - corner }
}

/// A pixel with a depth to a homogeneous point of light space; the matrix is given by columns.
pub fn unproject<T: Float>(
    light_from_ndc: &[T],
    pixel: [T; 2],
    extent: [T; 2],
    depth: T,
) -> [T; 4] {
    let two = T::one() + T::one();
    let half = T::one() / two;
    let ndc = [0, 1].map(|i| (pixel[i] + half) * two / extent[i] - T::one());
    let p = [ndc[0], ndc[1], depth, T::one()];
    [0, 1, 2, 3].map(|row| {
        (0..4).fold(T::zero(), |sum, column| sum + light_from_ndc[column * 4 + row] * p[column])
    })
}

/// A homogeneous point as a point.
pub fn dehomogenize<T: Float>(p: [T; 4]) -> [T; 3] {
    [0, 1, 2].map(|i| p[i] / p[3])
}

/// The direction from `p` to the viewer: the eye is the image of clip space's (0, 0, 1, 0), a point
/// for a perspective camera and a direction for an orthographic one.
pub fn towards_viewer<T: Float>(light_from_ndc: &[T], p: [T; 3], background: T) -> [T; 3] {
    let eye = &light_from_ndc[8..12];
    if eye[3] != T::zero() {
        [0, 1, 2].map(|i| eye[i] / eye[3] - p[i])
    } else {
        let sign = if background == T::zero() { T::one() } else { -T::one() };
        [0, 1, 2].map(|i| sign * eye[i])
    }
}

/// The unit normal of the plane along two steps, on the side that `to_viewer` points to.
pub fn plane_normal<T: Float>(x: [T; 3], y: [T; 3], to_viewer: [T; 3]) -> [T; 3] {
    let size = |v: [T; 3]| v.iter().fold(T::min_positive_value(), |most, c| most.max(c.abs()));
    let [x, y] = [x, y].map(|v| v.map(|c| c / size(v)));
    let n = [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]];
    let dot = |a: [T; 3], b: [T; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let length = dot(n, n).sqrt();
    let sign = if dot(n, to_viewer) < T::zero() { -T::one() } else { T::one() };
    n.map(|c| if length > T::zero() { sign * c / length } else { T::zero() })
}

/// Where some receivers lie: least and largest t and w, as in `visibility/tile.glsl`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds<T> {
    /// Least t.
    pub t_min: [T; 2],
    /// Largest t.
    pub t_max: [T; 2],
    /// Least and largest w.
    pub w: [T; 2],
}

/// Bounds that hold whatever rounding another shader has: 2⁻²⁰ of t and w, and 2⁻¹⁰ of a texel more.
pub fn rounded_tile<T: Float>(tile: &Bounds<T>) -> Bounds<T> {
    let power = |n: i32| (T::one() + T::one()).powi(n);
    let slack =
        [0, 1].map(|i| tile.t_min[i].abs().max(tile.t_max[i].abs()) * power(-20) + power(-10));
    Bounds {
        t_min: [0, 1].map(|i| tile.t_min[i] - slack[i]),
        t_max: [0, 1].map(|i| tile.t_max[i] + slack[i]),
        w: [tile.w[0] * (T::one() - power(-20)), tile.w[1] * (T::one() + power(-20))],
    }
}

/// The first pixel of a listed tile, and whether an occluder may be felt there.
pub fn listed_tile(word: u32) -> ([u32; 2], bool) {
    let tile = [word & 0x7fff, word >> 15 & 0x7fff];
    (tile.map(|i| i * super::tiles::TILE), word & 1 << 30 != 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_part_above_a_plane_agrees_with_counting() {
        let n = 400;
        for (slope, c) in [
            ([1.0, 0.0], 0.3),
            ([0.7, -0.2], 0.1),
            ([0.7, -0.2], 0.6),
            ([-0.5, 0.5], -0.4),
            ([0.3, 1e-9], 0.1),
            ([0.0, 0.0], 0.1),
            ([0.0, 0.0], -0.1),
        ] {
            let at = |i: usize| (i as f64 + 0.5) * 2.0 / n as f64 - 1.0;
            let above =
                (0..n * n).filter(|i| slope[0] * at(i % n) + slope[1] * at(i / n) > c).count();
            let counted = above as f64 / (n * n) as f64;
            let exact = fraction_above::<f64>(slope, c);
            assert!((exact - counted).abs() < 3.0 / n as f64, "{slope:?} {c}: {exact} {counted}");
        }
    }
}
