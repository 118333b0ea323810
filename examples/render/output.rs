//! The files: encoded whole in memory, then written all or none.

use antumbra::Error;
use exr::prelude::{AnyChannel, AnyChannels, FlatSamples, Image as ExrImage, Layer, Text};
use exr::prelude::{Encoding, LayerAttributes, SmallVec, SpecificChannels, Vec2, WritableImage};
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// Files to be, by name.
#[derive(Default)]
pub struct Files(Vec<(&'static str, Vec<u8>)>);

fn failed(path: impl AsRef<Path>, problem: impl std::fmt::Display) -> Error {
    Error::File { path: path.as_ref().display().to_string(), problem: problem.to_string() }
}

impl Files {
    /// One 32-bit float channel.
    pub fn exr_y(
        &mut self,
        name: &'static str,
        [width, height]: [u32; 2],
        values: &[f32],
    ) -> Result<(), Error> {
        let at = |p: Vec2<usize>| (values[p.y() * width as usize + p.x()],);
        let channels = SpecificChannels::build().with_channel("Y").with_pixel_fn(at);
        let image = ExrImage::from_channels((width as usize, height as usize), channels);
        let mut bytes = Cursor::new(Vec::new());
        image.write().to_buffered(&mut bytes).map_err(|e| failed(name, e))?;
        self.0.push((name, bytes.into_inner()));
        Ok(())
    }

    /// 32-bit float channels, each with its own name.
    pub fn exr_named(
        &mut self,
        name: &'static str,
        [width, height]: [u32; 2],
        channels: &[(String, Vec<f32>)],
    ) -> Result<(), Error> {
        let channel = |(name, values): &(String, Vec<f32>)| {
            // In UTF-8, as the format's readers take names.
            let name = Text::from_slice_unchecked(name.as_bytes());
            AnyChannel::new(name, FlatSamples::F32(values.clone()))
        };
        let list: SmallVec<_> = channels.iter().map(channel).collect();
        let size = (width as usize, height as usize);
        let layer = Layer::new(
            size,
            LayerAttributes::default(),
            Encoding::FAST_LOSSLESS,
            AnyChannels::sort(list),
        );
        let mut bytes = Cursor::new(Vec::new());
        ExrImage::from_layer(layer).write().to_buffered(&mut bytes).map_err(|e| failed(name, e))?;
        self.0.push((name, bytes.into_inner()));
        Ok(())
    }

    /// Three 32-bit float channels, R, G and B.
    pub fn exr_rgb(
        &mut self,
        name: &'static str,
        [width, height]: [u32; 2],
        values: &[[f32; 4]],
    ) -> Result<(), Error> {
        let at = |p: Vec2<usize>| {
            let [r, g, b, _] = values[p.y() * width as usize + p.x()];
            (r, g, b)
        };
        let image =
            ExrImage::from_channels((width as usize, height as usize), SpecificChannels::rgb(at));
        let mut bytes = Cursor::new(Vec::new());
        image.write().to_buffered(&mut bytes).map_err(|e| failed(name, e))?;
        self.0.push((name, bytes.into_inner()));
        Ok(())
    }

    /// 8-bit pixels.
    pub fn png(
        &mut self,
        name: &'static str,
        [width, height]: [u32; 2],
        color: ExtendedColorType,
        pixels: &[u8],
    ) -> Result<(), Error> {
        let mut bytes = Vec::new();
        PngEncoder::new(&mut bytes)
            .write_image(pixels, width, height, color)
            .map_err(|e| failed(name, e))?;
        self.0.push((name, bytes));
        Ok(())
    }

    /// Text as it is.
    pub fn text(&mut self, name: &'static str, text: String) {
        self.0.push((name, text.into_bytes()));
    }

    /// Writes every file under another name, then gives them theirs; takes back what it wrote where
    /// that fails.
    pub fn write(&self, folder: &Path) -> Result<(), Error> {
        fs::create_dir_all(folder).map_err(|e| failed(folder, e))?;
        let temporary = |name: &str| -> PathBuf { folder.join(format!(".{name}.part")) };
        let written = self.0.iter().try_for_each(|(name, bytes)| {
            fs::write(temporary(name), bytes).map_err(|e| failed(folder.join(name), e))
        });
        let placed = written.and_then(|()| {
            // A folder in a file's place is the one thing that can still stop a rename.
            if let Some((name, _)) = self.0.iter().find(|(name, _)| folder.join(name).is_dir()) {
                return Err(failed(folder.join(name), "a folder is in the file's place"));
            }
            self.0.iter().try_for_each(|(name, _)| {
                let target = folder.join(name);
                fs::rename(temporary(name), &target).map_err(|e| failed(target, e))
            })
        });
        if placed.is_err() {
            for (name, _) in &self.0 {
                // What is not there needs no removing.
                let _ = fs::remove_file(temporary(name));
            }
        }
        placed
    }
}
