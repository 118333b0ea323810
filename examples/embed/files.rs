//! Pictures and numbers into files.

use crate::Outcome;
use exr::prelude::{Image, SpecificChannels, Vec2, WritableImage};
use std::path::Path;

/// 8-bit red, green, blue and alpha.
pub fn png(path: &Path, pixels: &[u8], [width, height]: [u32; 2]) -> Outcome<()> {
    Ok(image::save_buffer(path, pixels, width, height, image::ColorType::Rgba8)?)
}

/// One channel of 32-bit floats.
pub fn exr(path: &Path, bytes: &[u8], [width, height]: [u32; 2]) -> Outcome<()> {
    let values: Vec<f32> = bytemuck::pod_collect_to_vec(bytes);
    let at = |p: Vec2<usize>| (values[p.y() * width as usize + p.x()],);
    let channels = SpecificChannels::build().with_channel("Y").with_pixel_fn(at);
    let image = Image::from_channels((width as usize, height as usize), channels);
    Ok(image.write().to_file(path)?)
}
