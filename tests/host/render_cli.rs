//! `render` as other programs drive it: its files, its report, and one sentence for anything wrong.

mod lights;
mod options;

use antumbra_tests::example::{build_example, folder, root};
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

/// The example, built once by the cargo that runs the tests.
fn render() -> &'static Path {
    static BUILT: OnceLock<PathBuf> = OnceLock::new();
    BUILT.get_or_init(|| build_example("render"))
}

fn run(scene: &Path, out: &Path, options: &[&str]) -> Output {
    Command::new(render()).arg(scene).arg("--out").arg(out).args(options).output().unwrap()
}

const FILES: [&str; 6] =
    ["normal.exr", "position.exr", "report.json", "shaded.png", "visibility.exr", "visibility.png"];

fn files(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .map(|entries| entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect())
        .unwrap_or_default();
    names.sort();
    names
}

fn report(out: &Path) -> Value {
    serde_json::from_slice(&fs::read(out.join("report.json")).unwrap()).unwrap()
}

/// Runs what must fail: status 2, one line that holds `wanted`, and no file.
fn refuse(name: &str, scene: &Path, options: &[&str], wanted: &str) {
    let out = folder(name);
    let output = run(scene, &out, options);
    let line = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{name}: {line}");
    assert_eq!(line.lines().count(), 1, "{name}: one line, not {line}");
    assert!(line.contains(wanted), "{name}: \"{wanted}\" is not in {line}");
    assert_eq!(files(&out), Vec::<String>::new(), "{name}");
    fs::remove_dir_all(out).unwrap();
}

#[test]
fn a_model_gives_every_file_and_a_whole_report() {
    let out = folder("bunny");
    let scene = root().join("scenes/bunny.glb");
    let options =
        ["--size", "96x64", "--set", "map=64", "--set", "sides=one", "--repeat", "2", "--validate"];
    let output = run(&scene, &out, &options);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(files(&out), FILES);
    let report: Value =
        serde_json::from_slice(&fs::read(out.join("report.json")).unwrap()).unwrap();
    let told = String::from_utf8(output.stdout).unwrap();
    assert!(told.contains("soft-shadow-map map=64 sides=one, "), "{told}");
    assert!(told.contains("(median of 2 frames)"), "{told}");
    assert_eq!(report["technique"], "soft-shadow-map");
    assert_eq!(report["settings"]["map"], json!(64));
    assert_eq!(report["settings"]["sides"], "one");
    assert_eq!(report["triangles"], 5650);
    assert_eq!(report["lights"], 1);
    assert!(report["frame_ms"].as_f64().unwrap() > 0.0);
    assert!(report["record_us"].as_f64().unwrap() > 0.0);
    assert!(report["gpu_bytes"].as_u64().unwrap() > 10_000);
    assert!(!report["driver"].as_str().unwrap().is_empty());
    for list in ["passes", "skipped"] {
        for row in report[list].as_array().unwrap() {
            assert!(row["name"].as_str().unwrap().contains('.'), "{row}");
            assert!(!row["why"].as_str().unwrap().is_empty(), "{row}");
        }
    }
    assert!(report["passes"][0]["ms"].as_f64().unwrap() >= 0.0);
    // EXR: the magic number, and the channels in the header.
    let exr = fs::read(out.join("visibility.exr")).unwrap();
    assert_eq!(exr[..4], [0x76, 0x2f, 0x31, 0x01]);
    assert_eq!(fs::read(out.join("shaded.png")).unwrap()[..4], *b"\x89PNG");
    fs::remove_dir_all(out).unwrap();
}

