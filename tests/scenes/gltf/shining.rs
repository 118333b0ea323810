//! Meshes that shine, and lights of the drafts for area lights.

use super::*;
use antumbra::Shape;
use antumbra::scene::{AreaLight, GltfOptions, Role, from_gltf_as};

/// The scene of a file, with what shines as lights.
fn shining(name: &str, root: &Value, bin: &[u8]) -> Scene {
    let folder = Folder::new(&format!("shining {name}"));
    let path = folder.write("scene.glb", &glb(root, bin));
    from_gltf_as(&path, &GltfOptions { emissive: true, ..GltfOptions::default() }).unwrap()
}

/// A floor, and a lamp of these triangles at a node of these members.
fn lamp(name: &str, points: &[[f32; 3]], indices: &[u32], node: Value) -> Scene {
    let (mut file, mut primitives) = square();
    primitives[0]["attributes"]["POSITION"] = json!(file.vectors(points));
    primitives[0]["indices"] = json!(file.indices(indices));
    primitives[0]["material"] = json!(0);
    let (floor, _) = (file.vectors(&SQUARE), 0);
    let mut lamp = node;
    lamp["mesh"] = json!(0);
    lamp["name"] = json!("lamp");
    let root = file.root(
        &primitives,
        json!({
            "meshes": [
                {"primitives": primitives},
                {"primitives": [{"attributes": {"POSITION": floor}, "mode": 6}]},
            ],
            "nodes": [lamp, {"mesh": 1, "name": "floor"}],
            "scenes": [{"nodes": [0, 1]}],
            "materials": [{
                "emissiveFactor": [1, 0.5, 0],
                "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 8}},
            }],
        }),
    );
    assert!(open(&glb(&root, &file.bin)).unwrap().lights.is_empty(), "it is on request alone");
    shining(name, &root, &file.bin)
}

fn center(light: &AreaLight) -> DVec3 {
    light.light.rectangle().center()
}

/// The corners of a light in the world, in order.
fn outline(light: &AreaLight) -> Vec<DVec3> {
    let world = light.light.rectangle().world_from_light();
    let corners = light.light.outline().unwrap();
    corners.iter().map(|[x, y]| world.transform_point3(DVec3::new(*x, *y, 0.0))).collect()
}

#[test]
fn a_rectangle_shines_as_one() {
    let scene = lamp(
        "square",
        &SQUARE,
        &TWO_TRIANGLES,
        json!({"translation": [0, 2, 0], "scale": [4, 2, 1]}),
    );
    let [light] = &scene.lights[..] else { panic!("{:?}", scene.lights) };
    assert!(scene.notes.is_empty(), "{:?}", scene.notes);
    assert!(matches!(light.light.shape(), Shape::Rectangle));
    assert_eq!(center(light), DVec3::new(2.0, 3.0, 0.0));
    assert_eq!(light.light.rectangle().half_extents(), [2.0, 1.0]);
    assert_eq!(light.light.emission(), DVec3::Z);
    assert_eq!((light.name.as_str(), light.color, light.intensity), ("lamp", [1.0, 0.5, 0.0], 8.0));
    // What shines stands in no light's way.
    let roles: Vec<_> = scene.instances.iter().map(|i| (i.name.as_str(), i.role)).collect();
    assert_eq!(roles, [("lamp", Role::Receiver), ("floor", Role::Both)]);
    // Fronts stay fronts where a node mirrors.
    let scene = lamp("mirrored", &SQUARE, &TWO_TRIANGLES, json!({"scale": [-1, 1, 1]}));
    assert_eq!(scene.lights[0].light.emission(), DVec3::Z);
    assert_eq!(center(&scene.lights[0]), DVec3::new(-0.5, 0.5, 0.0));
}

/// Points in line, and triangles in any order, make no difference.
#[test]
fn a_plane_outline_shines_as_a_polygon() {
    // An L of three squares, with the middles of two sides among its corners.
    let points = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [2.0, 0.0, 0.0],
        [2.0, 0.0, 1.0],
        [1.0, 0.0, 1.0],
        [1.0, 0.0, 2.0],
        [0.0, 0.0, 2.0],
        [0.0, 0.0, 1.0],
    ];
    let quads = [[0, 7, 4, 1], [1, 4, 3, 2], [7, 6, 5, 4]];
    let indices: Vec<u32> =
        quads.iter().flat_map(|[a, b, c, d]| [*a, *b, *c, *a, *c, *d]).collect();
    let scene = lamp("ell", &points, &indices, json!({}));
    let [light] = &scene.lights[..] else { panic!("{:?}", scene.lights) };
    assert!((light.light.emission() - DVec3::Y).length() < 1e-12);
    assert_eq!(light.intensity, 8.0);
    let found = outline(light);
    assert_eq!(found.len(), 6);
    for corner in [0, 2, 3, 4, 5, 6].map(|i: usize| DVec3::from_array(points[i].map(f64::from))) {
        assert!(found.iter().any(|p| (p - corner).length() < 1e-9), "{corner} in {found:?}");
    }
    assert!(scene.notes.is_empty(), "{:?}", scene.notes);
}

