//! Textures that say where a surface stops light.

use super::*;
use antumbra::scene::{Mesh, OpacityMap, Wrap};
use image::ExtendedColorType::{self, La8, Rgb8, Rgba8};
use image::ImageEncoder;
use image::codecs::{jpeg::JpegEncoder, png::PngEncoder, webp::WebPEncoder};
use std::slice::from_ref;

/// Four places of the square's corners.
pub const PLACES: [[f32; 2]; 4] = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];

pub fn png(size: [u32; 2], color: ExtendedColorType, pixels: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes).write_image(pixels, size[0], size[1], color).unwrap();
    bytes
}

/// A PNG of a row of texels with these alphas.
pub fn alphas(of: &[u8]) -> Vec<u8> {
    let pixels: Vec<u8> = of.iter().flat_map(|alpha| [9, *alpha]).collect();
    png([of.len() as u32, 1], La8, &pixels)
}

/// The square with texture coordinates, and images in views of their own.
pub fn textured(images: &[Vec<u8>]) -> (File, Value, Value) {
    let (mut file, mut primitives) = square();
    let bytes: Vec<u8> = PLACES.as_flattened().iter().flat_map(|c| c.to_le_bytes()).collect();
    let view = file.view(&bytes);
    primitives[0]["attributes"]["TEXCOORD_0"] =
        json!(file.accessor(
            json!({"bufferView": view, "componentType": 5126, "type": "VEC2", "count": 4})
        ));
    primitives[0]["material"] = json!(0);
    let listed: Vec<Value> =
        images.iter().map(|bytes| json!({"bufferView": file.view(bytes)})).collect();
    let textures: Vec<Value> = (0..images.len()).map(|i| json!({"source": i})).collect();
    (file, primitives, json!({"images": listed, "textures": textures}))
}

/// The scene of the square with a material, and images.
pub fn scene(images: &[Vec<u8>], material: Value) -> Scene {
    let (file, primitives, mut members) = textured(images);
    members["materials"] = vec![material].into();
    file.scene(&primitives, members).unwrap()
}

