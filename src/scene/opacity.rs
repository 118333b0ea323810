//! Where a mesh stops light, and how much of it, as the alpha of a texture says.

pub use crate::lent::Wrap;

/// The part of the light that a surface stops, as a texture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OpacityMap {
    /// Width and height in texels, each above 0.
    pub size: [u32; 2],
    /// One opacity a texel, 0 to 255 for 0 to 1, row by row from v = 0 on.
    pub texels: Vec<u8>,
    /// How it goes on along u and v.
    pub wrap: [Wrap; 2],
    /// Between texels' centres it is interpolated; otherwise each texel is a square.
    pub linear: bool,
    /// A surface stops all light where its opacity is this or more, and none elsewhere (`alphaMode` `MASK`); without a
    /// cutoff it stops the part of the light that its opacity is.
    pub cutoff: Option<f32>,
}

impl OpacityMap {
    /// The opacity at a place (u, v), 0..1; with a cutoff 0 or 1. It is 1 where the map has no texels, or the place is no
    /// number.
    pub fn at(&self, [u, v]: [f64; 2]) -> f64 {
        let [width, height] = self.size.map(f64::from);
        if !(u.is_finite() && v.is_finite() && width > 0.0 && height > 0.0) {
            return 1.0;
        }
        let sampled = match self.linear {
            false => self.texel((u * width).floor(), (v * height).floor()),
            true => {
                let (x, y) = (u * width - 0.5, v * height - 0.5);
                let (left, top) = (x.floor(), y.floor());
                let row = |y: f64| {
                    let [a, b] = [left, left + 1.0].map(|x| self.texel(x, y));
                    a + (b - a) * (x - left)
                };
                let [above, below] = [top, top + 1.0].map(row);
                above + (below - above) * (y - top)
            }
        };
        match self.cutoff {
            Some(cutoff) => f64::from(u8::from(sampled >= f64::from(cutoff))),
            None => sampled,
        }
    }

    /// The opacity of a texel, of which neither coordinate has a fraction.
    fn texel(&self, x: f64, y: f64) -> f64 {
        let [width, height] = self.size.map(f64::from);
        let at = wrapped(y, height, self.wrap[1]) * width + wrapped(x, width, self.wrap[0]);
        self.texels.get(at as usize).map_or(1.0, |&texel| f64::from(texel) / 255.0)
    }
}

/// The coordinate of a texel among `side` of them.
fn wrapped(at: f64, side: f64, wrap: Wrap) -> f64 {
    match wrap {
        Wrap::Repeat => at.rem_euclid(side),
        Wrap::Mirror => {
            let within = at.rem_euclid(2.0 * side);
            if within < side { within } else { 2.0 * side - 1.0 - within }
        }
        Wrap::Clamp => at.clamp(0.0, side - 1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(wrap: Wrap, linear: bool, cutoff: Option<f32>) -> OpacityMap {
        let texels = vec![0, 51, 102, 255];
        OpacityMap { size: [4, 1], texels, wrap: [wrap; 2], linear, cutoff }
    }

    #[test]
    fn a_texel_is_a_square_or_interpolated() {
        let squares = map(Wrap::Repeat, false, None);
        assert_eq!([0.1, 0.3, 0.6, 0.9].map(|u| squares.at([u, 0.5])), [0.0, 0.2, 0.4, 1.0]);
        let between = map(Wrap::Clamp, true, None);
        assert!((between.at([0.5, 0.5]) - 0.3).abs() < 1e-12);
        assert_eq!([-2.0, 0.0, 1.0, 9.0].map(|u| between.at([u, 7.0])), [0.0, 0.0, 1.0, 1.0]);
        let cut = map(Wrap::Clamp, true, Some(0.25));
        assert_eq!([0.3, 0.4, 0.43, 0.45].map(|u| cut.at([u, 0.5])), [0.0, 0.0, 0.0, 1.0]);
    }

    #[test]
    fn it_goes_on_beyond_its_edges() {
        let places = [-0.1, 1.1, 1.4, 2.1];
        assert_eq!(
            places.map(|u| map(Wrap::Repeat, false, None).at([u, 0.0])),
            [1.0, 0.0, 0.2, 0.0]
        );
        assert_eq!(
            places.map(|u| map(Wrap::Mirror, false, None).at([u, 0.0])),
            [0.0, 1.0, 0.4, 0.0]
        );
        assert_eq!(
            places.map(|u| map(Wrap::Clamp, false, None).at([u, 0.0])),
            [0.0, 1.0, 1.0, 1.0]
        );
    }

    #[test]
    fn what_is_not_known_is_whole() {
        for linear in [false, true] {
            for cutoff in [None, Some(0.5)] {
                let map = map(Wrap::Repeat, linear, cutoff);
                assert_eq!(map.at([f64::NAN, 0.0]), 1.0);
                assert_eq!(map.at([0.0, f64::INFINITY]), 1.0);
                let none = OpacityMap { cutoff, linear, ..OpacityMap::default() };
                assert_eq!(none.at([0.5, 0.5]), 1.0);
            }
        }
    }
}
