//! The CPU twins of `glsl/linear_light/skin.glsl`, in any float type.

use num_traits::Float;

/// Whether an occluder ends between two texels that lie side by side, by their w and those of the ones before and
/// behind them.
pub fn is_edge<T: Float>([before, near, seen, behind]: [T; 4]) -> bool {
    let rounding = T::from(1.0e-6).unwrap_or_else(T::epsilon);
    let falls = |a: T, b: T| (a - b).max(T::zero());
    let least = falls(before, near).min(falls(seen, behind));
    near - seen > least + least + rounding * near
}

/// The w where a ray is at `u`: at `ray` for w = 0, and moving by `step` with w.
pub fn crossing_of<T: Float>(ray: T, u: T, step: T) -> T {
    (u - ray) / step
}

/// What a point behind a skin sees of the light between two samples (eq. 1).
pub fn transition<T: Float>(w_edge: T, w_crossing: T, w_receiver: T) -> T {
    if w_edge > w_receiver {
        ((w_edge - w_crossing) / (w_edge - w_receiver)).max(T::zero()).min(T::one())
    } else {
        T::one()
    }
}