/// A material whose base color is `textures[0]`.
pub fn base(mode: &str, more: Value) -> Value {
    let mut material =
        json!({"alphaMode": mode, "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}});
    let Value::Object(more) = more else { panic!("members are an object") };
    for (key, value) in more {
        material[key] = value;
    }
    material
}

fn faded(mode: &str, alpha: f32, more: Value) -> Value {
    let mut material = base(mode, more);
    material["pbrMetallicRoughness"]["baseColorFactor"] = json!([1, 1, 1, alpha]);
    material
}

fn only(scene: &Scene) -> (&Mesh, &OpacityMap) {
    assert_eq!((scene.meshes.len(), scene.opacity_maps.len()), (1, 1), "{:?}", scene.notes);
    assert_eq!(scene.meshes[0].opacity_map, Some(0));
    assert!(scene.meshes[0].cut_out && scene.notes.is_empty(), "{:?}", scene.notes);
    (&scene.meshes[0], &scene.opacity_maps[0])
}

/// The mesh is not cut, and nothing is said.
fn assert_whole(scene: &Scene) {
    assert!(scene.opacity_maps.is_empty() && scene.notes.is_empty(), "{:?}", scene.notes);
    assert_eq!((scene.meshes[0].cut_out, scene.meshes[0].opacity_map), (false, None));
    assert!(scene.meshes[0].texture_coordinates.is_empty());
}

/// The mesh counts whole though it is cut, and one note has these words.
pub fn assert_told(scene: &Scene, words: &[&str]) {
    let [note] = &scene.notes[..] else { panic!("{:?}", scene.notes) };
    assert!(words.iter().all(|word| note.contains(word)), "{note}");
    assert_eq!((scene.meshes[0].cut_out, scene.meshes[0].opacity_map), (true, None));
    assert_eq!((scene.triangles(), scene.opacity_maps.len()), (2, 0));
}

#[test]
fn a_mask_is_cut_at_its_cutoff() {
    let image = alphas(&[0, 63, 128, 255]);
    let found = scene(from_ref(&image), base("MASK", json!({"alphaCutoff": 0.25})));
    let (mesh, map) = only(&found);
    assert_eq!((map.size, map.texels.as_slice()), ([4, 1], &[0, 63, 128, 255][..]));
    assert_eq!((map.cutoff, map.linear, map.wrap), (Some(0.25), true, [Wrap::Repeat; 2]));
    // A place for each vertex, which flat triangles do not share.
    let expected: Vec<_> = TWO_TRIANGLES.iter().map(|i| PLACES[*i as usize]).collect();
    assert_eq!(mesh.texture_coordinates, expected);
    assert_eq!(mesh.positions.len(), expected.len());
    // Half is the default, and a factor takes the cutoff up.
    assert_eq!(only(&scene(from_ref(&image), base("MASK", json!({})))).1.cutoff, Some(0.5));
    let fainter = scene(from_ref(&image), faded("MASK", 0.5, json!({"alphaCutoff": 0.25})));
    assert_eq!((only(&fainter).1.cutoff, &only(&fainter).1.texels), (Some(0.5), &map.texels));
    // Where all texels are on one side of it there is nothing to look up.
    assert_whole(&scene(&[alphas(&[128, 200])], base("MASK", json!({}))));
    assert_whole(&scene(from_ref(&image), base("MASK", json!({"alphaCutoff": 0.0}))));
    for nothing in [
        scene(&[alphas(&[0, 100])], base("MASK", json!({}))),
        scene(from_ref(&image), base("MASK", json!({"alphaCutoff": 1.1}))),
        scene(&[image], faded("MASK", 0.4, json!({}))),
    ] {
        let (mesh, map) = only(&nothing);
        assert_eq!((map.size, map.texels.as_slice(), map.cutoff), ([1, 1], &[0][..], None));
        assert_eq!(mesh.texture_coordinates, [[0.0; 2]; 6]);
    }
}

#[test]
fn a_blended_surface_stops_as_much_as_its_alpha() {
    let image = alphas(&[0, 51, 255]);
    let found = scene(from_ref(&image), base("BLEND", json!({})));
    assert_eq!(
        (only(&found).1.texels.as_slice(), only(&found).1.cutoff),
        (&[0, 51, 255][..], None)
    );
    let found = scene(from_ref(&image), faded("BLEND", 0.6, json!({})));
    assert_eq!(only(&found).1.texels, [0, 31, 153]);
    let found = scene(&[image], faded("BLEND", 0.0, json!({})));
    assert_eq!(only(&found).1.texels, [0]);
    // Sixteen bits a channel are rounded.
    let wide: Vec<u8> =
        [0u16, 128, 129, 65_535, 40_000, 65_407].iter().flat_map(|of| of.to_ne_bytes()).collect();
    let image = png([3, 1], ExtendedColorType::La16, &wide);
    assert_eq!(only(&scene(&[image], base("BLEND", json!({})))).1.texels, [0, 255, 255]);
    assert_whole(&scene(&[alphas(&[255, 255])], base("BLEND", json!({}))));
    assert_whole(&scene(&[], json!({"alphaMode": "BLEND"})));
    assert_whole(&scene(&[], json!({"alphaMode": "MASK"})));
    assert_whole(&scene(&[alphas(&[0, 255])], base("OPAQUE", json!({}))));
    let constant = |mode: &str| {
        scene(
            &[],
            json!({"alphaMode": mode, "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.4]}}),
        )
    };
    assert_eq!(only(&constant("BLEND")).1.texels, [102]);
    assert_eq!(only(&constant("MASK")).1.texels, [0]);
}

#[test]
fn the_older_materials_are_read_too() {
    let extension = json!({"diffuseFactor": [1, 1, 1, 0.5], "diffuseTexture": {"index": 0}});
    let material = json!({
        "alphaMode": "BLEND",
        "extensions": {"KHR_materials_pbrSpecularGlossiness": extension},
    });
    assert_eq!(only(&scene(&[alphas(&[0, 255])], material)).1.texels, [0, 128]);
}

#[test]
fn glass_stops_what_it_does_not_transmit() {
    let glass = |of: Value| json!({"extensions": {"KHR_materials_transmission": of}});
    let found = scene(&[], glass(json!({"transmissionFactor": 0.8})));
    assert_eq!((only(&found).1.texels.as_slice(), only(&found).1.cutoff), (&[51][..], None));
    assert_whole(&scene(&[], glass(json!({}))));
    // Its red, whatever the alpha.
    let image = png([2, 1], Rgba8, &[255, 0, 0, 7, 51, 9, 9, 0]);
    let of = glass(json!({"transmissionFactor": 0.5, "transmissionTexture": {"index": 0}}));
    assert_eq!(only(&scene(from_ref(&image), of.clone())).1.texels, [128, 230]);
    // Half of the light meets what is left.
    let mut half = of.clone();
    half["alphaMode"] = json!("BLEND");
    half["pbrMetallicRoughness"] = json!({"baseColorFactor": [1, 1, 1, 0.5]});
    assert_eq!(only(&scene(from_ref(&image), half)).1.texels, [64, 115]);
    // Red of a JPEG, which has losses.
    let mut bytes = Vec::new();
    let reds = [[200, 0, 0]; 128].concat().into_iter().chain([[40, 0, 0]; 128].concat());
    JpegEncoder::new_with_quality(&mut bytes, 100)
        .write_image(&reds.collect::<Vec<u8>>(), 16, 16, Rgb8)
        .unwrap();
    let found = scene(&[bytes], of.clone());
    let texels = &only(&found).1.texels;
    assert!(texels[0].abs_diff(155) <= 3 && texels[255].abs_diff(235) <= 3, "{texels:?}");
    // Two textures of one surface are more than a map holds.
    let mut both = of;
    both["alphaMode"] = json!("BLEND");
    both["pbrMetallicRoughness"] = json!({"baseColorTexture": {"index": 0}});
    let found = scene(&[image], both);
    assert_eq!(found.opacity_maps[0].texels, [7, 0]);
    assert!(found.notes[0].contains("the alpha alone counts"), "{:?}", found.notes);
}

#[test]
fn samplers_say_how_a_texture_goes_on() {
    let sampled = |sampler: Value| {
        let (file, primitives, mut members) = textured(&[alphas(&[0, 255])]);
        members["materials"] = json!([base("BLEND", json!({}))]);
        members["textures"] = json!([{"source": 0, "sampler": 1}]);
        members["samplers"] = json!([{}, sampler]);
        file.scene(&primitives, members).unwrap()
    };
    let found = sampled(json!({"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}));
    assert_eq!((only(&found).1.wrap, only(&found).1.linear), ([Wrap::Clamp, Wrap::Mirror], false));
    let found = sampled(json!({"wrapT": 33071, "minFilter": 9984, "magFilter": 9729}));
    assert_eq!((only(&found).1.wrap, only(&found).1.linear), ([Wrap::Repeat, Wrap::Clamp], true));
    let odd = sampled(json!({"wrapS": 1, "magFilter": 2}));
    assert_eq!((only(&odd).1.wrap, only(&odd).1.linear), ([Wrap::Repeat; 2], true));
}

/// Scaled, then turned about the first texel's corner, then moved.
#[test]
fn a_texture_transform_is_in_the_coordinates() {
    let transformed = |transform: Value| {
        let (mut file, mut primitives, mut members) = textured(&[alphas(&[0, 255])]);
        let other: Vec<u8> = [0.5f32; 8].iter().flat_map(|c| c.to_le_bytes()).collect();
        let view = file.view(&other);
        primitives[0]["attributes"]["TEXCOORD_3"] = json!(file.accessor(
            json!({"bufferView": view, "componentType": 5126, "type": "VEC2", "count": 4})
        ));
        let mut material = base("BLEND", json!({}));
        material["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] =
            json!({"KHR_texture_transform": transform, "other": [1, {"a": null}]});
        members["materials"] = json!([material]);
        let found = file.scene(&primitives, members).unwrap();
        only(&found).0.texture_coordinates.clone()
    };
    let moved = transformed(json!({"offset": [0.25, -2]}));
    assert_eq!(moved[..3], [[0.25, -1.0], [1.25, -1.0], [1.25, -2.0]]);
    assert_eq!(transformed(json!({"scale": [2, 3]}))[..3], [[0.0, 3.0], [2.0, 3.0], [2.0, 0.0]]);
    let turned = transformed(json!({"offset": [5, 7], "rotation": 0.5f64.atan(), "scale": [2, 1]}));
    let (sin, cos) = 0.5f64.atan().sin_cos();
    for (found, [u, v]) in turned.iter().zip([[0.0, 1.0], [2.0, 1.0], [2.0, 0.0]]) {
        let expected = [cos * u - sin * v + 5.0, sin * u + cos * v + 7.0];
        let off = [0, 1].map(|i| (f64::from(found[i]) - expected[i]).abs());
        assert!(off.iter().all(|off| *off < 1e-6), "{found:?}, {expected:?}");
    }
    assert_eq!(transformed(json!({"texCoord": 3})), [[0.5; 2]; 6]);
    let none = transformed(json!({}));
    assert_eq!(none[..3], [PLACES[0], PLACES[1], PLACES[2]]);
}

#[test]
fn images_lie_in_views_uris_and_files() {
    let (file, primitives, mut members) = textured(&[]);
    members["materials"] = json!([base("BLEND", json!({}))]);
    members["textures"] = json!([{"source": 0}]);
    let image = alphas(&[3, 4]);
    let of = |uri: &str| {
        let mut members = members.clone();
        members["images"] = json!([{"uri": uri, "mimeType": "image/png"}]);
        glb(&file.root(&primitives, members), &file.bin)
    };
    let uri = data_uri(&image).replace("application/octet-stream", "image/png");
    assert_eq!(only(&open(&of(&uri)).unwrap()).1.texels, [3, 4]);
    let folder = Folder::new("textures");
    folder.write("below/a b.png", &image);
    folder.write("outside.png", &image);
    let path = folder.write("below/scene.glb", &of("a%20b.png"));
    assert_eq!(only(&from_gltf(&path).unwrap()).1.texels, [3, 4]);
    for (uri, words) in [
        ("../outside.png", "must be a relative path to a file in the scene's folder"),
        ("/etc/passwd", "must be a relative path"),
        ("none.png", "cannot be read"),
        ("scene.glb", "its bytes are no PNG, JPEG or WebP"),
    ] {
        let path = folder.write("below/scene.glb", &of(uri));
        assert_told(&from_gltf(&path).unwrap(), &["images[0]", words]);
    }
}

#[test]
fn what_has_no_alpha_is_whole() {
    let mut jpeg = Vec::new();
    JpegEncoder::new(&mut jpeg).write_image(&[0; 12], 2, 2, Rgb8).unwrap();
    for image in [jpeg, png([2, 1], Rgb8, &[0; 6])] {
        assert_whole(&scene(from_ref(&image), base("BLEND", json!({}))));
        assert_whole(&scene(&[image], base("MASK", json!({}))));
    }
}

#[test]
fn webp_is_read_where_a_texture_has_nothing_else() {
    let mut webp = Vec::new();
    WebPEncoder::new_lossless(&mut webp)
        .write_image(&[1, 2, 3, 4, 5, 6, 7, 8], 2, 1, Rgba8)
        .unwrap();
    let (file, primitives, mut members) = textured(&[alphas(&[9, 10]), webp]);
    members["materials"] = json!([base("BLEND", json!({}))]);
    members["textures"][0] = json!({"extensions": {"EXT_texture_webp": {"source": 1}}});
    assert_eq!(only(&file.scene(&primitives, members.clone()).unwrap()).1.texels, [4, 8]);
    members["textures"][0]["source"] = json!(0);
    assert_eq!(only(&file.scene(&primitives, members.clone()).unwrap()).1.texels, [9, 10]);
    members["textures"][0] = json!({"extensions": {"KHR_texture_basisu": {"source": 1}}});
    assert_told(&file.scene(&primitives, members).unwrap(), &["textures[0]", "PNG, JPEG and WebP"]);
}
