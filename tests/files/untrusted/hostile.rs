//! Files that make as much of each of their bytes as they can: what the loader's memory is measured on.

use super::parts::{
    INDICES, LONG, POSITIONS, Parts, list, listed, mesh, primitive, sparse, vectors,
};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

/// Makes a file of a triangle's parts.
type Change = fn(&mut Parts);

/// The one that is refused.
pub const REFUSED: &str = "primitives that share too much";

/// What a file tries, and how.
pub const FILES: [(&str, Change); 40] = [
    // What JSON is read into.
    ("empty nodes", |parts| add(&mut parts.nodes, &list("{}"))),
    ("instances", |parts| parts.nodes = list(r#"{"mesh":0}"#)),
    ("instances of two sides", |parts| {
        parts.nodes = list(r#"{"mesh":0}"#);
        two_sides(parts);
    }),
    ("transforms", |parts| {
        let node = r#"{"scale":[1,1,1],"rotation":[0,0,0,1],"translation":[0,0,0]}"#;
        add(&mut parts.nodes, &list(node));
    }),
    ("a chain of nodes", |parts| {
        let links = LONG / 24;
        add(&mut parts.nodes, &listed(links, |i| format!(r#"{{"children":[{}]}}"#, i + 2)));
        add(&mut parts.nodes, "{}");
    }),
    ("a node of many children", |parts| {
        let children = LONG / 12;
        add(&mut parts.nodes, &listed(children, |_| "{}".into()));
        let children = listed(children, |i| (i + 1).to_string());
        add(&mut parts.nodes, &format!(r#"{{"children":[{children}]}}"#));
    }),
    ("a name", |parts| parts.nodes = format!(r#"{{"mesh":0,"name":"{}"}}"#, "n".repeat(LONG))),
    ("suns", |parts| {
        add(&mut parts.nodes, &list(r#"{"extras":{"area_light":"sun","angular_size":1}}"#));
    }),
    ("extras of a member", |parts| add(&mut parts.nodes, &list(r#"{"extras":{"":0}}"#))),
    ("extras, objects in objects", |parts| nested(parts, r#"{"":"#, "}")),
    ("extras, lists in lists", |parts| nested(parts, "[", "]")),
    ("extras, a long list", |parts| {
        parts.nodes = format!(r#"{{"mesh":0,"extras":[{}]}}"#, list("0"));
    }),
    ("extras, a list of lists", |parts| {
        parts.nodes = format!(r#"{{"mesh":0,"extras":[{}]}}"#, list("[0]"));
    }),
    ("cameras", |parts| parts.other = format!(r#","cameras":[{}]"#, list("{}"))),
    ("materials", |parts| parts.other = format!(r#","materials":[{}]"#, list("{}"))),
    ("scenes", |parts| {
        parts.other = format!(r#","scenes":[{{"nodes":[0]}},{}]"#, list("{}"));
    }),
    ("what is not read", |parts| parts.other = format!(r#","textures":[{}]"#, list("[{}]"))),
    ("empty meshes", |parts| add(&mut parts.meshes, &list("{}"))),
    ("meshes without positions", |parts| {
        add(&mut parts.meshes, &list(&mesh(r#"{"attributes":{}}"#)));
    }),
    ("primitives without positions", |parts| {
        add(&mut parts.meshes, &mesh(&list(r#"{"attributes":{}}"#)));
    }),
    ("bufferViews", |parts| parts.views.push(list(r#"{"buffer":0,"byteLength":0}"#))),
    ("buffers", |parts| parts.buffers = list(r#"{"byteLength":0}"#)),
    // What triangles are made of.
    ("a strip of bytes", strip),
    ("a strip of bytes, and instances of two sides", |parts| {
        strip(parts);
        parts.nodes = list(r#"{"mesh":0}"#);
        two_sides(parts);
    }),
    ("primitives that share as much as they may", |parts| {
        // Another member's bytes allow as many triangles.
        let strip = strip_of(parts, LONG / 8);
        parts.meshes = mesh(&listed(8, |_| strip.clone()));
        parts.other = format!(r#","unread":"{}""#, "u".repeat(LONG));
    }),
    ("as much as they may, and instances of two sides", |parts| {
        let strip = strip_of(parts, LONG / 8);
        parts.meshes = mesh(&listed(6, |_| strip.clone()));
        parts.nodes = list(r#"{"mesh":0}"#);
        two_sides(parts);
    }),
    (REFUSED, |parts| {
        let strip = strip_of(parts, LONG);
        parts.meshes = mesh(&list(&strip));
    }),
    ("primitives of a part of a large mesh", |parts| {
        let all = parts.positions(LONG / 12);
        parts.meshes = mesh(&list(&primitive(all, INDICES)));
    }),
    ("primitives of a part of a large mesh with normals", |parts| {
        let all = parts.positions(LONG / 12);
        let primitive =
            format!(r#"{{"attributes":{{"POSITION":{all},"NORMAL":{all}}},"indices":{INDICES}}}"#);
        parts.meshes = mesh(&list(&primitive));
    }),
    ("meshes of a triangle", |parts| {
        let (meshes, view) = (LONG / 160, parts.views.len() - 1);
        for _ in 0..meshes {
            parts.accessor(&format!(
                r#""bufferView":{view},"componentType":5121,"type":"SCALAR","count":3"#
            ));
        }
        parts.meshes = listed(meshes, |i| mesh(&primitive(POSITIONS, INDICES + i)));
        parts.nodes = listed(meshes, |i| format!(r#"{{"mesh":{i}}}"#));
    }),
    ("zeros that take no bytes", |parts| {
        let zeros = format!(
            r#""componentType":5126,"type":"VEC3","count":65536,{}"#,
            sparse(1, INDICES, 5121, POSITIONS)
        );
        let zeros = parts.accessor(&zeros);
        parts.meshes = mesh(&format!(
            r#"{{"attributes":{{"POSITION":{zeros},"NORMAL":{zeros}}},"indices":{INDICES}}}"#
        ));
    }),
    ("primitives that share a large sparse accessor", |parts| {
        let points = LONG / 64;
        let all = parts.positions(points);
        let view = parts.views.len() - 1;
        let indices =
            parts.view(&(0..points as u32).flat_map(u32::to_le_bytes).collect::<Vec<_>>());
        let replaced = format!("{},{}", vectors(view, points), sparse(points, indices, 5125, view));
        assert_eq!(parts.accessor(&replaced), all + 1);
        parts.meshes = mesh(&list(&primitive(all + 1, INDICES)));
    }),
    ("a large mesh many times, in the sun", |parts| {
        let all = parts.positions(LONG / 36 * 3);
        parts.meshes = mesh(&format!(r#"{{"attributes":{{"POSITION":{all}}}}}"#));
        parts.nodes = list(r#"{"mesh":0}"#);
        add(&mut parts.nodes, r#"{"extras":{"area_light":"sun","angular_size":0.01}}"#);
    }),
    // What stops a part of the light.
    ("as much as they may with texture coordinates, and instances of two sides", |parts| {
        let strip = strip_of(parts, LONG / 8);
        let placed =
            parts.accessor(r#""bufferView":0,"componentType":5121,"type":"VEC2","count":3"#);
        let textured = strip.replacen("}", &format!(r#","TEXCOORD_0":{placed}}},"material":1"#), 1);
        parts.meshes = mesh(&listed(6, |_| textured.clone()));
        parts.nodes = list(r#"{"mesh":0}"#);
        two_sides(parts);
        parts.other = format!(r#","materials":[{{"doubleSided":true}},{}]"#, faded(1));
    }),
    ("meshes of a constant map each", |parts| {
        let surfaces = LONG / 160;
        parts.meshes = listed(surfaces, |i| mesh(&of_material(i)));
        parts.nodes = listed(surfaces, |i| format!(r#"{{"mesh":{i}}}"#));
        parts.other = format!(r#","materials":[{}]"#, listed(surfaces, faded));
    }),
    ("nodes of a mesh in as many parts as there may be", |parts| {
        // A place is 25 parts more than two, of which a node's bytes allow less than one.
        let nodes = LONG / 16 / 25;
        parts.meshes = mesh(&listed(27, of_material));
        parts.nodes = listed(nodes, |_| r#"{"mesh":0}"#.into());
        parts.other =
            format!(r#","materials":[{}],"unread":"{}""#, listed(27, faded), "u".repeat(LONG));
    }),
    ("materials, textures, samplers and images", |parts| {
        parts.meshes = mesh(&of_material(0));
        let lists = ["textures", "samplers", "images"];
        let lists = lists.map(|name| format!(r#","{name}":[{}]"#, list("{}")));
        parts.other = format!(r#","materials":[{},{}]{}"#, faded(1), list("{}"), lists.concat());
    }),
    ("materials that are wrong", |parts| {
        let surfaces = LONG / 64;
        parts.meshes = mesh(&listed(surfaces, of_material));
        parts.other =
            format!(r#","materials":[{}]"#, listed(surfaces, |_| r#"{"alphaMode":""}"#.into()));
    }),
    // What buffers are made of.
    ("a data URI", |parts| {
        parts.bin.resize(LONG, 0);
        parts.uri = Some(format!("data:;base64,{}", STANDARD.encode(&parts.bin)));
    }),
    ("an escaped data URI", |parts| {
        parts.bin.resize(LONG / 4, 0);
        let encoded = STANDARD.encode(&parts.bin);
        let escaped: String = encoded.bytes().map(|b| format!("%{b:02x}")).collect();
        parts.uri = Some(format!("data:;base64,{escaped}"));
    }),
];

fn add(items: &mut String, more: &str) {
    items.push(',');
    items.push_str(more);
}

/// Of a mesh both of whose sides are drawn in part, each instance is two.
fn two_sides(parts: &mut Parts) {
    let other = format!(r#",{{"attributes":{{"POSITION":{POSITIONS}}},"material":0}}]}}"#);
    parts.meshes = parts.meshes.replacen("]}", &other, 1);
    parts.other = r#","materials":[{"doubleSided":true}]"#.into();
}

/// The triangle with a material.
fn of_material(index: usize) -> String {
    let of = primitive(POSITIONS, INDICES);
    of.replacen("{", &format!(r#"{{"material":{index},"#), 1)
}

/// A material that stops a part of the light, of 254 different ones.
fn faded(index: usize) -> String {
    let alpha = (index % 254) as f64 / 255.0;
    format!(
        r#"{{"alphaMode":"BLEND","pbrMetallicRoughness":{{"baseColorFactor":[1,1,1,{alpha:.3}]}}}}"#
    )
}

/// A triangle for each byte, which shares no vertex.
fn strip(parts: &mut Parts) {
    let strip = strip_of(parts, LONG);
    parts.meshes = mesh(&strip);
}

fn strip_of(parts: &mut Parts, corners: usize) -> String {
    let indices = parts.indices(corners);
    format!(r#"{{"attributes":{{"POSITION":{POSITIONS}}},"indices":{indices},"mode":5}}"#)
}

/// Extras nearly as deep as the parser goes.
fn nested(parts: &mut Parts, open: &str, close: &str) {
    const DEPTH: usize = 120;
    let extras = format!("{}0{}", open.repeat(DEPTH), close.repeat(DEPTH));
    add(&mut parts.nodes, &list(&format!(r#"{{"extras":{extras}}}"#)));
}
