//! The CPU twins of `glsl/ray_march/`, in any float type, and a search that shares no code with the shader's.

use num_traits::Float;

/// A column: (top, bottom, second top, second bottom); see `column.glsl`.
pub type Column<T> = [T; 4];

/// A number far below any height.
fn far_off<T: Float>() -> T {
    T::from(3.0e38).unwrap_or_else(T::max_value)
}

/// The bounds of a window of one column, each combined as a maximum: highest top, minus the lowest bottom, minus the
/// lowest first top, highest first bottom.
pub fn bounds_of<T: Float>(column: Column<T>) -> [T; 4] {
    let [top, bottom, second_top, second_bottom] = column;
    if top <= T::zero() {
        return [T::zero(), -far_off::<T>(), T::zero(), far_off()];
    }
    [top, -if second_top > T::zero() { second_bottom } else { bottom }, -top, bottom]
}

/// How far a surface goes down from a texel at height `h` towards a neighbour.
pub fn step_down<T: Float>(h: T, neighbour: T, behind_it: T, opposite: T) -> T {
    let drop = h - neighbour;
    let none = T::infinity();
    let before = if opposite > h { opposite - h } else { none };
    let goes_down = behind_it > T::zero() && behind_it <= neighbour;
    let behind = if goes_down { neighbour - behind_it } else { none };
    let slope = if before.min(behind) < none { before.min(behind) } else { T::zero() };
    let goes_on = neighbour > T::zero() && drop <= slope + slope;
    if goes_on { drop.max(T::zero()) } else { T::zero() }
}

/// The rest of a piece of matter, (top, bottom), whose surfaces go so far up or down within half a texel.
pub fn beveled<T: Float>([top, bottom]: [T; 2], above: T, below: T) -> [T; 2] {
    let most = ((top - bottom) / (T::one() + T::one())).max(T::zero());
    [top - above.min(most), bottom + below.min(most)]
}

/// The column of a solid between its nearest and its furthest back faces; 0 where it has none.
pub fn one_interval<T: Float>(top: T, far_back: T) -> Column<T> {
    let bottom = if far_back > T::zero() { far_back.min(top) } else { top };
    [top, bottom, T::zero(), T::zero()]
}

/// The column of the matter between nearest faces, nearest back, furthest front and furthest back faces, each 0 where
/// there are none.
pub fn two_intervals<T: Float>(top: T, near_back: T, far_front: T, far_back: T) -> Column<T> {
    let bottom = if near_back > T::zero() { near_back } else { top };
    if far_front <= T::zero() || far_front >= bottom {
        return one_interval(top, far_back);
    }
    let second = if far_back > T::zero() { far_back.min(far_front) } else { far_front };
    [top, bottom, far_front, second]
}

/// The hash MD5 reduced to 16 rounds (Curtis 2009, appendix A), with its rounds, words and constants in a table.
pub fn md5(message: [u32; 4], key: u32) -> [u32; 4] {
    /// The words that the rounds read: those beyond the message are 0.
    const WORDS: [usize; 16] = [0, 1, 2, 3, 1, 6, 11, 0, 5, 8, 11, 14, 0, 7, 14, 5];
    const TURNS: [[u32; 4]; 4] =
        [[7, 12, 17, 22], [5, 9, 14, 20], [4, 11, 16, 23], [6, 10, 15, 21]];
    const CONSTANTS: [u32; 16] = [
        0xd76a_a478,
        0xe8c7_b757,
        0x2420_70db,
        0xc1bd_ceef,
        0xf61e_2562,
        0xc040_b341,
        0x265e_5a52,
        0xe9b6_c7ab,
        0xfffa_3942,
        0x8771_f681,
        0x6d9d_6122,
        0xfde5_380c,
        0xf429_2244,
        0x432a_ff98,
        0xab94_23a7,
        0xfc93_a039,
    ];
    let word = |i: usize| message.get(i).map_or(0, |w| w ^ key);
    let mut digest: [u32; 4] = [0x0123_4567, 0x89ab_cdef, 0xfedc_ba98, 0x7654_3210];
    let mut t = digest;
    for round in 0..16 {
        let [a, b, c, _] = t;
        let chosen = match round / 4 {
            0 => (a & b) | (!a & c),
            1 => (c & a) | (!c & b),
            2 => a ^ b ^ c,
            _ => b ^ (a | !c),
        };
        let sum =
            a.wrapping_add(chosen).wrapping_add(word(WORDS[round])).wrapping_add(CONSTANTS[round]);
        let turned = b.wrapping_add(sum.rotate_left(TURNS[round / 4][round % 4]));
        t = [b, c, t[3], turned];
        for (d, x) in digest.iter_mut().zip(t) {
            *d = u32::wrapping_add(*d, x);
        }
    }
    digest
}

