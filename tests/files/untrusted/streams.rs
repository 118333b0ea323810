//! Compressed meshes from strangers: streams whose bytes are wrong, and those that unfold to a thousand times their length.

use super::seed::Random;
use super::{BYTES_BESIDE, BYTES_PER_BYTE, Kept};
use allocation_counter::measure;
use antumbra::scene::from_gltf_bytes;
use antumbra_harness::whole;
use antumbra_tests::draco::compressed;
use antumbra_tests::example::root;
use draco_core::{DataType, GeometryAttributeType};
use serde_json::json;
use std::collections::BTreeSet;
use std::path::Path;

/// What compressed parts may decode to: so many bytes, and as many for each byte of the file, as `from_gltf` says.
const ROOM: [u64; 2] = [16 << 20, 64];

/// How many times that the memory may be.
const TIMES: u64 = 4;

/// Opens a file; says how much memory was taken at once, over what that may be.
fn opened(file: &[u8]) -> (Result<usize, String>, f64) {
    let mut found = None;
    let most = measure(|| {
        let scene = from_gltf_bytes(file, Path::new("file"));
        found = Some(match scene {
            Ok(scene) => {
                whole::check(&scene);
                Ok(scene.triangles())
            }
            Err(error) => Err(error.to_string()),
        });
    })
    .bytes_max;
    let bytes = file.len() as u64;
    let room = ROOM[0] + ROOM[1] * bytes;
    let allowed = BYTES_PER_BYTE * bytes + BYTES_BESIDE + TIMES * room;
    assert!(most <= allowed, "{most} bytes of memory for {bytes} bytes of file");
    (found.unwrap(), most as f64 / room as f64)
}

/// The places of a .glb's binary chunk.
fn chunk(file: &[u8]) -> std::ops::Range<usize> {
    let length = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap()) as usize;
    let json = length(12);
    28 + json..28 + json + length(20 + json)
}

/// How many files of each kind.
const BROKEN: u64 = 60_000;

#[test]
fn draco_streams_broken_in_sixty_thousand_ways() {
    break_streams("draco.glb", 10);
}

/// Of a stream that is none meshoptimizer says no more than that.
#[test]
fn meshopt_streams_broken_in_sixty_thousand_ways() {
    break_streams("meshopt.glb", 2);
}

/// Breaks the bytes of a seed's streams, of which there must come so many kinds of sentences.
fn break_streams(seed: &str, kinds: usize) {
    let good = std::fs::read(root().join("fuzz/seeds").join(seed)).unwrap();
    let range = chunk(&good);
    let (mut loaded, mut most) = (0, 0.0f64);
    let mut sentences = BTreeSet::new();
    for nth in 0..BROKEN {
        let mut random = Random::new(nth);
        let mut file = good.clone();
        for _ in 0..=random.below(4) {
            let at = range.start + random.below(range.len());
            match random.below(4) {
                0 => file[at] = random.next() as u8,
                1 => file[at] ^= 1 << random.below(8),
                2 => file[at] = *random.pick(&[0, 1, 127, 128, 255]),
                // A part of the streams over another.
                _ => {
                    let from = range.start + random.below(range.len());
                    let length = random.below(range.end - from.max(at)).min(24);
                    file.copy_within(from..from + length, at);
                }
            }
        }
        let _kept = Kept(&file, format!("broken-{nth}-{seed}"));
        let (result, times) = opened(&file);
        most = most.max(times);
        match result {
            Ok(_) => loaded += 1,
            Err(sentence) => {
                let unquoted: String = sentence.split('"').step_by(2).collect();
                sentences.insert(unquoted.replace(|c: char| c.is_ascii_digit(), ""));
            }
        }
    }
    println!(
        "{seed}: {loaded} of {BROKEN} load, {} kinds of sentences, {most:.2} of the room",
        sentences.len()
    );
    assert!(loaded > BROKEN / 20 && loaded < BROKEN * 9 / 10, "{loaded} load");
    assert!(sentences.len() >= kinds, "{sentences:#?}");
}

/// A flat grid of so many squares a side in a stream.
fn flat(side: u32, speed: i32) -> Vec<u8> {
    let points = (side + 1) * (side + 1);
    let bytes = vec![0u8; 12 * points as usize];
    let row = side + 1;
    let squares = (0..side * side).map(|i| i / side * row + i % side);
    let triangles: Vec<_> =
        squares.flat_map(|i| [[i, i + 1, i + row], [i + 1, i + row + 1, i + row]]).collect();
    let position = (GeometryAttributeType::Position, DataType::Float32, 3, bytes.as_slice());
    let stream = compressed(&[position], &triangles, speed);
    let root = json!({
        "asset": {"version": "2.0"},
        "extensionsRequired": ["KHR_draco_mesh_compression"],
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{
            "attributes": {"POSITION": 0},
            "indices": 1,
            "extensions": {"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}},
        }]}],
        "accessors": [
            {"componentType": 5126, "type": "VEC3", "count": points},
            {"componentType": 5125, "type": "SCALAR", "count": 3 * triangles.len()},
        ],
        "bufferViews": [{"buffer": 0, "byteLength": stream.len()}],
        "buffers": [{"byteLength": stream.len()}],
    });
    let mut text = root.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut file = b"glTF\x02\0\0\0".to_vec();
    file.extend(((28 + text.len() + stream.len()) as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &stream)] {
        file.extend((chunk.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(chunk);
    }
    file
}

#[test]
fn what_unfolds_is_held_to_its_room() {
    for side in [100, 480, 1000] {
        for speed in [0, 5, 10] {
            let file = flat(side, speed);
            let (result, times) = opened(&file);
            println!(
                "{} squares, speed {speed}: {} bytes, memory {times:.2} of the room, {result:?}",
                side * side,
                file.len()
            );
            let short = result.as_ref().err().is_none_or(|e| {
                e.contains("compressed parts hold more") || e.contains("over the caller's ceiling")
            });
            assert!(short && (side > 100 || result.is_ok()), "{result:?}");
        }
    }
}
