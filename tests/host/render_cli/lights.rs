//! Files with several lights, of which each is drawn as if it were alone, and with several cameras.

use super::{FILES, files, report, run};
use antumbra_tests::example::{folder, root};
use serde_json::{Value, json};
use std::f64::consts::FRAC_1_SQRT_2;
use std::fs;
use std::path::Path;

/// All lights of a file are drawn, each as if it were alone: a channel each, and what belongs to each in the report.
#[test]
fn every_light_of_a_file_has_its_channel_and_its_row() {
    let there = folder("lights");
    let scene = there.join("lights.glb");
    let lamp = |name: &str, x: f64| {
        json!({ "name": name, "translation": [x, 3.0, 0.0], "rotation": [-FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2],
                "extras": { "area_light": "rectangle", "width": 0.4, "height": 0.2 } })
    };
    let mut sun = lamp("Sonne über Köln", 0.0);
    sun["extras"] = json!({ "area_light": "sun", "angular_size": 0.05 });
    bunny_under(&[lamp("lamp", 0.8), sun, lamp("lamp", -0.9)], &scene);
    for options in [&["--technique", "traced"][..], &["--technique", "pcss"], &[]] {
        let out = folder("of_lights");
        let options = [&["--size", "64x48", "--audit", "16", "--validate"], options].concat();
        let output = run(&scene, &out, &options);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        assert_eq!(files(&out), FILES);
        let told = String::from_utf8(output.stdout).unwrap();
        assert!(told.contains("64×48 pixels under 3 lights, "), "{told}");
        let whole = report(&out);
        assert_eq!(whole["lights"], 3);
        let rows = whole["per_light"].as_array().unwrap();
        let names: Vec<_> = rows.iter().map(|row| row["light"].as_str().unwrap()).collect();
        assert_eq!(names, ["lamp", "Sonne über Köln", "lamp"]);
        let ms = |list: &Value| -> f64 {
            list.as_array().unwrap().iter().map(|pass| pass["ms"].as_f64().unwrap()).sum()
        };
        let each: f64 = rows.iter().map(|row| ms(&row["passes"])).sum();
        assert!((ms(&whole["passes"]) - each).abs() < 1e-6 * each && each > 0.0);
        let pixels = |error: &Value| error["pixels"].as_u64().unwrap();
        let audited: u64 = rows.iter().map(|row| pixels(&row["measured_error"])).sum();
        assert_eq!(pixels(&whole["measured_error"]), audited);
        for row in rows {
            assert!(row["technique"].is_string() && row["settings"].is_object(), "{row}");
            assert!(row["skipped"].is_array() && row["effects"].is_array(), "{row}");
        }
        let channels = channels(&out.join("visibility.exr"));
        let names: Vec<_> = channels.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["Sonne über Köln", "lamp", "lamp (2)"]);
        // Each is what it is alone; auto may choose otherwise for one light than for three.
        if options.contains(&"--technique") {
            for (name, channel) in [("lamp", 1), ("Sonne über Köln", 0)] {
                let alone = folder("alone");
                let one = [&options[..], &["--light", name]].concat();
                assert!(run(&scene, &alone, &one).status.success());
                assert!(report(&alone).get("per_light").is_none());
                let image = self::channels(&alone.join("visibility.exr"));
                assert_eq!(image[0].0, "Y");
                assert!(image[0].1 == channels[channel].1, "{name} differs");
                fs::remove_dir_all(alone).unwrap();
            }
        }
        fs::remove_dir_all(out).unwrap();
    }
    fs::remove_dir_all(there).unwrap();
}

/// The first camera shows the scene, or the one that is named: the ground below an orthographic camera that looks down is
/// a grid, whatever its height.
#[test]
fn a_camera_is_the_first_or_the_one_that_is_named() {
    let there = folder("cameras");
    let scene = there.join("cameras.glb");
    bunny_with(&scene, |json| {
        let down = [-FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2];
        let plan = json!({ "name": "plan", "camera": 1, "translation": [0.5, 3.0, 0.0], "rotation": down });
        json["nodes"].as_array_mut().unwrap().push(plan);
        let lens = json!({ "xmag": 1.5, "ymag": 1.0, "znear": 0.0, "zfar": 4.0 });
        json["cameras"]
            .as_array_mut()
            .unwrap()
            .push(json!({ "type": "orthographic", "orthographic": lens }));
    });
    let positions = |camera: &[&str]| {
        let out = folder("of_cameras");
        let options =
            [&["--size", "60x40", "--technique", "traced", "--validate"], camera].concat();
        let output = run(&scene, &out, &options);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let positions = channels(&out.join("position.exr"));
        let visible = channels(&out.join("visibility.exr")).remove(0).1;
        fs::remove_dir_all(out).unwrap();
        (positions, visible)
    };
    let first = positions(&[]);
    assert!(first == positions(&["--camera", "camera"]));
    let (plan, visible) = positions(&["--camera", "plan"]);
    assert!(visible.contains(&0.0) && visible.contains(&1.0));
    // Blue, green and red: z, y and x.
    let of = |channel: usize| &plan[channel].1;
    let ground = |pixel: &usize| of(1)[*pixel].abs() < 1e-6;
    assert!((0..2400).filter(ground).count() > 1200);
    for pixel in (0..2400).filter(ground) {
        let [x, z] = [of(2)[pixel], of(0)[pixel]];
        let [column, row] = [pixel % 60, pixel / 60].map(|i| i as f32 + 0.5);
        let [from_left, from_top] = [x - 0.5 + 1.5, z + 1.0];
        assert!((from_left - column * 0.05).abs() < 1e-4, "{pixel}: x {x}");
        assert!((from_top - row * 0.05).abs() < 1e-4, "{pixel}: z {z}");
    }
    fs::remove_dir_all(there).unwrap();
}

/// The bunny's scene with other lights.
fn bunny_under(lights: &[Value], path: &Path) {
    bunny_with(path, |json| {
        let nodes = json["nodes"].as_array_mut().unwrap();
        nodes.retain(|node| node["extras"]["area_light"].is_null());
        nodes.extend(lights.iter().cloned());
    });
}

/// The bunny's scene, changed.
fn bunny_with(path: &Path, change: impl FnOnce(&mut Value)) {
    let glb = fs::read(root().join("scenes/bunny.glb")).unwrap();
    let word = |at: usize| u32::from_le_bytes(glb[at..at + 4].try_into().unwrap()) as usize;
    let json_bytes = word(12);
    let mut json: Value = serde_json::from_slice(&glb[20..20 + json_bytes]).unwrap();
    change(&mut json);
    let number = json["nodes"].as_array().unwrap().len();
    json["scenes"][0]["nodes"] = (0..number).collect();
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let rest = &glb[20 + json_bytes..];
    let mut file = glb[..8].to_vec();
    file.extend(((20 + text.len() + rest.len()) as u32).to_le_bytes());
    file.extend((text.len() as u32).to_le_bytes());
    file.extend(*b"JSON");
    file.extend(text);
    file.extend(rest);
    fs::write(path, file).unwrap();
}

/// The names and values of an EXR file's channels, in its order.
fn channels(path: &Path) -> Vec<(String, Vec<f32>)> {
    let image = exr::prelude::read_first_flat_layer_from_file(path).unwrap();
    let of = |channel: exr::prelude::AnyChannel<exr::prelude::FlatSamples>| {
        let name = String::from_utf8(channel.name.bytes().to_vec()).unwrap();
        (name, channel.sample_data.values_as_f32().collect())
    };
    image.layer_data.channel_data.list.into_iter().map(of).collect()
}
