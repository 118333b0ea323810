//! Images from strangers: those whose bytes are wrong, and those that unfold to a million times their length.

use super::Kept;
use super::seed::Random;
use allocation_counter::measure;
use antumbra::scene::{Scene, from_gltf_bytes};
use antumbra_harness::whole;
use antumbra_tests::example::root;
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

/// Checks what a scene promises of opacity maps, texture coordinates and notes.
pub fn check(scene: &Scene) {
    for map in &scene.opacity_maps {
        let [width, height] = map.size.map(|side| side as usize);
        assert!(width > 0 && height > 0 && map.texels.len() == width * height, "{:?}", map.size);
        assert!(map.cutoff.is_none_or(|cutoff| cutoff > 0.0), "{:?}", map.cutoff);
    }
    for mesh in &scene.meshes {
        let places = mesh.texture_coordinates.as_flattened();
        let count = mesh.opacity_map.map_or(0, |_| 2 * mesh.positions.len());
        assert!(places.len() == count && places.iter().all(|place| place.is_finite()));
        assert!(mesh.opacity_map.is_none_or(|map| mesh.cut_out && map < scene.opacity_maps.len()));
    }
    assert!(scene.notes.len() <= 33);
    scene.notes.iter().for_each(|note| whole::check_sentence(note));
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
                check(&scene);
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
