//! Textures copied out, and the files made of them.

use crate::Outcome;
use crate::device::{Gpu, Target};
use exr::prelude::{Image as ExrImage, SpecificChannels, Vec2, WritableImage};
use std::path::Path;

/// A copy of a texture of four bytes a texel, on its way to the processor.
pub struct Copied {
    buffer: wgpu::Buffer,
    extent: [u32; 2],
}

/// Rows in buffers begin at multiples of this.
const ROW: u32 = wgpu::COPY_BYTES_PER_ROW_ALIGNMENT;

impl Copied {
    /// Records the copy.
    pub fn record(gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, from: &Target) -> Self {
        let extent = from.extent();
        let [width, height] = extent;
        let bytes_per_row = (width * 4).next_multiple_of(ROW);
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("copied"),
            size: u64::from(bytes_per_row) * u64::from(height),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(bytes_per_row),
            rows_per_image: None,
        };
        encoder.copy_texture_to_buffer(
            from.texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo { buffer: &buffer, layout },
            from.texture.size(),
        );
        Self { buffer, extent }
    }

    /// The texels row by row; the copy must have been submitted.
    pub fn read<T: bytemuck::AnyBitPattern>(&self, gpu: &Gpu) -> Outcome<Vec<T>> {
        let (sender, mapped) = std::sync::mpsc::channel();
        self.buffer.map_async(wgpu::MapMode::Read, .., move |result| {
            // The receiver lives until it has this.
            let _ = sender.send(result);
        });
        gpu.device.poll(wgpu::PollType::wait_indefinitely())?;
        mapped.recv()??;
        let bytes = self.buffer.get_mapped_range(..)?;
        let row = (self.extent[0] * 4) as usize;
        let rows = bytes.chunks_exact(row.next_multiple_of(ROW as usize));
        let texels = rows.flat_map(|r| r[..row].chunks_exact(size_of::<T>()));
        Ok(texels.map(bytemuck::pod_read_unaligned).collect())
    }

    /// Writes one 32-bit float channel as OpenEXR.
    pub fn exr(&self, gpu: &Gpu, path: &Path) -> Outcome<()> {
        let values: Vec<f32> = self.read(gpu)?;
        let [width, height] = self.extent.map(|e| e as usize);
        let at = |p: Vec2<usize>| (values[p.y() * width + p.x()],);
        let channels = SpecificChannels::build().with_channel("Y").with_pixel_fn(at);
        let file = ExrImage::from_channels((width, height), channels);
        file.write().to_file(path).map_err(|e| format!("{}: {e}", path.display()))?;
        Ok(())
    }

    /// Writes four 8-bit channels as PNG.
    pub fn png(&self, gpu: &Gpu, path: &Path) -> Outcome<()> {
        let texels: Vec<[u8; 4]> = self.read(gpu)?;
        let [width, height] = self.extent;
        let color = image::ColorType::Rgba8;
        image::save_buffer(path, texels.as_flattened(), width, height, color)
            .map_err(|e| format!("{}: {e}", path.display()))?;
        Ok(())
    }
}
