//! The files.

use crate::Outcome;
use crate::frames::ReadBack;
use exr::prelude::{Image as ExrImage, SpecificChannels, Vec2, WritableImage};
use std::path::Path;

/// Writes a frame's visibility, depth and picture into a folder, which is made where it is missing.
pub fn write(folder: &Path, extent: [u32; 2], read_back: &ReadBack) -> Outcome<()> {
    let failed = |path: &Path, problem: String| format!("{}: {problem}", path.display());
    std::fs::create_dir_all(folder).map_err(|e| failed(folder, e.to_string()))?;
    let channels = [("visibility.exr", read_back.visibility()), ("depth.exr", read_back.depth())];
    for (name, values) in &channels {
        let path = folder.join(name);
        exr_y(&path, extent, values).map_err(|e| failed(&path, e.to_string()))?;
    }
    let path = folder.join("picture.png");
    let [width, height] = extent;
    image::save_buffer(&path, read_back.picture(), width, height, image::ColorType::Rgba8)
        .map_err(|e| failed(&path, e.to_string()))?;
    Ok(())
}

/// One 32-bit float channel.
fn exr_y(path: &Path, [width, height]: [u32; 2], values: &[f32]) -> exr::error::UnitResult {
    let at = |p: Vec2<usize>| (values[p.y() * width as usize + p.x()],);
    let channels = SpecificChannels::build().with_channel("Y").with_pixel_fn(at);
    let image = ExrImage::from_channels((width as usize, height as usize), channels);
    image.write().to_file(path)
}
