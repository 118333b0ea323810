//! Where a texture lies on a surface.

use gltf::json::texture::Info;

/// The texture coordinates that a texture goes by, and what KHR_texture_transform makes of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Placing {
    /// The number of the set of texture coordinates.
    pub set: u32,
    /// The rows of an affine transform of these, as the bits of f32 numbers.
    rows: [[u32; 3]; 2],
}

impl Placing {
    /// Texture coordinates as KHR_texture_transform scales, turns and moves them.
    pub fn of(info: &Info) -> Self {
        let transform = info.extensions.as_ref().and_then(|e| e.texture_transform.as_ref());
        let Some(of) = transform else {
            let rows = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
            return Self { set: info.tex_coord, rows: rows.map(|row| row.map(f32::to_bits)) };
        };
        let (sin, cos) = f64::from(of.rotation.0).sin_cos();
        let [x, y] = of.scale.0.map(f64::from);
        let [right, down] = of.offset.0.map(f64::from);
        let rows = [[cos * x, -sin * y, right], [sin * x, cos * y, down]];
        let rows = rows.map(|row| row.map(|of| (of as f32).to_bits()));
        Self { set: of.tex_coord.unwrap_or(info.tex_coord), rows }
    }

    /// The place in the texture.
    pub fn place(&self, at: [f32; 2]) -> [f32; 2] {
        let [u, v] = at.map(f64::from);
        self.rows.map(|row| {
            let [a, b, c] = row.map(|of| f64::from(f32::from_bits(of)));
            // A product of 0 and infinity is no place, though 0 takes no part.
            let part = |factor: f64, of: f64| if factor == 0.0 { 0.0 } else { factor * of };
            (part(a, u) + part(b, v) + c) as f32
        })
    }
}
