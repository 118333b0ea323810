//! The comparisons, one function each.

use super::Options;
use super::model::{Ready, accumulation_ms, committed};
use super::table::{Table, exponent, line, median, quantile, spread};
use antumbra::scene::{Role, Scene, generate};
use antumbra::truth::ErrorSummary;
use antumbra_harness::ply::ply;
use antumbra_harness::{HeadlessDevice, ReadbackScheme};
use glam::DMat4;
use std::path::Path;

fn spheres(light: f64) -> Scene {
    generate::spheres(generate::square_light(light).unwrap())
}

fn percent(truth: &[f32], image: &[f32]) -> f64 {
    100.0 * ErrorSummary::between(truth, image, None).unwrap().mean_abs_error
}

/// The gather beside the blend: accumulation passes alone, one side, N = M, in turns.
pub fn gather_and_blend(device: &HeadlessDevice, options: &Options) -> Table {
    let columns = ["L", "N", "gather ms", "q1", "q3", "blend ms", "q1", "q3", "ratio"];
    let mut table = Table::new("gather_and_blend", &columns);
    let sides: &[u32] = if options.quick { &[64, 128, 256] } else { &[64, 128, 256, 512] };
    let lights = [0.1, 0.4, 1.0];
    let mut gathers = Vec::new();
    let mut blends = Vec::new();
    for light in lights {
        let scene = spheres(light);
        for &n in sides {
            let words = format!("receivers=map sides=one map={n} receiver_map={n}");
            let mut gather = Ready::new(device, &scene, 32, &words);
            let mut blend = Ready::new(device, &scene, 32, &format!("{words} accumulate=blend"));
            let mut times = [Vec::new(), Vec::new()];
            for _ in 0..options.rounds {
                times[0].push(accumulation_ms(&gather.run()));
                times[1].push(accumulation_ms(&blend.run()));
            }
            let [g, b] = &times;
            let quartiles = |t: &[f64]| [0.25, 0.75].map(|q| format!("{:.1}", quantile(t, q)));
            let ([g1, g3], [b1, b3]) = (quartiles(g), quartiles(b));
            gathers.push((light, f64::from(n), median(g)));
            blends.push((light, f64::from(n), median(b)));
            table.row(vec![
                format!("{light}"),
                format!("{n}"),
                spread(g),
                g1,
                g3,
                spread(b),
                b1,
                b3,
                format!("{:.2}", median(g) / median(b)),
            ]);
        }
    }
    let largest = f64::from(sides[sides.len() - 1]);
    for (name, all) in [("gather", &gathers), ("blend", &blends)] {
        for light in lights {
            let points: Vec<_> =
                all.iter().filter(|p| p.0 == light && p.1 >= 128.0).map(|p| (p.1, p.2)).collect();
            println!("{name}, L = {light}: time grows as N^{:.2}", exponent(&points));
        }
        let points: Vec<_> = all.iter().filter(|p| p.1 == largest).map(|p| (p.0, p.2)).collect();
        println!("{name}, N = {largest}: time grows as L^{:.2}", exponent(&points));
    }
    table
}

