//! The CPU twins of `glsl/linear_light`, in any float type.

use num_traits::Float;

/// Whether an occluder ends between two neighbouring texels, by the w of the texel before them, their own, and the w of
/// the texel behind them.
pub fn is_edge<T: Float>([before, near, seen, behind]: [T; 4]) -> bool {
    let rounding = T::from(1.0e-6).unwrap_or_else(T::epsilon);
    let falls = |a: T, b: T| (a - b).max(T::zero());
    let least = falls(before, near).min(falls(seen, behind));
    let more = T::from(1.2f32).unwrap_or_else(T::one);
    near - seen > more * least + rounding * near
}

/// The w at which a ray crosses `u`: the ray is at `ray` for w = 0 and moves by `step` with w.
pub fn crossing_of<T: Float>(ray: T, u: T, step: T) -> T {
    (u - ray) / step
}

/// The part of the light between two samples that a point behind a skin sees, 0 to 1 (eq. 1).
pub fn transition<T: Float>(w_edge: T, w_crossing: T, w_receiver: T) -> T {
    if w_edge > w_receiver {
        ((w_edge - w_crossing) / (w_edge - w_receiver)).max(T::zero()).min(T::one())
    } else {
        T::one()
    }
}

/// A mask of the bits from `low` to `high`, both included, `low` of 0 to 31 and `high` of −1 to 31.
pub fn bits(low: i32, high: i32) -> u32 {
    if low > high { 0 } else { (u32::MAX >> (31 - high)) & (u32::MAX << low) }
}

/// The bits whose middles lie between two places along a line, from 0 to 1.
pub fn between<T: Float>(a: T, b: T) -> u32 {
    (0..32)
        .filter(|&bit| {
            let middle = (T::from(bit).unwrap_or_else(T::nan)
                + T::from(0.5).unwrap_or_else(T::nan))
                / T::from(32).unwrap_or_else(T::nan);
            a.min(b) <= middle && middle <= a.max(b)
        })
        .fold(0, |mask, bit| mask | 1 << bit)
}

/// The run of bits around one; none where it is 0.
pub fn run_at(mask: u32, at: i32) -> u32 {
    let set = |bit: i32| (0..32).contains(&bit) && mask >> bit & 1 == 1;
    if !set(at) {
        return 0;
    }
    let low = (0..=at).rev().take_while(|&bit| set(bit)).last().unwrap_or(at);
    let high = (at..32).take_while(|&bit| set(bit)).last().unwrap_or(at);
    bits(low, high)
}

/// The part of a segment that a receiver sees, from `[part by skins, weight without a skin]` of its first and of its
/// last sample, and how far either sees the receiver (`glsl/linear_light/line.glsl`).
pub fn part_of_segment<T: Float>(first: [T; 2], last: [T; 2], see: [T; 2]) -> T {
    let half = T::from(0.5).unwrap_or_else(T::nan);
    let clear = |none: T, other: T| none * (T::one() - half * other);
    (first[0] + last[0] + clear(first[1], see[1]) + clear(last[1], see[0])).min(T::one())
}