#[test]
fn a_box_shines_from_six_sides() {
    let points: Vec<[f32; 3]> =
        (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2 & 1].map(|of| of as f32)).collect();
    let quads =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let indices: Vec<u32> =
        quads.iter().flat_map(|[a, b, c, d]| [*a, *b, *c, *a, *c, *d]).collect();
    let scene = lamp("box", &points, &indices, json!({}));
    assert_eq!(scene.lights.len(), 6);
    for light in &scene.lights {
        let out = center(light) - DVec3::splat(0.5);
        assert!((light.light.emission() - 2.0 * out).length() < 1e-12, "outwards");
        assert_eq!(light.light.rectangle().half_extents(), [0.5, 0.5]);
    }
    assert!(scene.notes.is_empty(), "{:?}", scene.notes);
}

/// A fan of triangles about a point at a height: a disc where that is 0.
fn cone(sides: u32, height: f32) -> (Vec<[f32; 3]>, Vec<u32>) {
    let rim = |i: u32| {
        let (sin, cos) = (f64::from(i) / f64::from(sides) * std::f64::consts::TAU).sin_cos();
        [cos as f32, sin as f32, 0.0]
    };
    let points = (0..sides).map(rim).chain([[0.0, 0.0, height]]).collect();
    (points, (0..sides).flat_map(|i| [i, (i + 1) % sides, sides]).collect())
}

/// A disc is a polygon of as many corners as there may be, as bright as all of it.
#[test]
fn what_is_lost_is_made_up_for_or_told() {
    let (points, indices) = cone(40, 0.0);
    let scene = lamp("disc", &points, &indices, json!({}));
    let [light] = &scene.lights[..] else { panic!("{:?}", scene.lights) };
    let corners = light.light.outline().unwrap();
    assert_eq!(corners.len(), 16);
    let after = |i: usize| corners[(i + 1) % 16];
    let cross = |(i, p): (usize, &[f64; 2])| p[0] * after(i)[1] - p[1] * after(i)[0];
    let area = 0.5 * corners.iter().enumerate().map(cross).sum::<f64>();
    let whole = 20.0 * (std::f64::consts::TAU / 40.0).sin();
    assert!((f64::from(light.intensity) - 8.0 * whole / area).abs() < 1e-5, "{}", light.intensity);
    assert!(area > 0.95 * whole && area < whole);
    // Of a cone the eight largest of its sides, which are as large as each other.
    let (points, indices) = cone(40, 1.0);
    let scene = lamp("cone", &points, &indices, json!({}));
    assert_eq!(scene.lights.len(), 8);
    let [note] = &scene.notes[..] else { panic!("{:?}", scene.notes) };
    assert_eq!(
        note,
        "of the 40 plane parts of what shines at \"lamp\", 8 are lights; the others, 80.0 % of its area, are none"
    );
}

/// A frame around a hole shines as much as it would, from within its outline.
#[test]
fn a_hole_makes_the_rest_brighter() {
    let at = |i: u32| [i % 4, i / 4].map(|of| of as f32);
    let points: Vec<[f32; 3]> = (0..16).map(|i| [at(i)[0], at(i)[1], 0.0]).collect();
    let quads = (0..11).filter(|i| i % 4 != 3 && *i != 5);
    let indices: Vec<u32> = quads.flat_map(|i| [i, i + 1, i + 5, i, i + 5, i + 4]).collect();
    let scene = lamp("frame", &points, &indices, json!({}));
    let [light] = &scene.lights[..] else { panic!("{:?}", scene.lights) };
    assert_eq!(light.light.rectangle().half_extents(), [1.5, 1.5]);
    assert!((light.intensity - 64.0 / 9.0).abs() < 1e-5, "{}", light.intensity);
}

#[test]
fn many_meshes_that_shine_are_as_many_lights_as_a_node_has() {
    let (mut file, mut primitives) = square();
    primitives[0]["material"] = json!(0);
    let floor = file.vectors(&SQUARE);
    let nodes: Vec<Value> =
        (0..70).map(|i| json!({"mesh": 0, "translation": [2 * i, 0, 0]})).collect();
    let meshes = json!([{"primitives": primitives}, {"primitives": [{"attributes": {"POSITION": floor}, "mode": 6}]}]);
    let texture = json!({"index": 0});
    let members = json!({
        "meshes": meshes, "nodes": nodes, "scenes": [{"nodes": (0..70).collect::<Vec<_>>()}],
        "materials": [{"emissiveFactor": [1, 1, 1], "emissiveTexture": texture, "doubleSided": true}],
    });
    let scene = shining("many", &file.root(&json!([]), members), &file.bin);
    assert_eq!(scene.lights.len(), 64);
    assert_eq!(center(&scene.lights[63]), DVec3::new(126.5, 0.5, 0.0));
    let told =
        |words: &str| assert!(scene.notes.iter().any(|n| n.contains(words)), "{:?}", scene.notes);
    told("materials[0] has an emissiveTexture");
    told("materials[0] is double-sided");
    told("6 meshes that shine are no lights");
}

