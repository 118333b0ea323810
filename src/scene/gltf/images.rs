//! Images of textures, of which one channel is kept.
//!
//! A thousand bytes may be an image of a billion texels, so that what is decoded is held to what a file's bytes allow. What is
//! wrong with an image stops no scene.

use super::Problem;
use super::buffers::Buffers;
use super::json::in_a_line;
use gltf::json::Image;
use image::{ColorType, ImageDecoder, ImageFormat, ImageReader, Limits};
use std::borrow::Cow;
use std::cell::Cell;
use std::io::Cursor;
use std::rc::Rc;

/// The texels that an image may have: so many, and as many for each byte of the file and those that it names.
const OF_ONE: [u64; 2] = [16 << 20, 16];

/// The texels that all images and opacity maps of a file may have together, counted in the same way.
const OF_ALL: [u64; 2] = [64 << 20, 32];

/// The bytes that a decoder may take for a texel: a progressive JPEG's coefficients and its colors.
const DECODING: u64 = 12;

/// The channel that says how much light is stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Channel {
    Alpha,
    Red,
}

/// One channel of an image.
pub(super) struct Plane {
    pub size: [u32; 2],
    /// A byte a texel; one byte where all are the same.
    pub texels: Vec<u8>,
}

impl Plane {
    /// The least and the largest value.
    pub fn range(&self) -> [u8; 2] {
        let least = self.texels.iter().min().copied().unwrap_or(u8::MAX);
        [least, self.texels.iter().max().copied().unwrap_or(u8::MAX)]
    }

    fn even(value: u8) -> Self {
        Self { size: [1, 1], texels: vec![value] }
    }
}

/// The texels that a file's images and opacity maps took.
#[derive(Default)]
pub(super) struct Room(Cell<u64>);

impl Room {
    /// Takes so many for a file of `bytes` bytes.
    pub fn take(&self, texels: u64, bytes: u64) -> Result<(), Problem> {
        let all = self.0.get().saturating_add(texels);
        let [beside, each] = OF_ALL;
        if all > bytes.saturating_mul(each).saturating_add(beside) {
            return Err(format!(
                "with it the file's images and what is made of them have more than 64 Mi texels and {each} for each of its bytes"
            ));
        }
        self.0.set(all);
        Ok(())
    }
}

/// A channel of `images[index]`.
pub(super) fn plane(
    image: &Image,
    index: usize,
    channel: Channel,
    buffers: &Buffers,
    room: &Room,
) -> Result<Plane, Problem> {
    let name = || format!("images[{index}]");
    let (view, file): (_, Rc<Vec<u8>>);
    let bytes: &[u8] = match (&image.uri, image.buffer_view) {
        (Some(uri), _) => {
            file = buffers.resource(uri).map_err(|problem| format!("{}: {problem}", name()))?;
            &file
        }
        (None, Some(of)) => {
            (view, _) = buffers.view(of.value(), name)?;
            view
        }
        (None, None) => return Err(format!("{} has neither a uri nor a bufferView", name())),
    };
    decoded(bytes, channel, buffers.held(), room)
        .map_err(|problem| format!("{} cannot be read: {problem}", name()))
}

/// A channel of the image in these bytes, of a file of `held` bytes.
fn decoded(bytes: &[u8], channel: Channel, held: u64, room: &Room) -> Result<Plane, Problem> {
    let of_decoder = |e: image::ImageError| in_a_line(&e.to_string());
    let format = image::guess_format(bytes).ok();
    let format =
        format.filter(|f| matches!(f, ImageFormat::Png | ImageFormat::Jpeg | ImageFormat::WebP));
    let format = format.ok_or("its bytes are no PNG, JPEG or WebP")?;
    if (format, channel) == (ImageFormat::Jpeg, Channel::Alpha) {
        return Ok(Plane::even(u8::MAX));
    }
    let [beside, each] = OF_ONE;
    let most = held.saturating_mul(each).saturating_add(beside);
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(most.saturating_mul(DECODING));
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(of_decoder)?;
    let (width, height) = decoder.dimensions();
    let texels = u64::from(width) * u64::from(height);
    if texels == 0 || texels > most {
        return Err(format!(
            "it has {width} × {height} texels; an image may have 16 Mi, and {each} for each byte of the file"
        ));
    }
    let color = decoder.color_type();
    if channel == Channel::Alpha && !color.has_alpha() {
        return Ok(Plane::even(u8::MAX));
    }
    room.take(texels, held)?;
    let (length, stride) = (decoder.total_bytes(), usize::from(color.bytes_per_pixel()));
    let mut pixels = Vec::new();
    let length = usize::try_from(length).map_err(|_| "it does not fit the memory")?;
    pixels.try_reserve_exact(length).map_err(|_| "it does not fit the memory")?;
    pixels.resize(length, 0);
    decoder.read_image(&mut pixels).map_err(of_decoder)?;
    let values = pixels.chunks_exact(stride).map(|pixel| value(pixel, color, channel));
    let mut texels: Vec<u8> = Vec::with_capacity(values.len());
    texels.extend(values);
    let first = texels.first().copied().unwrap_or(u8::MAX);
    if texels.iter().all(|texel| *texel == first) {
        return Ok(Plane::even(first));
    }
    Ok(Plane { size: [width, height], texels })
}

/// The channel's value in the bytes of a pixel.
fn value(pixel: &[u8], color: ColorType, channel: Channel) -> u8 {
    let size = usize::from(color.bytes_per_pixel() / color.channel_count());
    let bytes: Cow<[u8]> = match channel {
        Channel::Alpha => pixel.rchunks(size).next().unwrap_or_default().into(),
        Channel::Red => pixel.chunks(size).next().unwrap_or_default().into(),
    };
    match *bytes {
        [value] => value,
        // The nearest of 255 steps to one of 65,535.
        [a, b] => ((u32::from(u16::from_ne_bytes([a, b])) + 128) / 257) as u8,
        _ => u8::MAX,
    }
}
