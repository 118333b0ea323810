//! Thousands of broken files, the same ones each run: none may panic, and what loads must be whole.

use super::*;
use crate::light::outline;
use crate::scene::Camera;

/// Marsaglia's xorshift64.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    /// Below `n`, which is above 0.
    fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }
}

/// A good file in its two parts, so that a longer JSON still gets a right header.
struct Seed {
    text: Vec<u8>,
    bin: Vec<u8>,
}

impl Seed {
    fn model(name: &str) -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name);
        let file = std::fs::read(path).unwrap();
        let (text, bin) = super::super::buffers::split(&file).unwrap();
        Self { text: text.to_vec(), bin: bin.unwrap().to_vec() }
    }

    /// Everything the loader knows, in a file small enough that most changes hit something: sparse,
    /// interleaved, strips, a hierarchy, a camera, lights, a data URI.
    fn small() -> Self {
        let mut file = File::default();
        let view = file.view(&floats(&[SQUARE[0], SQUARE[1], SQUARE[2], SQUARE[3]].repeat(2)));
        file.views[view]["byteStride"] = json!(24);
        let indices = file.view(&[0, 3]);
        let values = file.view(&floats(&[SQUARE[0], [0.5; 3]]));
        let position = file.accessor(json!({
            "bufferView": view, "componentType": 5126, "type": "VEC3", "count": 4,
            "sparse": {"count": 2, "indices": {"bufferView": indices, "componentType": 5121},
                       "values": {"bufferView": values, "byteOffset": 0}}
        }));
        let normal = file.accessor(json!({
            "bufferView": view, "byteOffset": 12, "componentType": 5126, "type": "VEC3", "count": 4
        }));
        let list = file.indices(&[0, 1, 2, 1, 2, 3]);
        let primitives = json!([
            {"attributes": {"POSITION": position, "NORMAL": normal}, "indices": list},
            {"attributes": {"POSITION": position}, "mode": 5, "material": 0},
        ]);
        let light =
            json!({"area_light": "rectangle", "width": 1, "height": 0.5, "color": [1, 1, 0]});
        let root = file.root(
            &primitives,
            json!({
                "scenes": [{"nodes": [0, 3, 4]}],
                "nodes": [
                    {"name": "top", "children": [1, 2], "rotation": [0, 0, 0.6, 0.8]},
                    {"mesh": 0, "scale": [1, -2, 3], "extras": {"shadow_role": "occluder"}},
                    {"name": "lamp", "translation": [0, 4, 0], "extras": light},
                    {"mesh": 0, "camera": 0,
                     "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 4, 5, 6, 1]},
                    {"name": "panel", "scale": [1, -2, 1],
                     "extras": {"area_light": "polygon", "corners": [[0, 0], [1, 0], [0.5, 2]]}},
                ],
                "cameras": [{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}],
                "materials": [{"doubleSided": true}],
                "buffers": [{"byteLength": file.bin.len(), "uri": data_uri(&file.bin)}],
            }),
        );
        Self { text: root.to_string().into_bytes(), bin: Vec::new() }
    }

    /// A file with one to three changes.
    fn broken(&self, random: &mut Random) -> Vec<u8> {
        let (mut text, mut bin) = (self.text.clone(), self.bin.clone());
        for _ in 0..=random.below(3) {
            match random.below(8) {
                // Numbers are where lengths, counts and indices live.
                0..=3 => replace_number(&mut text, random),
                4 => swap_numbers(&mut text, random),
                5 => change_bytes(&mut text, random),
                6 if !bin.is_empty() => change_bytes(&mut bin, random),
                _ => {
                    let end = random.below(text.len() + 1);
                    text.drain(end.saturating_sub(random.below(40))..end);
                }
            }
        }
        let mut file = if self.bin.is_empty() { text } else { container(&text, &bin) };
        match random.below(16) {
            0 => file.truncate(random.below(file.len() + 1)),
            // The .glb's own headers.
            1 if file.len() > 24 => file[random.below(24)] = random.next() as u8,
            _ => {}
        }
        file
    }
}

/// Where the numbers of a JSON text are.
fn numbers(text: &[u8]) -> Vec<std::ops::Range<usize>> {
    let is_part = |c: &u8| c.is_ascii_digit() || b"+-.eE".contains(c);
    let mut found = Vec::new();
    let mut start = 0;
    while start < text.len() {
        let length = text[start..].iter().take_while(|c| is_part(c)).count();
        // Data URIs and names hold digits too, and are left to the other changes.
        let before = start.checked_sub(1).map_or(b' ', |i| text[i]);
        if length > 0 && b":[, ".contains(&before) && text[start] != b'e' && text[start] != b'E' {
            found.push(start..start + length);
        }
        start += length.max(1);
    }
    found
}

