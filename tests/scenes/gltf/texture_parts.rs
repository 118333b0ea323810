//! Meshes of many textures, and textures that cannot be read or placed.

use super::textures::{PLACES, alphas, assert_told, base, png, scene, textured};
use super::*;
use image::ExtendedColorType::{self, La8};
use std::slice::from_ref;

/// An accessor of the square's places.
fn places(file: &mut File, bytes: &[u8], component: u32, normalized: bool) -> usize {
    let view = file.view(bytes);
    file.accessor(json!({
        "bufferView": view, "componentType": component, "normalized": normalized, "type": "VEC2", "count": 4
    }))
}

#[test]
fn a_mesh_is_in_parts_by_what_stops_its_light() {
    let (file, primitives, mut members) =
        textured(&[alphas(&[0, 255]), alphas(&[9, 200]), b"no image".to_vec()]);
    let of = |texture: usize| {
        let mut material = base("BLEND", json!({}));
        material["pbrMetallicRoughness"]["baseColorTexture"]["index"] = json!(texture);
        material
    };
    let mut both_sides = of(0);
    both_sides["doubleSided"] = json!(true);
    // Whole, of one texture, of the same one again, of another, of one that is broken, and of two sides.
    members["materials"] = json!([{}, of(0), {"name": "same", "alphaMode": "BLEND",
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}, of(1), of(2), both_sides]);
    let with = |material: usize| {
        let mut primitive = primitives[0].clone();
        primitive["material"] = json!(material);
        primitive
    };
    let all = [3, 1, 0, 5, 4, 2, 0, 1].map(with);
    let scene = file.scene(&json!(all), members).unwrap();
    assert_eq!(scene.opacity_maps.len(), 2);
    let parts: Vec<_> = scene
        .meshes
        .iter()
        .map(|m| (m.double_sided, m.cut_out, m.opacity_map, m.indices.len() / 3))
        .collect();
    // The first primitive's texture is the first.
    assert_eq!(
        parts,
        [
            (false, false, None, 4),
            (false, true, None, 2),
            (false, true, Some(0), 2),
            (false, true, Some(1), 6),
            (true, true, Some(1), 2),
        ]
    );
    for mesh in &scene.meshes {
        let places = mesh.texture_coordinates.len();
        assert_eq!(places, mesh.opacity_map.map_or(0, |_| mesh.positions.len()));
    }
    assert_eq!(scene.meshes[3].texture_coordinates[6..9], [PLACES[0], PLACES[1], PLACES[2]]);
    assert!(scene.instances.iter().all(|i| i.name == "thing"));
    let [note] = &scene.notes[..] else { panic!("{:?}", scene.notes) };
    assert!(note.contains("images[2]") && note.contains("materials[4]"), "{note}");
}

