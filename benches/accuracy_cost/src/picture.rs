//! Pictures: shaded images, signed errors in color, FLIP, PNG.

use crate::Problem;
use base64::Engine as _;
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use std::path::{Path, PathBuf};

/// The name of the truth's picture.
pub const TRUTH: &str = "truth";

/// The error at which the colors of a difference end, in visible fractions.
pub const ERROR_SCALE: f32 = 0.2;

/// What the color of no error, and of pixels that receive nothing, is.
const NEUTRAL: [f32; 3] = [247.0, 247.0, 247.0];
const NOTHING: [u8; 3] = [222, 222, 224];

/// Too dark and too bright at [`ERROR_SCALE`]: the ends of ColorBrewer's PuOr, distinct to every
/// kind of color vision, and by their lightness both from neutral.
const TOO_DARK: [f32; 3] = [179.0, 88.0, 6.0];
const TOO_BRIGHT: [f32; 3] = [84.0, 39.0, 136.0];

/// The name of a curve's error picture.
pub fn error_of(curve: &str) -> String {
    format!("{curve}, error")
}

/// The color of a signed error, image − truth: orange where the image is too dark, violet where it
/// is too bright, white where it is right.
pub fn color(error: f32) -> [u8; 3] {
    let t = (error / ERROR_SCALE).clamp(-1.0, 1.0);
    let end = if t < 0.0 { TOO_DARK } else { TOO_BRIGHT };
    // The root lifts small errors off white; the color bar shows what it does.
    let t = t.abs().sqrt();
    [0, 1, 2].map(|i| (NEUTRAL[i] + (end[i] - NEUTRAL[i]) * t).round() as u8)
}

/// Three bytes a pixel of the signed error where the mask is true.
pub fn difference(truth: &[f32], image: &[f32], mask: &[bool]) -> Vec<u8> {
    let pixel = |((t, i), seen): ((&f32, &f32), &bool)| if *seen { color(i - t) } else { NOTHING };
    truth.iter().zip(image).zip(mask).flat_map(pixel).collect()
}

/// Mean FLIP (Andersson et al. 2020) of two sRGB images, 0..1, at its default of 67 pixels a degree.
pub fn flip([width, height]: [u32; 2], truth: &[u8], image: &[u8]) -> f64 {
    let load = |pixels| nv_flip::FlipImageRgb8::with_data(width, height, pixels);
    let map = nv_flip::flip(load(truth), load(image), nv_flip::DEFAULT_PIXELS_PER_DEGREE).to_vec();
    map.iter().map(|f| f64::from(*f)).sum::<f64>() / map.len().max(1) as f64
}

/// A PNG of three bytes a pixel.
pub fn png([width, height]: [u32; 2], rgb: &[u8]) -> Result<Vec<u8>, Problem> {
    let mut bytes = Vec::new();
    PngEncoder::new_with_quality(
        &mut bytes,
        image::codecs::png::CompressionType::Best,
        image::codecs::png::FilterType::Adaptive,
    )
    .write_image(rgb, width, height, ExtendedColorType::Rgb8)
    .map_err(Problem::of("PNG"))?;
    Ok(bytes)
}

/// A PNG as the address of an `img`.
pub fn data_url(png: &[u8]) -> String {
    format!("data:image/png;base64,{}", base64::engine::general_purpose::STANDARD.encode(png))
}

/// The folder of the strip's pictures.
pub struct Pictures(PathBuf);

impl Pictures {
    /// In the folder of what is kept.
    pub fn new(cache: &Path) -> Self {
        Self(cache.join("pictures"))
    }

    fn path(&self, scene: &str, name: &str) -> PathBuf {
        let plain = |c: char| if c.is_ascii_alphanumeric() || c == '.' { c } else { '-' };
        self.0.join(format!("{scene}--{name}").chars().map(plain).collect::<String>() + ".png")
    }

    /// Keeps a picture where it can.
    pub fn keep(&self, scene: &str, name: &str, extent: [u32; 2], rgb: &[u8]) {
        let _ = std::fs::create_dir_all(&self.0);
        if let Ok(bytes) = png(extent, rgb) {
            let _ = std::fs::write(self.path(scene, name), bytes);
        }
    }

    /// The kept picture as an address.
    pub fn url(&self, scene: &str, name: &str) -> Option<String> {
        std::fs::read(self.path(scene, name)).ok().map(|bytes| data_url(&bytes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_white_at_none_and_differ_by_sign() {
        assert_eq!(color(0.0), [247; 3]);
        assert_eq!(color(-1.0), [179, 88, 6]);
        assert_eq!(color(ERROR_SCALE), [84, 39, 136]);
        assert_eq!(color(0.05)[2], color(0.05)[2].max(color(0.05)[1]));
        let pixels = difference(&[0.5, 0.5], &[0.5, 0.0], &[true, false]);
        assert_eq!(pixels, [247, 247, 247, 222, 222, 224]);
    }

    #[test]
    fn flip_is_nothing_between_equals_and_something_otherwise() {
        let extent = [32, 24];
        let gray = vec![128; 32 * 24 * 3];
        let mut edge = gray.clone();
        edge[..32 * 12 * 3].fill(40);
        assert!(flip(extent, &gray, &gray) < 1e-6);
        assert!(flip(extent, &gray, &edge) > 0.05);
    }

    #[test]
    fn pictures_are_kept_under_names_that_any_disk_takes() {
        let folder = std::env::temp_dir().join(format!("antumbra-pictures-{}", std::process::id()));
        let pictures = Pictures::new(&folder);
        pictures.keep("a/b: c", "x, error", [1, 1], &[1, 2, 3]);
        let url = pictures.url("a/b: c", "x, error").unwrap();
        assert!(url.starts_with("data:image/png;base64,iVBOR"));
        assert_eq!(pictures.url("a", "x"), None);
    }
}