/// Hashes four words to four (Jarzynski and Olano 2020, pcg4d).
pub fn pcg(words: [u32; 4]) -> [u32; 4] {
    let mut v = words.map(|x| x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    let mix = |v: &mut [u32; 4]| {
        for (to, a, b) in [(0, 1, 3), (1, 2, 0), (2, 0, 1), (3, 1, 2)] {
            v[to] = v[to].wrapping_add(v[a].wrapping_mul(v[b]));
        }
    };
    mix(&mut v);
    v = v.map(|x| x ^ (x >> 16));
    mix(&mut v);
    v
}

/// The first two dimensions of Sobol's sequence, as fractions of 2³²: the second by its direction numbers,
/// v₁ = 2³¹, vₖ = vₖ₋₁ ⊕ vₖ₋₁/2 (Bratley and Fox 1988).
pub fn sobol(n: u32) -> [u32; 2] {
    let mut direction = 1u32 << 31;
    let mut y = 0;
    for bit in 0..32 {
        if n >> bit & 1 == 1 {
            y ^= direction;
        }
        direction ^= direction >> 1;
    }
    [n.reverse_bits(), y]
}

/// The nth of `count` cells that divide [0, 1]² into equal areas in the given number of rows: corner and size.
pub fn cell_of<T: Float>(n: u32, count: u32, rows: u32) -> [T; 4] {
    let number = |x: u32| T::from(x).unwrap_or_else(T::nan);
    let start = |row: u32| row * count / rows;
    let row = (0..rows).rfind(|&row| start(row) <= n).unwrap_or(0);
    let (first, end) = (start(row), start(row + 1));
    let across = T::one() / number(end - first);
    [
        number(n - first) * across,
        number(first) / number(count),
        across,
        number(end - first) / number(count),
    ]
}

/// The standard deviation of the noise filter's Gaussian, metres; see `noise.glsl`.
pub fn filter_width<T: Float>(penumbra: T, pixel: T, noise: T) -> T {
    let number = |x: f64| T::from(x).unwrap_or_else(T::nan);
    let w = penumbra / pixel;
    let a = (noise * w * w / number(7.09)).powf(number(1.0 / 3.0));
    if a < number(0.4) { T::zero() } else { a.min(number(6.0)) * pixel }
}

/// A neighbour's weight in the noise filter; see `noise.glsl`.
pub fn filter_weight<T: Float>(apart: [T; 3], normal: [T; 3], its: [T; 3], width: T) -> T {
    let number = |x: f64| T::from(x).unwrap_or_else(T::nan);
    let dot = |a: [T; 3], b: [T; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let off = dot(apart, normal);
    let squares = dot(apart, apart) + number(15.0) * off * off;
    let turned = dot(normal, its).max(T::zero());
    (-squares / (width * width + width * width)).exp() * turned.powi(16)
}

/// A receiver in the map and its plane; see `column.glsl`.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// The place in the map, texels.
    pub t: [f64; 2],
    /// The height.
    pub w: f64,
    /// The plane's normal over texels; see `light_space.glsl`.
    pub n: [f64; 2],
    /// The plane's offset; see `light_space.glsl`.
    pub n_0: f64,
    /// The plane's factor of the height; see `light_space.glsl`.
    pub c: f64,
    /// A column stops rays where its top is at least this high above the plane.
    pub margin: f64,
}

/// Whether a ray from a receiver meets a column of a map of `side` texels, or the piece of matter between a column's two
/// (top and bottom, 0 where there is none), by visiting every texel under it: `g` texels a unit of height, from `start` to
/// `end` above the receiver. The second value is the relative distance of
/// heights from the opposite answer: below 1e-5 the answer depends on rounding.
pub fn meets(
    (columns, between): (&[Column<f64>], &[[f64; 2]]),
    side: u32,
    place: &Place,
    g: [f64; 2],
    start: f64,
    end: f64,
) -> (bool, f64) {
    // The heights at which the ray goes from texel to texel.
    let mut borders = vec![start, end];
    for (t, g) in place.t.into_iter().zip(g).filter(|(_, g)| *g != 0.0) {
        let at = (0..=side).map(|b| (f64::from(b) - t) / g);
        borders.extend(at.filter(|s| *s > start && *s < end));
    }
    borders.sort_by(f64::total_cmp);
    let mut nearest = f64::INFINITY;
    let mut met = false;
    for pair in borders.windows(2) {
        let middle = 0.5 * (pair[0] + pair[1]);
        let over = [0, 1].map(|i| (place.t[i] + middle * g[i]).floor());
        if over.iter().any(|x| *x < 0.0 || *x >= f64::from(side)) {
            continue;
        }
        let texel = (over[1] * f64::from(side) + over[0]) as usize;
        let [first, end, second, last] = columns[texel];
        for [top, bottom] in [[first, end], between[texel], [second, last]] {
            if top <= 0.0 {
                continue;
            }
            let above = (over[0] + 0.5) * place.n[0] + (over[1] + 0.5) * place.n[1] + place.n_0
                - place.c * top
                - place.margin;
            let (lo, hi) = (place.w + pair[0], place.w + pair[1]);
            // The overlap of ray and matter, positive where they meet.
            let overlap = ((top - lo).min(hi - bottom)) / top;
            let holds = overlap.min(above / (place.c.abs() * top + place.margin));
            met |= holds >= 0.0;
            nearest = nearest.min(holds.abs());
        }
    }
    (met, nearest)
}
