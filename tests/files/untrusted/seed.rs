//! Good files, and the breaking of them, the same in each run.

use super::json::{Json, break_text};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::Value;
use std::ops::Range;
use std::path::Path;

/// Marsaglia's xorshift64.
pub struct Random(u64);

impl Random {
    /// A sequence of its own for each number.
    pub fn new(number: u64) -> Self {
        // Odd times a number below 2^63 is 0 for 0 alone, of which xorshift would make nothing but 0.
        Self(0x9E37_79B9_7F4A_7C15_u64.wrapping_mul(number + 1))
    }

    pub fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    /// Below `n`, which is above 0.
    pub fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }

    /// One of these, of which there is one at least.
    pub fn pick<'a, T>(&mut self, of: &'a [T]) -> &'a T {
        &of[self.below(of.len())]
    }
}

/// Numbers at which lengths, offsets, counts and indices go over an edge.
pub const ODD_INTEGERS: [u64; 14] = [
    0,
    1,
    3,
    7,
    127,
    255,
    65_536,
    0x7FFF_FFFF,
    0x8000_0000,
    0xFFFF_FFFF,
    0x1_0000_0000,
    i64::MAX as u64,
    u64::MAX - 3,
    u64::MAX,
];

/// Above this many bytes a buffer is not written as text, which would take most of the time.
const SHORT: usize = 1 << 12;

/// A good file in its parts.
pub struct Seed {
    pub name: String,
    bin: Vec<u8>,
    /// The JSON of a .glb, whose first buffer is the binary chunk.
    in_chunk: Json,
    /// The same with the bytes in its text, and where they stand there; not where they are many.
    in_text: Option<(Json, Range<usize>)>,
}

impl Seed {
    /// Reads a .glb, or a .gltf whose one buffer is a data URI; `None` for any other file.
    pub fn read(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_string_lossy().into_owned();
        let file = std::fs::read(path).ok()?;
        let (mut root, bin): (Value, Vec<u8>) = if let Some(rest) = file.strip_prefix(b"glTF") {
            // Behind what it is: version, length, and of each chunk length, kind and what it holds.
            let length = u32::from_le_bytes(*rest.get(8..)?.first_chunk()?) as usize;
            let text = rest.get(16..16 + length)?;
            (serde_json::from_slice(text).ok()?, rest.get(16 + length + 8..)?.to_vec())
        } else {
            let mut root: Value = serde_json::from_slice(&file).ok()?;
            let [buffer] = root.get_mut("buffers")?.as_array_mut()?.as_mut_slice() else {
                return None;
            };
            let uri = buffer.as_object_mut()?.remove("uri")?;
            let encoded = uri.as_str()?.strip_prefix("data:")?.split_once(',')?.1;
            let bin = STANDARD.decode(encoded).ok()?;
            (root, bin)
        };
        let in_chunk = Json::new(root.to_string());
        let in_text = (bin.len() < SHORT).then(|| {
            let encoded = STANDARD.encode(&bin);
            root["buffers"][0]["uri"] = format!("data:;base64,{encoded}").into();
            let text = root.to_string();
            let start = text.find(&encoded).unwrap_or(0);
            (Json::new(text), start..start + encoded.len())
        });
        Some(Self { name, bin, in_chunk, in_text })
    }

    /// As it was, as a .glb.
    pub fn whole(&self) -> Vec<u8> {
        container(&self.in_chunk.text, &self.bin)
    }

    /// Broken in one to three ways, as a .glb or a .gltf.
    pub fn broken(&self, random: &mut Random) -> Vec<u8> {
        let as_text = self.in_text.as_ref().filter(|_| random.below(2) == 0);
        let changes = 1 + random.below(3);
        // What the JSON says, how that is written, or the bytes.
        let (in_json, in_text, in_bin) = match random.below(8) {
            0..=4 => (changes, 0, 0),
            5 => (0, changes, 0),
            6 => (0, 0, changes),
            _ => (1, 1, 1),
        };
        let mut bin = self.bin.clone();
        for _ in 0..in_bin {
            change_numbers(&mut bin, random);
        }
        let json = as_text.map_or(&self.in_chunk, |(json, _)| json);
        let mut text = if in_json == 0 { json.text.clone() } else { json.changed(in_json, random) };
        // Where the JSON is as it was, so is the place of the bytes.
        if let (Some((_, bytes)), 0) = (as_text, in_json) {
            text.splice(bytes.clone(), STANDARD.encode(&bin).into_bytes());
        }
        for _ in 0..in_text {
            break_text(&mut text, random);
        }
        let second = 20 + text.len().next_multiple_of(4);
        let mut file = if as_text.is_some() { text } else { container(&text, &bin) };
        match random.below(16) {
            0 => file.truncate(random.below(file.len() + 1)),
            1 if as_text.is_none() => change_container(&mut file, second, random),
            _ => {}
        }
        file
    }
}

/// Puts JSON and bytes into a .glb.
pub fn container(text: &[u8], bin: &[u8]) -> Vec<u8> {
    let mut text = text.to_vec();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut file = b"glTF\x02\0\0\0".to_vec();
    file.extend(((12 + 8 + text.len() + 8 + bin.len()) as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", text.as_slice()), (b"BIN\0", bin)] {
        file.extend((chunk.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(chunk);
    }
    file
}

/// Changes a word of the .glb's headers, most often a length, or repeats its second chunk.
fn change_container(file: &mut Vec<u8>, second: usize, random: &mut Random) {
    let at = *random.pick(&[4, 8, 12, 16, second, second + 4]);
    let Some(word) = file.get_mut(at..).and_then(|rest| rest.first_chunk_mut::<4>()) else {
        return;
    };
    let now = u32::from_le_bytes(*word);
    let odd = *random.pick(&ODD_INTEGERS) as u32;
    let then =
        *random.pick(&[odd, now.wrapping_sub(1), now.wrapping_add(4), now / 2, now | 1 << 31]);
    *word = then.to_le_bytes();
    if random.below(4) == 0 {
        let chunk = file.get(second..).unwrap_or_default().to_vec();
        file.extend(chunk);
    }
}

/// Overwrites numbers of the binary chunk: positions, normals and indices of any width.
fn change_numbers(bin: &mut [u8], random: &mut Random) {
    const FLOATS: [f32; 12] = [
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::MAX,
        f32::MIN_POSITIVE,
        1e-45,
        -0.0,
        0.0,
        1.0,
        -1e9,
        1.5e9,
        1e20,
    ];
    for _ in 0..=random.below(4) {
        let word = match random.below(3) {
            0 => random.pick(&FLOATS).to_le_bytes(),
            1 => (*random.pick(&ODD_INTEGERS) as u32).to_le_bytes(),
            _ => (random.next() as u32).to_le_bytes(),
        };
        let length = *random.pick(&[1, 2, 4]);
        if bin.len() >= 4 {
            let at = random.below(bin.len() / 4) * 4;
            bin[at..at + length].copy_from_slice(&word[..length]);
        }
    }
}
