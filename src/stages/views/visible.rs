//! What a camera sees of a lamp's receivers, as the lamp sees it: how far aside its views need to show.

use crate::stages::depth_layers::{LightBox, Polygon, cut, each_face, outside_of, planes_around};
use glam::{DVec3, DVec4};

/// How many receivers are cut to what the camera sees of them. Of further ones the boxes count as they are.
const MOST_CUT: usize = 32;

/// How many steps a doubling of their width has for the windows' ends, so that texels stay where they are while the camera
/// moves a little.
const STEPS: f64 = 16.0;

/// The share of the whole window above which a part of it is not worth windows that move.
const ALMOST_ALL: f64 = 0.9;

/// The part of the receivers that a camera sees, in light space.
pub(crate) struct Visible<'a> {
    /// The corners of a slice of the camera's frustum, as of a box.
    pyramid: [DVec3; 8],
    receivers: &'a [LightBox],
}

impl<'a> Visible<'a> {
    /// The part of receivers that lies in a slice of a camera's frustum with these corners.
    pub fn new(pyramid: [DVec3; 8], receivers: &'a [LightBox]) -> Self {
        Self { pyramid, receivers }
    }

    /// The window that the visible receivers span, of those under `tangent` or less beyond the rim of a light of these
    /// half-extents; none where there are none.
    ///
    /// What a box, the frustum and the opening below a light have in common is convex, so that its corners span it, and
    /// each lies on a face that box and frustum have in common: the opening has no corner but the light's.
    pub fn within(&self, half: [f64; 2], tangent: f64) -> Option<Window> {
        let pyramid = planes_around(&self.pyramid);
        let none = Window { min: [f64::INFINITY; 2], max: [f64::NEG_INFINITY; 2] };
        let mut seen = Seen { half, tangent, planes: opening(half, tangent), window: none };
        let mut cut = 0;
        for of in self.receivers {
            if seen.is_whole() {
                break;
            }
            if of.max.z <= 0.0 || of.is_outside(&pyramid) {
                continue;
            }
            cut += 1;
            if cut > MOST_CUT {
                seen.window.add_around(half, of, tangent);
                continue;
            }
            let mut add = |face: &Polygon| seen.add(face);
            each_face(&of.corners, &pyramid, &mut add);
            // A flat box has no inner side, and is all in its faces.
            if of.thin_axis.is_none() {
                each_face(&self.pyramid, &planes_around(&of.corners), &mut add);
            }
        }
        seen.window.min[0].is_finite().then_some(seen.window)
    }
}

/// The window of what is seen under an opening.
struct Seen {
    half: [f64; 2],
    tangent: f64,
    planes: [DVec4; 4],
    window: Window,
}

impl Seen {
    /// Whether nothing can widen it.
    fn is_whole(&self) -> bool {
        let Self { tangent, window, .. } = self;
        (0..2).all(|i| window.min[i] <= -tangent && window.max[i] >= *tangent)
    }

    /// Widens the window to the part of a face that lies under the opening.
    fn add(&mut self, face: &Polygon) {
        if self.is_whole() {
            return;
        }
        let [all, any] = outside_of(&self.planes, face);
        if all != 0 {
            return;
        }
        let mut part = face.clone();
        for (i, plane) in self.planes.iter().enumerate() {
            if any >> i & 1 == 1 {
                part = cut(&part, plane);
            }
        }
        part.iter().for_each(|p| self.window.add(self.half, *p, self.tangent));
    }
}

/// The planes around the points under `tangent` or less beyond the rim of a light of these half-extents.
pub(super) fn opening([x, y]: [f64; 2], tangent: f64) -> [DVec4; 4] {
    [
        DVec4::new(1.0, 0.0, tangent, x),
        DVec4::new(0.0, 1.0, tangent, y),
        DVec4::new(-1.0, 0.0, tangent, x),
        DVec4::new(0.0, -1.0, tangent, y),
    ]
}

/// The points p before a light for which p.x and p.y lie beyond its rim by no less than `min` and no more than `max` for
/// each metre from the light's plane: tangents.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Window {
    pub min: [f64; 2],
    pub max: [f64; 2],
}

impl Window {
    /// The window of a tangent to all sides.
    pub fn around(tangent: f64) -> Self {
        Self { min: [-tangent; 2], max: [tangent; 2] }
    }

    /// Widens the window to a point, but by no more than `tangent`.
    fn add(&mut self, half: [f64; 2], p: DVec3, tangent: f64) {
        // In the light's plane, every window has what lies within the rim.
        if p.z <= 0.0 {
            return;
        }
        for i in 0..2 {
            self.min[i] = self.min[i].min(((p[i] + half[i]) / p.z).max(-tangent));
            self.max[i] = self.max[i].max(((p[i] - half[i]) / p.z).min(tangent));
        }
    }

    /// Widens the window to the box around a box, but by no more than `tangent`.
    fn add_around(&mut self, half: [f64; 2], of: &LightBox, tangent: f64) {
        for p in [of.min, of.max] {
            for z in [of.min.z, of.max.z] {
                self.add(half, p.with_z(z.max(f64::MIN_POSITIVE)), tangent);
            }
        }
    }

    /// The window without what lies beyond a tangent.
    pub fn within(&self, tangent: f64) -> Self {
        Self { min: self.min.map(|x| x.max(-tangent)), max: self.max.map(|x| x.min(tangent)) }
    }

    /// The window that holds both.
    pub fn with(&self, other: &Self) -> Self {
        Self {
            min: [0, 1].map(|i| self.min[i].min(other.min[i])),
            max: [0, 1].map(|i| self.max[i].max(other.max[i])),
        }
    }

    /// The window with `more` on each side along x and along y.
    pub fn padded(&self, more: [f64; 2]) -> Self {
        Self {
            min: [0, 1].map(|i| self.min[i] - more[i]),
            max: [0, 1].map(|i| self.max[i] + more[i]),
        }
    }

    /// The largest tangent in it.
    pub fn furthest(&self) -> f64 {
        self.min.iter().chain(&self.max).fold(0.0, |most, x| x.abs().max(most))
    }

    /// The middle along x and along y.
    pub fn middle(&self) -> [f64; 2] {
        [0, 1].map(|i| 0.5 * (self.min[i] + self.max[i]))
    }

    /// Half the width and the height.
    pub fn half(&self) -> [f64; 2] {
        [0, 1].map(|i| 0.5 * (self.max[i] - self.min[i]))
    }

    /// The window widened to whole steps and at least to `least`, but not beyond a tangent; or the one of that tangent to all
    /// sides, where it is hardly smaller.
    pub fn stepped(&self, least: f64, tangent: f64) -> Self {
        let mut window = *self;
        for i in 0..2 {
            let wide = (self.max[i] - self.min[i]).max(least).min(2.0 * tangent);
            let step = wide.log2().floor().exp2() / STEPS;
            // What lies within the rim may lie beyond the tangent as the light's centre sees it.
            let most = tangent - 0.5 * wide;
            let middle = (0.5 * (self.min[i] + self.max[i])).clamp(-most, most);
            let low = (self.min[i].min(middle - 0.5 * wide) / step).floor() * step;
            let high = (self.max[i].max(middle + 0.5 * wide) / step).ceil() * step;
            window.min[i] = low.max(-tangent);
            window.max[i] = high.min(tangent);
        }
        let is_whole = window.half().iter().all(|&half| half >= ALMOST_ALL * tangent);
        if is_whole { Self::around(tangent) } else { window }
    }
}

#[cfg(test)]
#[path = "visible_tests.rs"]
mod tests;
