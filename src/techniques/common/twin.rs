//! The CPU twins of `glsl/common`, in any float type.
//!
//! A twin computes what the shader does, line by line, and shares no code with it.

use num_traits::Float;

/// Clamps `x` to `low` and `high`.
pub(crate) fn clamp<T: Float>(x: T, low: T, high: T) -> T {
    x.max(low).min(high)
}

/// The number ½.
pub(crate) fn half<T: Float>() -> T {
    T::one() / (T::one() + T::one())
}

/// The magnification k = 1/(w_o − w_r), in metres: the length on the light's plane that a step of u at the occluder
/// covers.
pub fn magnification<T: Float>(w_o: T, w_r: T) -> T {
    T::one() / (w_o - w_r)
}

/// The length of the part of [a, b] within the light, which is [−½, ½].
pub fn overlap<T: Float>(a: T, b: T) -> T {
    let h = half::<T>();
    clamp(b, -h, h) - clamp(a, -h, h)
}

/// The fraction of the light that a micro-patch hides: texels `lo` to `hi` at `w_o`, seen from the
/// receiver at `t` and `w_r` (Atty 2006 section 3.4).
pub fn patch_occlusion<T: Float>(
    lo: [T; 2],
    hi: [T; 2],
    w_o: T,
    t: [T; 2],
    w_r: T,
    scale: [T; 2],
) -> T {
    if w_o <= w_r {
        return T::zero();
    }
    let k = magnification(w_o, w_r);
    let along = |i: usize| {
        let m = scale[i] * k;
        overlap((lo[i] - t[i]) * m, (hi[i] - t[i]) * m)
    };
    along(0) * along(1)
}

/// A receiver and its plane over the occluder map that it is compared with.
#[derive(Clone, Copy, Debug)]
pub struct MapPlane<T> {
    /// The receiver's place in light space, with the map's eye at the origin, metres.
    pub position: [T; 3],
    /// The plane's unit normal, on the side that light comes from.
    pub normal: [T; 3],
    /// Texels a unit of u and v.
    pub texels_per_uv: [T; 2],
    /// Texel coordinates of u = v = 0.
    pub first: [T; 2],
}

/// How far a texel's surface, `w_o` at its centre `at`, lies above a receiver's plane beyond the height that the
/// receiver's own surface may rise over `reach` in u and v; in units of 1/w, without rounding.
pub fn clearance<T: Float>(plane: &MapPlane<T>, at: [T; 2], w_o: T, reach: T) -> T {
    let MapPlane { position: p, normal: n, texels_per_uv, first } = plane;
    let half = T::one() / (T::one() + T::one());
    let uv = [0, 1].map(|i| (at[i] - first[i]) / texels_per_uv[i]);
    let texel = texels_per_uv.map(T::recip);
    let above =
        n[0] * uv[0] + n[1] * uv[1] + n[2] - (n[0] * p[0] + n[1] * p[1] + n[2] * p[2]) * w_o;
    let own_slope = T::from(0.3).unwrap_or_else(T::nan);
    above - own_slope * reach.max(half * texel[0].hypot(texel[1]))
}

/// The nodes of a map of `map` texels a side that hold texels from `lo` to `hi` (`nearest.glsl`): columns and rows,
/// first and last. The last lies before the first where there are none.
pub fn nodes_around(map: u32, lo: [f32; 2], hi: [f32; 2]) -> [[i32; 2]; 2] {
    let side = map.div_ceil(32).max(8);
    let end = (map.div_ceil(side) - 1) as f32;
    let node = |t: f32| (t / side as f32).floor();
    [
        lo.map(|t| node(t).max(0.0).min(end + 1.0) as i32),
        hi.map(|t| node(t).max(-1.0).min(end) as i32),
    ]
}