fn replace_number(text: &mut Vec<u8>, random: &mut Random) {
    const ODD: [&str; 22] = [
        "0",
        "1",
        "2",
        "3",
        "4",
        "5",
        "7",
        "12",
        "255",
        "65536",
        "-1",
        "0.5",
        "1e-300",
        "1e300",
        "1e39",
        "5121",
        "5123",
        "2147483648",
        "4294967295",
        "4294967296",
        "9223372036854775807",
        "18446744073709551615",
    ];
    let found = numbers(text);
    if !found.is_empty() {
        let range = found[random.below(found.len())].clone();
        text.splice(range, ODD[random.below(ODD.len())].bytes());
    }
}

fn swap_numbers(text: &mut Vec<u8>, random: &mut Random) {
    let found = numbers(text);
    if !found.is_empty() {
        let value = text[found[random.below(found.len())].clone()].to_vec();
        text.splice(found[random.below(found.len())].clone(), value);
    }
}

fn change_bytes(bytes: &mut [u8], random: &mut Random) {
    for _ in 0..=random.below(4) {
        if !bytes.is_empty() {
            let at = random.below(bytes.len());
            bytes[at] = if random.below(2) == 0 {
                random.next() as u8
            } else {
                // A byte from elsewhere keeps more of it readable.
                bytes[random.below(bytes.len())]
            };
        }
    }
}

/// What every scene that loads promises to those who use it.
fn check(scene: &Scene) {
    assert!(scene.triangles() > 0);
    for mesh in &scene.meshes {
        assert_eq!(mesh.positions.len(), mesh.normals.len());
        assert_eq!(mesh.indices.len() % 3, 0);
        assert!(mesh.indices.iter().all(|i| (*i as usize) < mesh.positions.len()));
        assert!(mesh.positions.as_flattened().iter().all(|c| c.is_finite()));
        for n in &mesh.normals {
            let length = DVec3::from_array(n.map(f64::from)).length();
            assert!((length - 1.0).abs() < 1e-6, "a normal of length {length}");
        }
    }
    for instance in &scene.instances {
        assert!(instance.mesh < scene.meshes.len());
        assert!(instance.world_from_mesh.is_finite());
    }
    for light in &scene.lights {
        assert!(light.light.world_from_light().is_finite());
        let [width, height] = light.light.half_extents();
        assert!(width > 0.0 && height >= 0.0);
        let problem =
            light.outline().and_then(|corners| outline::problem(corners, [width, height]));
        assert_eq!(problem, None);
    }
    for camera in [scene.camera.unwrap_or(Camera::framing(scene, 1.5)), Camera::framing(scene, 1.5)]
    {
        let x = camera.world_from_view;
        assert!(x.is_finite() && (x.determinant() - 1.0).abs() < 1e-9);
        assert!(camera.near > 0.0 && camera.yfov > 0.0);
    }
}

#[test]
#[should_panic(expected = "a normal of length")]
fn a_scene_that_is_not_whole_is_noticed() {
    let mut scene = open(&Seed::small().text).unwrap();
    scene.meshes[0].normals[0] = [0.0; 3];
    check(&scene);
}

/// Parses broken files; both outcomes must be common, or the changes test nothing.
fn fuzz(seed: &Seed, files: usize) {
    let whole =
        if seed.bin.is_empty() { seed.text.clone() } else { container(&seed.text, &seed.bin) };
    check(&open(&whole).unwrap());
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    let (mut loaded, mut sentences) = (0, std::collections::BTreeSet::new());
    for _ in 0..files {
        match open(&seed.broken(&mut random)) {
            Ok(scene) => {
                check(&scene);
                loaded += 1;
            }
            Err(sentence) => {
                assert!(!sentence.is_empty() && !sentence.contains('\n'), "{sentence:?}");
                // Without its numbers, to count kinds of sentences.
                sentences.insert(sentence.replace(|c: char| c.is_ascii_digit(), ""));
            }
        }
    }
    assert!(loaded > files / 50, "only {loaded} of {files} files load");
    assert!(sentences.len() > 20, "only these problems were met: {sentences:#?}");
}

#[test]
fn a_small_file_broken_in_twenty_thousand_ways() {
    fuzz(&Seed::small(), 20_000);
}

#[test]
fn the_bunny_broken_in_three_thousand_ways() {
    fuzz(&Seed::model("bunny.glb"), 3_000);
}

#[test]
fn suzanne_broken_in_two_thousand_ways() {
    fuzz(&Seed::model("suzanne.glb"), 2_000);
}