/// A light of a draft at a node.
fn area(draft: &str, light: &Value, mut node: Value) -> Result<AreaLight, String> {
    let (file, primitives) = square();
    node["name"] = json!("lamp");
    node["extensions"] = json!({draft: {"light": 1}});
    let members = json!({
        "extensionsRequired": [draft],
        "extensions": {draft: {"lights": [{}, light]}},
        "nodes": [{"mesh": 0}, node],
        "scenes": [{"nodes": [0, 1]}],
    });
    file.scene(&primitives, members).map(|scene| scene.lights[0].clone())
}

#[test]
fn lights_of_the_drafts_are_read_as_they_stand() {
    let half = 0.5f64.sqrt();
    // A quarter turn about x: −Z becomes Y.
    let node =
        json!({"translation": [1, 2, 3], "rotation": [half, 0, 0, half], "scale": [1, -3, 2]});
    let rect = json!({"type": "rect", "size": 0.5, "rect": {"aspect": 2}, "intensity": 40, "color": [1, 0.5, 0.25]});
    let light = area("EXT_lights_area", &rect, node.clone()).unwrap();
    assert!(matches!(light.light.shape(), Shape::Rectangle));
    let [width, height] = light.light.rectangle().half_extents();
    assert!((width - 1.5).abs() < 1e-12 && (height - 0.75).abs() < 1e-12, "{width} {height}");
    assert!((light.light.emission() - DVec3::Y).length() < 1e-12, "{}", light.light.emission());
    assert_eq!(center(&light), DVec3::new(1.0, 2.0, 3.0));
    assert_eq!((light.color, light.intensity), ([1.0, 0.5, 0.25], 40.0));
    let axis = light.light.rectangle().world_from_light().transform_vector3(DVec3::X);
    assert!(axis.cross(DVec3::X).length() < 1e-12, "its width is along the node's X");
    let light =
        area("EXT_lights_area", &json!({"type": "disk", "size": 1.2}), json!({"scale": [1, 2, 1]}))
            .unwrap();
    assert!(matches!(light.light.shape(), Shape::Disc { radius } if (radius - 1.2).abs() < 1e-12));
    assert_eq!((light.light.emission(), light.intensity), (DVec3::NEG_Z, 1000.0));

    let rect = json!({"shape": "rect", "width": 2, "height": 0.5});
    let light = area("KHR_lights_area", &rect, json!({"scale": [3, 4, 1]})).unwrap();
    assert_eq!(light.light.rectangle().half_extents(), [3.0, 1.0]);
    assert_eq!((light.light.emission(), light.intensity), (DVec3::NEG_Z, 1.0));
    let light =
        area("KHR_lights_area", &json!({"shape": "disk", "radius": 0.5}), json!({})).unwrap();
    assert!(matches!(light.light.shape(), Shape::Disc { radius } if radius == 0.5));
    let light = area("KHR_lights_area", &json!({"shape": "sphere"}), json!({})).unwrap();
    assert!(matches!(light.light.shape(), Shape::Sphere { radius } if radius == 1.0));
}

#[test]
fn lights_of_the_drafts_that_cannot_be_used_are_a_sentence() {
    for (draft, light, sentence) in [
        (
            "EXT_lights_area",
            json!({"type": "sphere"}),
            "its light is a \"sphere\"; there are rect and disk",
        ),
        (
            "EXT_lights_area",
            json!({"type": "rect", "size": 0}),
            "a side of its light, with the node's scale, is 0 m",
        ),
        (
            "EXT_lights_area",
            json!({"type": "rect", "intensity": -1}),
            "must be finite numbers from 0 up",
        ),
        ("EXT_lights_area", json!({"size": 1}), "extensions.EXT_lights_area.lights[1] is wrong"),
        (
            "KHR_lights_area",
            json!({"shape": "tube"}),
            "its light is a \"tube\"; there are rect, disk and sphere",
        ),
        ("KHR_lights_area", json!({"shape": "rect", "width": -2}), "its width is"),
    ] {
        let found = area(draft, &light, json!({})).unwrap_err();
        assert!(found.contains(sentence), "{found}");
    }
}