#[test]
fn maps_are_one_where_they_are_the_same() {
    let (file, primitives, mut members) = textured(&[alphas(&[0, 255])]);
    members["textures"] = json!([{"source": 0}, {"source": 0, "sampler": 0}]);
    members["samplers"] = json!([{"magFilter": 9728}]);
    let mut other = base("MASK", json!({}));
    other["pbrMetallicRoughness"]["baseColorTexture"]["index"] = json!(1);
    let moved = json!({"KHR_texture_transform": {"offset": [1, 1]}});
    let mut placed = base("MASK", json!({}));
    placed["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] = moved;
    members["materials"] = json!([
        base("MASK", json!({})),
        base("MASK", json!({"alphaCutoff": 0.5})),
        base("MASK", json!({"alphaCutoff": 0.3})),
        base("BLEND", json!({})),
        other,
        placed,
    ]);
    let mesh = |material: usize| {
        let mut primitives = primitives.clone();
        primitives[0]["material"] = json!(material);
        json!({"primitives": primitives})
    };
    members["meshes"] = (0..6).map(mesh).collect();
    members["nodes"] = (0..6).map(|mesh| json!({"mesh": mesh})).collect();
    members["scenes"] = json!([{"nodes": [0, 1, 2, 3, 4, 5]}]);
    let scene = file.scene(&json!([]), members).unwrap();
    let maps: Vec<_> =
        scene.instances.iter().map(|i| scene.meshes[i.mesh].opacity_map.unwrap()).collect();
    assert_eq!(maps, [0, 0, 1, 2, 3, 0]);
    let meshes: Vec<_> = scene.instances.iter().map(|i| i.mesh).collect();
    assert_eq!(meshes, [0, 0, 1, 2, 3, 4], "what looks the same is one mesh");
}

#[test]
fn coordinates_may_be_integers() {
    let bytes: Vec<u8> = PLACES.as_flattened().iter().map(|c| (c * 255.0) as u8).collect();
    let shorts: Vec<u8> =
        PLACES.as_flattened().iter().flat_map(|c| ((c * 65_535.0) as u16).to_le_bytes()).collect();
    let tiled: Vec<u8> =
        PLACES.as_flattened().iter().flat_map(|c| ((c * -3.0) as i16).to_le_bytes()).collect();
    for (bytes, component, normalized, times) in
        [(bytes, 5121, true, 1.0), (shorts, 5123, true, 1.0), (tiled, 5122, false, -3.0)]
    {
        let (mut file, mut primitives, mut members) = textured(&[alphas(&[0, 255])]);
        primitives[0]["attributes"]["TEXCOORD_0"] =
            json!(places(&mut file, &bytes, component, normalized));
        members["materials"] = json!([base("BLEND", json!({}))]);
        members["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
        let found = file.scene(&primitives, members).unwrap();
        let expected: Vec<_> =
            TWO_TRIANGLES.iter().map(|i| PLACES[*i as usize].map(|c| c * times)).collect();
        assert_eq!(found.meshes[0].texture_coordinates, expected, "{component}");
    }
}

/// A vertex that triangles share keeps its one place.
#[test]
fn shared_vertices_have_a_place_each() {
    let (mut file, mut primitives, mut members) = textured(&[alphas(&[0, 255])]);
    primitives[0]["attributes"]["NORMAL"] = json!(file.vectors(&[[0.0, 0.0, 1.0]; 4]));
    members["materials"] = json!([base("BLEND", json!({}))]);
    let both = json!([primitives[0], primitives[0]]);
    let found = file.scene(&both, members).unwrap();
    assert_eq!(found.meshes[0].texture_coordinates, [PLACES, PLACES].concat());
    assert_eq!(found.meshes[0].positions.len(), 8);
}

#[test]
fn what_cannot_be_read_is_told_and_counts_whole() {
    let blend = || base("BLEND", json!({}));
    let whole = alphas(&[0, 255]);
    let mut broken = whole.clone();
    let middle = broken.len() / 2;
    broken[middle] ^= 0x55;
    assert_told(
        &scene(&[broken], blend()),
        &["images[0] cannot be read", "materials[0] counts whole"],
    );
    let cut_off = whole[..whole.len() - 20].to_vec();
    assert_told(&scene(&[cut_off], blend()), &["images[0] cannot be read"]);
    assert_told(&scene(&[vec![]], blend()), &["images[0] cannot be read"]);
    assert_told(&scene(&[], blend()), &["materials[0] refers to textures[0], and the file has 0"]);
    let odd = scene(from_ref(&whole), base("GLITTER", json!({})));
    assert_told(&odd, &["the alphaMode of materials[0] is not OPAQUE, MASK or BLEND"]);
    let mut wrong = blend();
    wrong["pbrMetallicRoughness"]["baseColorFactor"] = json!("red");
    assert_told(&scene(from_ref(&whole), wrong), &["materials[0] is wrong: invalid type"]);
    // Where nothing cuts there is nothing to tell.
    let mut opaque = json!({"doubleSided": true, "emissiveFactor": "bright"});
    let found = scene(&[], opaque.clone());
    assert!(found.notes.is_empty() && !found.meshes[0].cut_out && found.meshes[0].double_sided);
    opaque["alphaMode"] = json!("BLEND");
    assert!(scene(&[], opaque).meshes[0].cut_out);
    // Whatever the rest of the document is.
    for (key, value) in [
        ("textures", json!({"a": 1})),
        ("textures", json!([5])),
        ("textures", json!([{"source": 7}])),
        ("textures", json!([{"source": 0, "sampler": 3}])),
        ("images", json!([[]])),
        ("images", json!([{}])),
        ("images", json!([{"bufferView": 99}])),
        ("images", json!([{"uri": "data:,"}])),
    ] {
        let (file, primitives, mut members) = textured(from_ref(&whole));
        members["materials"] = json!([blend()]);
        members[key] = value;
        assert_told(&file.scene(&primitives, members).unwrap(), &["materials[0] counts whole"]);
    }
}

/// The checksum of a PNG's chunk.
fn checksum(bytes: &[u8]) -> u32 {
    let step = |crc: u32, _| if crc & 1 == 1 { crc >> 1 ^ 0xEDB8_8320 } else { crc >> 1 };
    !bytes.iter().fold(!0, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), step))
}