/// The fraction of the unit disc where slope · p is above c: a segment of it.
pub fn fraction_of_disc_above<T: Float>(slope: [T; 2], c: T) -> T {
    let steep = (slope[0] * slope[0] + slope[1] * slope[1]).sqrt();
    if c >= steep {
        return T::zero();
    }
    if c <= -steep {
        return T::one();
    }
    let d = c / steep;
    let pi = T::from(std::f64::consts::PI).unwrap_or_else(T::nan);
    (d.acos() - d * (T::one() - d * d).max(T::zero()).sqrt()) / pi
}

/// The area between an edge of a polygon and a line, of what of the edge lies above the line; see `noise.glsl`.
pub fn area_above<T: Float>(a: [T; 2], b: [T; 2]) -> T {
    let (high, low) = (a[1].max(b[1]), a[1].min(b[1]));
    let zero = T::zero();
    if high <= zero {
        return zero;
    }
    let share = if low >= zero { T::one() } else { high / (high - low) };
    (b[0] - a[0]) * share * (high + low.max(zero)) / (T::one() + T::one())
}

/// The point of a triangle for one of [0, 1]²; see `noise.glsl`.
pub fn in_triangle<T: Float>([a, b, c]: [[T; 2]; 3], s: [T; 2]) -> [T; 2] {
    let far = s[0].sqrt();
    [0, 1].map(|i| a[i] + far * (b[i] - a[i] + s[1] * (c[i] - b[i])))
}

/// The point of the unit disc for one of [−1, 1]²: equal areas go to equal areas (Shirley and Chiu 1997).
pub fn on_disc<T: Float>([x, y]: [T; 2]) -> [T; 2] {
    let (far, near) = if x.abs() > y.abs() { (x, y) } else { (y, x) };
    let quarter = T::from(std::f64::consts::FRAC_PI_4).unwrap_or_else(T::nan);
    let angle = if far == T::zero() { T::zero() } else { quarter * near / far };
    let p = [far * angle.cos(), far * angle.sin()];
    if x.abs() > y.abs() { p } else { [p[1], p[0]] }
}

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

/// Converts a pixel with a depth to a homogeneous point of light space; the matrix is given by columns.
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

/// Converts a homogeneous point to a point.
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

/// The unit normal of a plane of the image: `depth` at a pixel, and more by `steps` at the next one to the right and below.
/// The matrix, by columns, turns a plane (a, b, c, d) of column, row and depth, a row vector, into its normal.
pub fn normal_of_plane<T: Float>(
    plane_to_normal: &[T],
    pixel: [T; 2],
    depth: T,
    steps: [T; 2],
) -> [T; 3] {
    let at_origin = depth - steps[0] * pixel[0] - steps[1] * pixel[1];
    let plane = [steps[0], steps[1], -T::one(), at_origin];
    let n = [0, 1, 2].map(|column| {
        (0..4).fold(T::zero(), |sum, row| sum + plane[row] * plane_to_normal[column * 4 + row])
    });
    let length = (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt();
    n.map(|c| c / length)
}

/// The unit vector whose octahedral coordinates, from -1 to 1, these are.
pub fn unfolded<T: Float>(flat: [T; 2]) -> [T; 3] {
    let z = T::one() - flat[0].abs() - flat[1].abs();
    let over = |i: usize| {
        let away = T::one() - flat[1 - i].abs();
        if flat[i] < T::zero() { -away } else { away }
    };
    let n = if z < T::zero() { [over(0), over(1), z] } else { [flat[0], flat[1], z] };
    let length = (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt();
    n.map(|c| c / length)
}

/// The unit normal of the plane that two steps span, on the side that `to_viewer` points to.
pub fn plane_normal<T: Float>(x: [T; 3], y: [T; 3], to_viewer: [T; 3]) -> [T; 3] {
    let size = |v: [T; 3]| v.iter().fold(T::min_positive_value(), |most, c| most.max(c.abs()));
    let [x, y] = [x, y].map(|v| v.map(|c| c / size(v)));
    let n = [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]];
    let dot = |a: [T; 3], b: [T; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let length = dot(n, n).sqrt();
    let sign = if dot(n, to_viewer) < T::zero() { -T::one() } else { T::one() };
    n.map(|c| if length > T::zero() { sign * c / length } else { T::zero() })
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