#[test]
fn an_audit_says_what_it_measured() {
    let out = folder("audit");
    let scene = root().join("scenes/bunny.glb");
    let options = ["--size", "96x64", "--technique", "pcss", "--validate", "--repeat", "3"];
    let output = run(&scene, &out, &options);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(report(&out).get("measured_error"), None);
    let visibility = fs::read(out.join("visibility.exr")).unwrap();
    let output = run(&scene, &out, &[&options[..], &["--audit", "64"]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let error = report(&out)["measured_error"].clone();
    let of = |key: &str| error[key].as_f64().unwrap();
    assert!(0.0 <= of("low") && of("low") < of("mean") && of("mean") < of("high"), "{error}");
    assert!(of("high") < 0.2 && (30.0..=192.0).contains(&of("pixels")), "{error}");
    let told = String::from_utf8(output.stdout).unwrap();
    assert!(told.contains(" % measured (") && told.contains(" pixels)"), "{told}");
    assert!(visibility == fs::read(out.join("visibility.exr")).unwrap(), "another image");
    fs::remove_dir_all(out).unwrap();
}

#[test]
fn a_role_on_the_command_line_counts() {
    let out = folder("roles");
    let scene = root().join("scenes/bunny.glb");
    // Nothing blocks: everything is lit.
    let options = ["--size", "32x32", "--role", "occluder0=receiver"];
    let output = run(&scene, &out, &options);
    assert!(output.status.success());
    let report: Value =
        serde_json::from_slice(&fs::read(out.join("report.json")).unwrap()).unwrap();
    assert_eq!(report["passes"][0]["name"], "visibility.lit");
    let told = String::from_utf8(output.stderr).unwrap();
    assert!(told.contains("nothing is shadowed") && told.contains("node's -Z"), "{told}");
    assert!(report["skipped"].as_array().unwrap().len() >= 2);
    assert_eq!(report["auto"]["met"], true, "nothing to compute costs nothing");
    fs::remove_dir_all(out).unwrap();
}

/// What users would pick instead, from the same command line; a row that repeats is one line with a number.
#[test]
fn every_technique_gives_its_files_and_report() {
    let scene = root().join("scenes/bunny.glb");
    for (technique, setting) in [
        ("hard", "map=64"),
        ("pcss", "taps=8"),
        ("back-projection", "map=32"),
        ("many-lights", "samples=5"),
    ] {
        let out = folder(technique);
        let options = ["--technique", technique, "--set", setting, "--size", "48x32", "--validate"];
        let output = run(&scene, &out, &options);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        assert_eq!(files(&out), FILES);
        let report: Value =
            serde_json::from_slice(&fs::read(out.join("report.json")).unwrap()).unwrap();
        assert_eq!(report["technique"], technique);
        let told = String::from_utf8(output.stdout).unwrap();
        assert!(told.contains(&format!(" {technique} {setting}, ")), "{told}");
        let (key, value) = setting.split_once('=').unwrap();
        assert_eq!(report["settings"][key].to_string(), value);
        assert_eq!(report["settings"].get("sides"), None, "{technique} has no sides");
        if technique == "many-lights" {
            let times: Vec<_> =
                report["passes"].as_array().unwrap().iter().map(|p| p["times"].as_u64()).collect();
            assert_eq!(times, [Some(1), Some(1), Some(1), Some(5), Some(5), Some(1)]);
        }
        fs::remove_dir_all(out).unwrap();
    }
}

/// Without a technique one is chosen, and the report says by what.
#[test]
fn auto_chooses_by_a_budget_and_says_what_it_expects() {
    let scene = root().join("scenes/bunny.glb");
    let mut last = f64::INFINITY;
    for options in [&[][..], &["--max-error", "0.05"], &["--technique", "auto", "--max-ms", "1e6"]]
    {
        let out = folder("auto");
        let options = [&["--size", "96x64", "--validate"], options].concat();
        let output = run(&scene, &out, &options);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
        let report = report(&out);
        assert_ne!(report["technique"], "auto", "what ran is told");
        let auto = &report["auto"];
        assert_eq!(auto["met"], true);
        assert!(auto["ms"].as_f64().unwrap() > 0.0 && auto["measured_ms"].as_f64().unwrap() > 0.0);
        let told = String::from_utf8(output.stdout).unwrap();
        assert!(told.contains("(one frame, ") && told.contains(" % promised"), "{told}");
        last = last.min(auto["error"].as_f64().unwrap());
        let effects = report["effects"].as_array().unwrap();
        assert_eq!(effects.len(), antumbra::effects::COUNT);
        for effect in effects {
            assert!(!effect["why"].as_str().unwrap().is_empty(), "{effect}");
            assert!((0.0..=1.0).contains(&effect["bound"].as_f64().unwrap()), "{effect}");
        }
        fs::remove_dir_all(out).unwrap();
    }
    assert!(last < 0.02, "much time buys a small error, not {last}");
}

/// What cannot be met, or makes no sense, gets a sentence and the nearest that can be done.
#[test]
fn a_budget_that_cannot_be_met_is_told_and_the_nearest_is_done() {
    let scene = root().join("scenes/bunny.glb");
    for (options, wanted) in [
        (["--max-ms", "0.000001"], "nothing takes less"),
        (["--max-ms", "0.000001ms"], "nothing takes less"),
        (["--max-error", "0.000001"], "0.0001 % was asked for; the best promise here is "),
        (["--max-error", "0.0001%"], "0.0001 % was asked for; the best promise here is "),
    ] {
        let out = folder("unmet");
        let output = run(&scene, &out, &[&["--size", "32x32"], &options[..]].concat());
        let line = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{options:?}: {line}");
        assert!(line.contains(wanted) && line.lines().count() == 1, "{options:?}: {line}");
        assert_eq!(files(&out), FILES);
        assert_eq!(report(&out)["auto"]["met"], false, "{options:?}");
        fs::remove_dir_all(out).unwrap();
    }
}

/// A small scene as text: one triangle, and whatever the test adds.
fn triangle(nodes: &Value) -> Value {
    let positions: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let bytes: Vec<u8> = positions.iter().flat_map(|x| x.to_le_bytes()).collect();
    json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": (0..nodes.as_array().unwrap().len()).collect::<Vec<_>>() }],
        "nodes": nodes,
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
        "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" }],
        "bufferViews": [{ "buffer": 0, "byteLength": 36 }],
        "buffers": [{ "byteLength": bytes.len(), "uri": "triangle.bin" }],
    })
}