/// A PNG that says it has another size than its bytes are for.
fn claiming(size: [u32; 2]) -> Vec<u8> {
    let mut bytes = png([2, 1], La8, &[0, 1, 2, 3]);
    bytes[16..24].copy_from_slice(&size.map(u32::to_be_bytes).concat());
    let of_head = checksum(&bytes[12..29]);
    bytes[29..33].copy_from_slice(&of_head.to_be_bytes());
    bytes
}

#[test]
fn an_image_of_more_texels_than_a_file_may_have_is_not_decoded() {
    let found = scene(&[claiming([50_000, 50_000])], base("BLEND", json!({})));
    assert_told(&found, &["images[0]", "it has 50000 × 50000 texels"]);
    let found = scene(&[claiming([u32::MAX >> 1; 2])], base("BLEND", json!({})));
    assert_told(&found, &["images[0] cannot be read"]);
    // It is the bytes that are missing here.
    let found = scene(&[claiming([20, 20])], base("BLEND", json!({})));
    assert_told(&found, &["images[0] cannot be read"]);
    assert!(!found.notes[0].contains("texels;"), "{:?}", found.notes);
}

/// Each is within what one may have, and all are not within what they may have together.
#[test]
fn all_images_of_a_file_share_what_they_may_have() {
    let side = 4096;
    let mut pixels = vec![0; 2 * side * side];
    pixels[1] = 255;
    let image = png([side as u32; 2], La8, &pixels);
    let (file, primitives, mut members) = textured(&vec![image; 6]);
    let materials = (0..6).map(|texture| {
        let mut material = base("BLEND", json!({}));
        material["pbrMetallicRoughness"]["baseColorTexture"]["index"] = json!(texture);
        material
    });
    members["materials"] = materials.collect();
    let with = |material: usize| {
        let mut primitive = primitives[0].clone();
        primitive["material"] = json!(material);
        primitive
    };
    let scene = file.scene(&(0..6).map(with).collect(), members).unwrap();
    // An image and its map are 32 Mi texels: two are 64 Mi, and another is no more than 32 for each byte.
    assert!((2..6).contains(&scene.opacity_maps.len()), "{}", scene.opacity_maps.len());
    assert!(
        scene.notes[0].contains("have more than 64 Mi texels and 32 for each"),
        "{:?}",
        scene.notes
    );
}

