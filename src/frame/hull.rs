//! The region between a light and its receivers: occluders outside it shadow nothing.

use crate::stages::depth_layers::LightBox;
use glam::DVec3;

/// The error that a box's coordinates may have, as a share of the distances.
const SLACK: f64 = 1e-9;

/// A convex region around every segment from a light to a receiver, in light space.
///
/// ```text
///        light              in x and in y: the region between a line from the light's left end past the
///       ───────             receivers' left side and one on the right, between the outermost of both, and
///      /       \            before the furthest receiver
///     |         |
///     |_________|           left: x ≥ −a + s z, with the largest s for which that holds of every receiver
///      receivers
/// ```
#[derive(Clone, Copy, Debug)]
pub(super) struct Hull {
    half: [f64; 2],
    /// How far the left and the right side move outwards for each metre from the light's plane, in x and in y; `None`
    /// where receivers touch that plane and no slope contains them.
    slopes: Option<[[f64; 2]; 2]>,
    /// The least and largest coordinate of light and receivers, in x and in y, metres.
    sides: [[f64; 2]; 2],
    far: f64,
}

impl Hull {
    /// The region around a light of half-extents `half` and the boxes of its receivers; `None` where no receiver lies
    /// in front of the light. What of a receiver is further from the light's centre than `reach`, in metres, is cut
    /// off.
    pub fn new(half: [f64; 2], receivers: &[LightBox], reach: Option<f64>) -> Option<Self> {
        let reach = DVec3::splat(reach.unwrap_or(f64::INFINITY));
        let least = receivers.iter().fold(DVec3::INFINITY, |m, b| m.min(b.min)).max(-reach);
        let most = receivers.iter().fold(DVec3::NEG_INFINITY, |m, b| m.max(b.max)).min(reach);
        if most.z.is_nan() || most.z <= 0.0 {
            return None;
        }
        let near = least.z;
        let slope = |aside: f64| if aside >= 0.0 { aside / near } else { aside / most.z };
        let slopes = [0, 1].map(|i| [-slope(-(least[i] + half[i])), slope(most[i] - half[i])]);
        let sides = [0, 1].map(|i| [least[i].min(-half[i]), most[i].max(half[i])]);
        Some(Self { half, slopes: (near > 0.0).then_some(slopes), sides, far: most.z })
    }

    /// Whether a box may overlap the region.
    pub fn meets(&self, of: &LightBox) -> bool {
        let slack = SLACK * (of.min.abs().max(of.max.abs()).max_element() + self.far);
        if of.max.z <= 0.0 || of.min.z > self.far + slack {
            return false;
        }
        let (near, far) = (of.min.z.max(0.0), of.max.z.min(self.far));
        (0..2).all(|i| {
            let [mut left, mut right] = self.sides[i];
            if let Some(slopes) = self.slopes {
                let furthest = |slope: f64| (slope * near).max(slope * far);
                left = left.max(-self.half[i] - furthest(-slopes[i][0]));
                right = right.min(self.half[i] + furthest(slopes[i][1]));
            }
            of.max[i] >= left - slack && of.min[i] <= right + slack
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DMat4;

    fn cube(x: f64, z: f64, half: f32) -> LightBox {
        let at = DMat4::from_translation(DVec3::new(x, 0.0, z));
        LightBox::new(&[[-half; 3], [half; 3]], &at)
    }

    #[test]
    fn only_what_lies_between_is_met() {
        // From ±1 at 0 to ±0.5 at 9.5 and beyond: the left side leans inwards.
        let hull = Hull::new([1.0, 1.0], &[cube(0.0, 10.0, 0.5)], None).unwrap();
        assert!(hull.meets(&cube(0.0, 5.0, 0.1)) && hull.meets(&cube(0.8, 5.0, 0.1)));
        assert!(!hull.meets(&cube(1.2, 5.0, 0.1)) && !hull.meets(&cube(-1.2, 5.0, 0.1)));
        assert!(!hull.meets(&cube(0.0, -1.0, 0.5)), "behind the light");
        assert!(!hull.meets(&cube(0.0, 11.0, 0.1)), "beyond");
        // A receiver to the side: from ±1 to 19 … 21.
        let hull = Hull::new([1.0, 1.0], &[cube(20.0, 10.0, 1.0)], None).unwrap();
        assert!(hull.meets(&cube(10.0, 5.0, 0.1)) && !hull.meets(&cube(-2.0, 5.0, 0.1)));
        assert!(!hull.meets(&cube(14.0, 5.0, 0.1)));
        // Receivers out of the light's reach need no shadow.
        let ground = cube(0.0, 60.0, 50.0);
        let hull = Hull::new([1.0, 1.0], &[ground], Some(12.0)).unwrap();
        assert!(!hull.meets(&cube(0.0, 14.0, 0.5)));
        assert!(Hull::new([1.0, 1.0], &[ground], Some(12.0)).is_some());
        assert!(Hull::new([1.0, 1.0], &[cube(0.0, -5.0, 1.0)], None).is_none());
        assert!(Hull::new([1.0, 1.0], &[], None).is_none());
    }

    #[test]
    fn receivers_at_the_lights_plane_have_no_slope() {
        let hull = Hull::new([1.0, 0.0], &[cube(0.0, 4.0, 4.0)], None).unwrap();
        assert!(hull.meets(&cube(-3.0, 1.0, 0.1)) && !hull.meets(&cube(-5.0, 1.0, 0.1)));
    }

    /// The region contains every point of each segment from the light to a receiver.
    #[test]
    fn no_segment_leaves_it() {
        let mut state = 1u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 33) as f64 / f64::from(1u32 << 31) * 2.0 - 1.0
        };
        for _ in 0..2000 {
            let half = [1.0 + random(), 1.0 + random()];
            let receivers = [(); 2].map(|()| cube(8.0 * random(), 3.0 + 4.0 * random(), 0.5));
            let Some(hull) = Hull::new(half, &receivers, None) else { continue };
            let corner = receivers[0].corners[(3.9 * (1.0 + random())) as usize];
            let from = DVec3::new(half[0] * random(), half[1] * random(), 0.0);
            let point = from.lerp(corner, 0.5 * (1.0 + random()));
            let dot = LightBox::new(&[[0.0; 3]; 2], &DMat4::from_translation(point));
            assert!(point.z <= 0.0 || hull.meets(&dot), "{half:?} {receivers:?} {point}");
        }
    }
}