/// The gather beside the paper's own scheme (Atty 2006 section 4.1), whole frames: one side, N = M, in
/// turns. The node's frame ends in 32×32 pixels, which weigh nothing; the paper's ends with its map.
pub fn gather_and_readback(device: &HeadlessDevice, options: &Options) -> Table {
    let columns =
        ["L", "N", "gather ms", "readback ms", "depth", "rectangles", "blend", "MB moved", "ratio"];
    let mut table = Table::new("gather_and_readback", &columns);
    let sides: &[u32] = if options.quick { &[128, 256] } else { &[128, 256, 512] };
    for light in [0.1, 0.4, 1.0] {
        let scene = spheres(light);
        let lamp = scene.light(None).unwrap().light;
        for &n in sides {
            let words = format!("receivers=map sides=one map={n} receiver_map={n}");
            let mut gather = Ready::new(device, &scene, 32, &words);
            let mut readback = ReadbackScheme::new(device, &scene, n, n).unwrap();
            readback.run(&lamp, None).unwrap();
            let mut frames = Vec::new();
            let mut parts: [Vec<f64>; 4] = Default::default();
            let mut bytes = 0;
            for _ in 0..options.rounds {
                frames.push(gather.run().frame.as_secs_f64() * 1e3);
                let times = readback.run(&lamp, None).unwrap();
                let all = [times.frame, times.depth, times.rectangles, times.blend];
                for (list, part) in parts.iter_mut().zip(all) {
                    list.push(part.as_secs_f64() * 1e3);
                }
                bytes = times.bytes;
            }
            let [whole, depth, rectangles, blend] = &parts;
            table.row(vec![
                format!("{light}"),
                format!("{n}"),
                spread(&frames),
                spread(whole),
                spread(depth),
                spread(rectangles),
                spread(blend),
                format!("{:.1}", bytes as f64 / 1e6),
                format!("{:.2}", median(&frames) / median(whole)),
            ]);
        }
    }
    table
}

/// One side, the larger of two and their mean, at the pixels and on a map, of the bunny.
pub fn sides(device: &HeadlessDevice, options: &Options) -> Table {
    let columns = ["receivers", "one ms", "two ms", "mean ms", "two / one", "mean / two"];
    let mut table = Table::new("sides", &columns);
    let light = generate::square_light(0.4).unwrap();
    let scene = generate::normalized(&committed("bunny"), light).unwrap();
    for receivers in ["pixels", "map"] {
        let mut stages = ["one", "two", "mean"].map(|sides| {
            Ready::new(device, &scene, 256, &format!("receivers={receivers} sides={sides}"))
        });
        let mut times = [Vec::new(), Vec::new(), Vec::new()];
        for _ in 0..options.rounds {
            for (stage, times) in stages.iter_mut().zip(&mut times) {
                times.push(accumulation_ms(&stage.run()));
            }
        }
        let [one, two, mean] = &times;
        table.row(vec![
            receivers.into(),
            spread(one),
            spread(two),
            spread(mean),
            format!("{:.2}", median(two) / median(one)),
            format!("{:.2}", median(mean) / median(two)),
        ]);
    }
    table
}

/// Visibility at the pixels beside a map projected onto them, on scenes with a split.
pub fn pixels_and_map(device: &HeadlessDevice, options: &Options) -> Table {
    let columns = ["scene", "pixels %", "map %", "noise %", "pixels ms", "map ms"];
    let mut table = Table::new("pixels_and_map", &columns);
    let light = || generate::square_light(0.4).unwrap();
    let scenes = [
        ("card", generate::card(light())),
        ("spheres", generate::spheres(light())),
        ("tall box", generate::tall_box(light())),
        ("bunny", generate::normalized(&committed("bunny"), light()).unwrap()),
        ("suzanne", generate::normalized(&committed("suzanne"), light()).unwrap()),
    ];
    for (name, scene) in scenes {
        let mut stages = ["receivers=pixels", "receivers=map"]
            .map(|words| Ready::new(device, &scene, 256, words));
        let (truth, noise) = stages[0].truth(&scene, if options.quick { 128 } else { 512 });
        let mut times = [Vec::new(), Vec::new()];
        for _ in 0..options.rounds {
            for (stage, times) in stages.iter_mut().zip(&mut times) {
                times.push(stage.run().frame.as_secs_f64() * 1e3);
            }
        }
        let errors = stages.each_mut().map(|s| percent(&truth, &s.image()));
        table.row(vec![
            name.into(),
            format!("{:.2}", errors[0]),
            format!("{:.2}", errors[1]),
            format!("{:.2}", 100.0 * noise),
            spread(&times[0]),
            spread(&times[1]),
        ]);
    }
    table
}