#[test]
fn a_texture_without_a_place_is_told_and_counts_whole() {
    let with = |change: &dyn Fn(&mut File, &mut Value)| {
        let (mut file, mut primitives, mut members) = textured(&[alphas(&[0, 255])]);
        members["materials"] = json!([base("BLEND", json!({}))]);
        change(&mut file, &mut primitives[0]["attributes"]);
        let mut scene = file.scene(&primitives, members).unwrap();
        // The map is there, and no mesh has it.
        scene.opacity_maps.clear();
        scene
    };
    let none =
        with(&|_, attributes| drop(attributes.as_object_mut().unwrap().remove("TEXCOORD_0")));
    assert_told(&none, &["mesh \"shape\": it has no TEXCOORD_0", "it counts whole"]);
    let beyond = with(&|_, attributes| attributes["TEXCOORD_0"] = json!(99));
    assert_told(&beyond, &["mesh \"shape\": TEXCOORD_0 refers to accessors[99]"]);
    let positions =
        with(&|_, attributes| attributes["TEXCOORD_0"] = attributes["POSITION"].clone());
    assert_told(&positions, &["it must hold VEC2 of 5126"]);
    for number in [f32::NAN, f32::INFINITY] {
        let odd = with(&|file, attributes| {
            let mut all = PLACES;
            all[2][1] = number;
            let bytes: Vec<u8> = all.as_flattened().iter().flat_map(|c| c.to_le_bytes()).collect();
            attributes["TEXCOORD_0"] = json!(places(file, &bytes, 5126, false));
        });
        assert_told(&odd, &["its TEXCOORD_0 has no finite number for corner 2"]);
    }
    let colored = with(&|file, attributes| {
        let view = file.view(&[255; 16]);
        attributes["COLOR_0"] = json!(file.accessor(json!(
            {"bufferView": view, "componentType": 5121, "normalized": true, "type": "VEC4", "count": 4}
        )));
    });
    assert_eq!(colored.meshes[0].opacity_map, Some(0));
    assert!(colored.notes[0].contains("an alpha in its COLOR_0, which is passed over"));
}