fn write(folder: &Path, scene: &Value, positions: [f32; 9]) -> PathBuf {
    let bytes: Vec<u8> = positions.iter().flat_map(|x| x.to_le_bytes()).collect();
    fs::write(folder.join("triangle.bin"), bytes).unwrap();
    let path = folder.join("scene.gltf");
    fs::write(&path, scene.to_string()).unwrap();
    path
}

#[test]
fn wrong_scenes_are_one_sentence() {
    let there = folder("scenes");
    let good = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let lamp = json!({
        "name": "lamp", "translation": [0, 3, 0], "rotation": [-0.707_106_77, 0, 0, 0.707_106_77],
        "extras": { "area_light": "rectangle", "width": 1, "height": 1 },
    });
    let mesh = json!({ "name": "floor", "mesh": 0 });

    refuse("missing", &there.join("nothing.glb"), &[], "nothing.glb");
    fs::write(there.join("noise.glb"), b"glTFnoise").unwrap();
    refuse("corrupt", &there.join("noise.glb"), &[], "noise.glb");
    fs::write(there.join("room.obj"), b"v 0 0 0").unwrap();
    refuse("obj", &there.join("room.obj"), &[], "room.obj is no glTF; export the scene as .glb");
    let scene = write(&there, &triangle(&json!([mesh])), good);
    refuse("no light", &scene, &[], "README.md shows one, \"Your own scene\"");
    let scene = write(&there, &triangle(&json!([lamp])), good);
    refuse("no triangles", &scene, &[], "triangles");
    let mut negative = lamp.clone();
    negative["extras"]["width"] = json!(-1);
    let scene = write(&there, &triangle(&json!([mesh, negative])), good);
    refuse("negative light", &scene, &[], "lamp");
    let mut bad = good;
    bad[4] = f32::NAN;
    let scene = write(&there, &triangle(&json!([mesh, lamp])), bad);
    refuse("NaN", &scene, &[], "position");
    let mut extension = triangle(&json!([mesh, lamp]));
    extension["extensionsRequired"] = json!(["KHR_mesh_of_tomorrow"]);
    let scene = write(&there, &extension, good);
    refuse("extension", &scene, &[], "KHR_mesh_of_tomorrow");
    let mut range = triangle(&json!([mesh, lamp]));
    range["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(7);
    let scene = write(&there, &range, good);
    refuse("accessor", &scene, &[], "7");

    let mut line = lamp.clone();
    line["extras"]["height"] = json!(0);
    let scene = write(&there, &triangle(&json!([mesh, line])), good);
    let named = ["--technique", "soft-shadow-map"];
    refuse("line", &scene, &named, "the light is a line, and soft-shadow-map takes no lines");
    let out = folder("line_hard");
    let output = run(&scene, &out, &["--size", "32x32", "--technique", "hard"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(files(&out), FILES);
    fs::remove_dir_all(out).unwrap();

    let mut polygon = lamp.clone();
    polygon["extras"] = json!({ "area_light": "polygon", "corners": [[0, 0], [1, 0], [0, 1]] });
    let scene = write(&there, &triangle(&json!([mesh, polygon])), good);
    refuse(
        "polygon",
        &scene,
        &named,
        "the light is a polygon, and soft-shadow-map takes no polygons",
    );
    for options in [&["--technique", "many-lights"][..], &[]] {
        let out = folder("polygon_many");
        let output = run(&scene, &out, &[&["--size", "32x32"], options].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        assert_eq!(files(&out), FILES);
        fs::remove_dir_all(out).unwrap();
    }

    // A name that two lights have.
    let scene = write(&there, &triangle(&json!([mesh, lamp, lamp])), good);
    let out = folder("namesakes");
    let options = ["--size", "32x32", "--technique", "hard", "--light", "lamp"];
    let output = run(&scene, &out, &options);
    assert!(output.status.success());
    let told = String::from_utf8(output.stderr).unwrap();
    assert!(told.contains("2 lights are named lamp; the first of them is used"), "{told}");
    assert_eq!(report(&out)["lights"], 1);
    fs::remove_dir_all(out).unwrap();

    // A light that the technique refuses, among others that it takes; and more lights than a node has.
    let mut ball = lamp.clone();
    ball["extras"] = json!({ "area_light": "sphere", "radius": 0.5 });
    ball["name"] = json!("ball");
    let scene = write(&there, &triangle(&json!([mesh, lamp, ball])), good);
    refuse("ball", &scene, &named, "the light ball: the light is a sphere, and soft-shadow-map");
    let many: Vec<Value> =
        std::iter::once(mesh.clone()).chain((0..65).map(|_| lamp.clone())).collect();
    let scene = write(&there, &triangle(&json!(many)), good);
    refuse(
        "many",
        &scene,
        &[],
        "the scene has 65 lights, and one run draws 64 at most; name one by --light",
    );

    // And the good one renders.
    let scene = write(&there, &triangle(&json!([mesh, lamp])), good);
    let out = folder("good");
    let output = run(&scene, &out, &["--size", "32x32"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(files(&out), FILES);
    fs::remove_dir_all(out).unwrap();
    fs::remove_dir_all(there).unwrap();
}

/// Any scene's lights load; a technique that does not take one says so, and another renders it.
#[test]
fn lights_of_every_shape_are_rendered_or_one_sentence() {
    let there = folder("shapes");
    const TRIED: [&str; 4] = ["auto", "soft-shadow-map", "many-lights", "linear-light"];
    let good = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    for (extras, shape, renders) in [
        (json!({ "area_light": "disk", "radius": 0.5 }), "disc", &["auto", "many-lights"][..]),
        (json!({ "area_light": "sphere", "radius": 0.5 }), "sphere", &[]),
        (json!({ "area_light": "capsule", "radius": 0.5, "length": 1 }), "capsule", &[]),
        (json!({ "area_light": "rectangle", "width": 0, "height": 0 }), "point", &TRIED),
        (json!({ "area_light": "sun", "angular_size": 0.01 }), "sun", &TRIED),
    ] {
        let lamp = json!({
            "name": "lamp", "translation": [0, 3, 0],
            "rotation": [-0.707_106_77, 0, 0, 0.707_106_77], "extras": extras,
        });
        let scene = write(&there, &triangle(&json!([{ "name": "floor", "mesh": 0 }, lamp])), good);
        for technique in TRIED {
            let options = ["--size", "32x32", "--technique", technique];
            if renders.contains(&technique) {
                let out = folder("shape");
                let output = run(&scene, &out, &options);
                assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
                assert_eq!(files(&out), FILES);
                fs::remove_dir_all(out).unwrap();
            } else {
                let sentence = format!("the light is a {shape}, and {technique} takes no {shape}s");
                refuse(shape, &scene, &options, &sentence);
            }
        }
    }
    fs::remove_dir_all(there).unwrap();
}

#[test]
fn a_missing_driver_is_one_sentence() {
    let out = folder("driver");
    let output = Command::new(render())
        .arg(root().join("scenes/bunny.glb"))
        .arg("--out")
        .arg(&out)
        .env("ANTUMBRA_DRIVER", "no such device")
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    let line = String::from_utf8(output.stderr).unwrap();
    assert!(line.contains("no such device") && line.lines().count() == 1, "{line}");
    fs::remove_dir_all(out).unwrap();
}

#[test]
fn nothing_is_left_where_a_file_cannot_be_written() {
    let out = folder("unwritable");
    fs::create_dir(out.join("shaded.png")).unwrap();
    let output = run(&root().join("scenes/bunny.glb"), &out, &["--size", "32x32"]);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(files(&out), ["shaded.png"], "only what was there before");
    fs::remove_dir_all(out).unwrap();
}