/// What the tolerance gives and takes, against a tolerance of 0 on the same maps.
pub fn tolerance(device: &HeadlessDevice, options: &Options) -> Table {
    let mut table = Table::new("tolerance", &["scene", "tolerance", "worst", "ms"]);
    let light = || generate::square_light(0.4).unwrap();
    let scenes =
        [("spheres", generate::spheres(light())), ("foliage", generate::foliage(light(), 300, 7))];
    let tolerances = [0.0, 1e-5, 1e-4, 1e-3, 1e-2];
    for (name, scene) in scenes {
        let mut stages = tolerances
            .map(|t| Ready::new(device, &scene, 256, &format!("sides=one tolerance={t}")));
        let exact = stages[0].image();
        let mut times: Vec<Vec<f64>> = vec![Vec::new(); tolerances.len()];
        for _ in 0..options.rounds {
            for (stage, times) in stages.iter_mut().zip(&mut times) {
                times.push(accumulation_ms(&stage.run()));
            }
        }
        for ((stage, tolerance), times) in stages.iter_mut().zip(tolerances).zip(&times) {
            let image = stage.image();
            let differences = image.iter().zip(&exact).map(|(a, b)| (a - b).abs());
            let worst = differences.fold(0.0, f32::max);
            table.row(vec![
                name.into(),
                format!("{tolerance}"),
                format!("{worst:.1e}"),
                spread(times),
            ]);
        }
    }
    table
}

/// The frame's time against triangles: a sphere from 1k to 871k, and the dragon where it was fetched.
pub fn triangles(device: &HeadlessDevice, options: &Options) -> Table {
    let columns = ["model", "triangles", "frame ms", "layers ms", "plan us", "record us"];
    let mut table = Table::new("triangles", &columns);
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/dragon");
    let mut models: Vec<(&str, Scene)> = Vec::new();
    for rows in [22u32, 45, 90, 180, 360, 660] {
        let mut object = Scene::default();
        let mesh = generate::uv_sphere(0.5, rows + 1, rows);
        object.add("sphere", mesh, DMat4::IDENTITY, Role::Occluder);
        models.push(("sphere", object));
    }
    for file in ["dragon_vrip_res4", "dragon_vrip_res3", "dragon_vrip_res2", "dragon_vrip"] {
        if let Some(mesh) = ply(&folder.join(format!("{file}.ply"))) {
            let mut object = Scene::default();
            object.add("dragon", mesh, DMat4::IDENTITY, Role::Occluder);
            models.push(("dragon", object));
        }
    }
    if models.iter().all(|m| m.0 != "dragon") {
        println!("the dragon is not there; benches/fetch_dragon.sh fetches it");
    }
    let mut points: Vec<(&str, f64, f64)> = Vec::new();
    for (name, object) in models {
        let light = generate::square_light(0.4).unwrap();
        let scene = generate::normalized(&object, light).unwrap();
        let mut ready = Ready::new(device, &scene, 256, "map=256");
        let frames: Vec<_> = (0..options.rounds.max(5)).map(|_| ready.run()).collect();
        let layers: Vec<f64> = frames
            .iter()
            .map(|f| f.passes.iter().filter(|p| p.0.starts_with("depth_layers")).map(|p| p.1).sum())
            .collect();
        let times: Vec<f64> = frames.iter().map(|f| f.frame.as_secs_f64() * 1e3).collect();
        let record: Vec<f64> = frames.iter().map(|f| f.record.as_secs_f64() * 1e6).collect();
        let plan: Vec<f64> = (0..21).map(|_| ready.plan_us()).collect();
        points.push((name, scene.triangles() as f64, median(&layers)));
        table.row(vec![
            name.into(),
            format!("{}", scene.triangles()),
            spread(&times),
            spread(&layers),
            spread(&plan),
            spread(&record),
        ]);
    }
    for model in ["sphere", "dragon"] {
        let own: Vec<_> =
            points.iter().filter(|p| p.0 == model).map(|p| (p.1 / 1e5, p.2)).collect();
        if own.len() > 2 {
            let (base, slope, r2) = line(&own);
            println!(
                "{model}: layers take {base:.1} ms + {slope:.2} ms a hundred thousand triangles, \
                 R² = {r2:.3}"
            );
        }
    }
    table
}
