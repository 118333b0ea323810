//! Files with several lights: each is drawn as if it were alone, into a channel of its own.

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

/// The bunny's scene with other lights.
fn bunny_under(lights: &[Value], path: &Path) {
    let glb = fs::read(root().join("scenes/bunny.glb")).unwrap();
    let word = |at: usize| u32::from_le_bytes(glb[at..at + 4].try_into().unwrap()) as usize;
    let json_bytes = word(12);
    let mut json: Value = serde_json::from_slice(&glb[20..20 + json_bytes]).unwrap();
    let nodes = json["nodes"].as_array_mut().unwrap();
    nodes.retain(|node| node["extras"]["area_light"].is_null());
    nodes.extend(lights.iter().cloned());
    let number = nodes.len();
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