/// Nodes that share a mesh of many surfaces must not multiply without end.
#[test]
fn more_parts_than_bytes_allow_are_refused() {
    let (file, primitives, mut members) = textured(&[]);
    let material = |i: usize| json!({"alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, i as f64 / 255.0]}});
    members["materials"] = (0..200).map(material).collect();
    let with = |material: usize| {
        let mut primitive = primitives[0].clone();
        primitive["material"] = json!(material);
        primitive
    };
    let nodes = |count: usize| {
        let mut members = members.clone();
        members["nodes"] = vec![json!({"mesh": 0}); count].into();
        members["scenes"] = json!([{"nodes": (0..count).collect::<Vec<_>>()}]);
        file.scene(&(0..200).map(with).collect(), members)
    };
    assert_eq!(nodes(10).unwrap().instances.len(), 2000);
    let found = nodes(1000).unwrap_err();
    assert!(found.contains("fewer nodes must share a mesh of so many materials"), "{found}");
}

#[test]
fn notes_come_to_an_end() {
    let (file, primitives, mut members) = textured(&[]);
    members["materials"] = vec![json!({"alphaMode": "GLITTER"}); 100].into();
    let with = |material: usize| {
        let mut primitive = primitives[0].clone();
        primitive["material"] = json!(material);
        primitive
    };
    let found = file.scene(&(0..100).map(with).collect(), members).unwrap();
    assert_eq!(found.notes.len(), 33);
    assert_eq!(found.notes[32], "there would be 68 more notes on the file");
    assert_eq!(found.meshes.len(), 1);
}

/// The file that `tests/files/untrusted` and the fuzzer break; `ANTUMBRA_WRITE_SEED=1` writes it anew.
#[test]
fn the_fuzzers_seed_loads() {
    let path = antumbra_tests::example::root().join("fuzz/seeds/textures.glb");
    if std::env::var("ANTUMBRA_WRITE_SEED").is_ok() {
        let steps: Vec<u8> = (0..64).map(|i| 4 * i).collect();
        let pixels = |channels: usize| -> Vec<u8> {
            steps.iter().flat_map(|step| vec![*step; channels]).collect()
        };
        let (mut jpeg, mut webp) = (Vec::new(), Vec::new());
        let encoder = image::codecs::jpeg::JpegEncoder::new(&mut jpeg);
        image::ImageEncoder::write_image(encoder, &pixels(1), 8, 8, ExtendedColorType::L8).unwrap();
        let encoder = image::codecs::webp::WebPEncoder::new_lossless(&mut webp);
        image::ImageEncoder::write_image(encoder, &pixels(4), 8, 8, ExtendedColorType::Rgba8)
            .unwrap();
        let (mut file, primitives, mut members) =
            textured(&[png([8, 8], La8, &pixels(2)), jpeg, webp]);
        let shorts: Vec<u8> = PLACES.as_flattened().iter().map(|c| (c * 255.0) as u8).collect();
        let second = places(&mut file, &shorts, 5121, true);
        members["textures"] = json!([
            {"source": 0, "sampler": 0}, {"source": 1}, {"extensions": {"EXT_texture_webp": {"source": 2}}},
            {"source": 3, "sampler": 1},
        ]);
        let inside = json!({"uri": data_uri(&alphas(&[0, 9])), "mimeType": "image/png"});
        members["images"].as_array_mut().unwrap().push(inside);
        members["samplers"] = json!([{"wrapS": 33071, "magFilter": 9728}, {"wrapT": 33648}]);
        let mut faded = base("BLEND", json!({"doubleSided": true}));
        faded["pbrMetallicRoughness"] = json!({
            "baseColorFactor": [1, 1, 1, 0.5],
            "baseColorTexture": {"index": 2, "texCoord": 1, "extensions": {"KHR_texture_transform": {
                "offset": [0.5, 1], "rotation": 1, "scale": [2, 3], "texCoord": 0
            }}},
        });
        members["materials"] = json!([
            base("MASK", json!({"alphaCutoff": 0.3})),
            faded,
            {"extensions": {"KHR_materials_transmission":
                {"transmissionFactor": 0.5, "transmissionTexture": {"index": 1, "texCoord": 1}}}},
            {"alphaMode": "BLEND", "extensions": {"KHR_materials_pbrSpecularGlossiness":
                {"diffuseFactor": [1, 1, 1, 0.9], "diffuseTexture": {"index": 3}}}},
            {
                "alphaMode": "MASK", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.1]},
                "emissiveFactor": [1, 0.5, 0], "emissiveTexture": {"index": 0},
                "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 3}},
            },
        ]);
        members["extensions"] = json!({
            "EXT_lights_area": {"lights": [{"type": "rect", "size": 0.5, "rect": {"aspect": 2}}]},
            "KHR_lights_area": {"lights": [{"shape": "sphere", "radius": 0.25, "intensity": 3}]},
        });
        members["nodes"] = json!([
            {"name": "thing", "mesh": 0},
            {"name": "panel", "extensions": {"EXT_lights_area": {"light": 0}}},
            {"name": "ball", "extensions": {"KHR_lights_area": {"light": 0}}},
        ]);
        members["scenes"] = json!([{"nodes": [0, 1, 2]}]);
        let with = |material: usize| {
            let mut primitive = primitives[0].clone();
            primitive["material"] = json!(material);
            primitive["attributes"]["TEXCOORD_1"] = json!(second);
            primitive
        };
        let root = file.root(&(0..5).map(with).collect(), members);
        std::fs::write(&path, glb(&root, &file.bin)).unwrap();
    }
    let scene = from_gltf(&path).unwrap();
    assert!(scene.notes.is_empty(), "{:?}", scene.notes);
    assert_eq!((scene.meshes.len(), scene.opacity_maps.len(), scene.lights.len()), (5, 5, 2));
}
