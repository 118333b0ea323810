//! Images from strangers: those whose bytes are wrong, and those that unfold to a million times their length.

use super::seed::{Random, Seed};
use super::{BYTES_BESIDE, BYTES_PER_BYTE, Kept};
use allocation_counter::measure;
use antumbra::scene::{GltfOptions, from_gltf_as, from_gltf_bytes};
use antumbra_harness::whole;
use antumbra_tests::example::{folder, root};
use std::collections::BTreeSet;
use std::ops::Range;
use std::path::Path;

/// What decoding images may take of the memory: so many bytes, and as many for each byte of the file, as `from_gltf` says.
const ROOM: [u64; 2] = [256 << 20, 256];

/// What the memory may be for a file of so many bytes, beside that of one without images.
pub fn room(file: &[u8]) -> u64 {
    let has_images = file.windows(8).any(|word| word == br#""images""#);
    if has_images { ROOM[0] + ROOM[1] * file.len() as u64 } else { 0 }
}

/// The places in a file of what begins with these bytes and is so long.
fn image(file: &[u8], magic: &[u8], length: usize) -> Range<usize> {
    let start = file.windows(magic.len()).position(|word| word == magic).unwrap();
    start..start + length
}

/// The checksum of a PNG's chunk.
fn checksum(bytes: &[u8]) -> u32 {
    let step = |crc: u32, _| if crc & 1 == 1 { crc >> 1 ^ 0xEDB8_8320 } else { crc >> 1 };
    !bytes.iter().fold(!0, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), step))
}

/// Makes the checksums of a PNG's chunks right, so that what is behind them is looked at.
fn mend(png: &mut [u8]) {
    let mut at = 8;
    while let Some(word) = png.get(at..at + 4) {
        let length = u32::from_be_bytes(word.try_into().unwrap()) as usize;
        let Some(of) = at.checked_add(8 + length).filter(|end| end + 4 <= png.len()) else {
            return;
        };
        let sum = checksum(&png[at + 4..of]).to_be_bytes();
        png[of..of + 4].copy_from_slice(&sum);
        at = of + 4;
    }
}

/// Files that are broken in what shines, and the rest of a file with textures: as lights they are held to what others are.
#[test]
fn what_shines_broken_in_ten_thousand_ways() {
    const FILES: u64 = 10_000;
    /// What the triangles take that are looked at for lights.
    const LOOKED_AT: u64 = 32 << 20;
    let seed = Seed::read(&root().join("fuzz/seeds/textures.glb")).unwrap();
    let folder = folder("shining");
    let path = folder.join("scene.glb");
    let options = GltfOptions { emissive: true, ..GltfOptions::default() };
    let (mut loaded, mut lights) = (0, 0);
    for nth in 0..FILES {
        let file = seed.broken(&mut Random::new(nth));
        std::fs::write(&path, &file).unwrap();
        let _kept = Kept(&file, format!("broken-{nth}-shining.glb"));
        let taken = measure(|| match from_gltf_as(&path, &options) {
            Ok(scene) => {
                whole::check(&scene);
                loaded += 1;
                lights += scene.lights.len();
            }
            Err(error) => whole::check_sentence(&error.to_string()),
        });
        let allowed = BYTES_PER_BYTE * file.len() as u64 + BYTES_BESIDE + room(&file) + LOOKED_AT;
        assert!(taken.bytes_max <= allowed, "{} bytes", taken.bytes_max);
    }
    println!("{loaded} of {FILES} load, with {lights} lights");
    assert!(loaded > FILES / 20 && lights as u64 > loaded, "{loaded} load, {lights} lights");
    std::fs::remove_dir_all(&folder).unwrap();
}

/// How many files of each kind.
const BROKEN: u64 = 10_000;

#[test]
fn images_broken_in_thirty_thousand_ways() {
    let good = std::fs::read(root().join("fuzz/seeds/textures.glb")).unwrap();
    let kinds: [(&str, &[u8], usize); 3] =
        [("PNG", b"\x89PNG", 204), ("JPEG", b"\xff\xd8\xff", 340), ("WebP", b"RIFF", 120)];
    for (kind, magic, length) in kinds {
        let range = image(&good, magic, length);
        let (mut read, mut longest) = (0, 0);
        let mut sentences = BTreeSet::new();
        for nth in 0..BROKEN {
            let mut random = Random::new(nth);
            let mut file = good.clone();
            for _ in 0..=random.below(4) {
                let at = range.start + random.below(range.len());
                match random.below(3) {
                    0 => file[at] = random.next() as u8,
                    1 => file[at] ^= 1 << random.below(8),
                    _ => file[at] = *random.pick(&[0, 1, 127, 128, 255]),
                }
            }
            if kind == "PNG" && random.below(4) > 0 {
                mend(&mut file[range.clone()]);
            }
            let _kept = Kept(&file, format!("broken-{nth}-{kind}.glb"));
            let mut notes = Vec::new();
            let taken = measure(|| {
                let scene = from_gltf_bytes(&file, Path::new("file")).unwrap();
                whole::check(&scene);
                notes = scene.notes;
            });
            assert!(taken.bytes_max <= room(&file) + (1 << 20), "{} bytes", taken.bytes_max);
            longest = longest.max(taken.bytes_max);
            read += u64::from(notes.is_empty());
            let plain = |note: &String| {
                let before = note.split("ChunkType").next().unwrap_or_default();
                before.replace(|c: char| c.is_ascii_digit(), "")
            };
            sentences.extend(notes.iter().map(plain));
        }
        println!(
            "{kind}: {read} of {BROKEN} are read, {} kinds of notes, {longest} bytes",
            sentences.len()
        );
        assert!(read > BROKEN / 100 && read < BROKEN && sentences.len() > 3, "{sentences:#?}");
    }
}
