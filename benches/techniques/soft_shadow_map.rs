//! What soft shadow maps cost, and what that buys.

use crate::ready::{Ready, frame_ms, in_turns, median_of, passes_ms, scene};
use crate::table::Table;
use crate::{Bench, Scale};
use antumbra::scene::{Role, Scene, generate};
use antumbra_bench::stats::{exponent, line, median, quartiles};
use antumbra_harness::ply::ply;
use antumbra_harness::{FrameTimes, HeadlessDevice, ReadbackScheme};
use glam::DMat4;
use std::path::Path;

pub const BENCH: Bench = Bench {
    name: "soft_shadow_map",
    about: "Soft shadow maps: the gather, its sides, tolerance and maps, and triangles",
    studies: &[
        ("gather_and_blend", gather_and_blend),
        ("gather_and_readback", gather_and_readback),
        ("sides", sides),
        ("pixels_and_map", pixels_and_map),
        ("tolerance", tolerance),
        ("triangles", triangles),
    ],
    full: Scale { rounds: 5, sides: &[64, 128, 256, 512], quick: false },
    quick: Scale { rounds: 3, sides: &[64, 128, 256], quick: true },
};

/// A grid of `side`² pixels on the ground.
fn ready(device: &HeadlessDevice, scene: &Scene, side: u32, words: &str) -> Ready {
    Ready::over(device, scene, &format!("soft-shadow-map {words}"), 2.2, side)
}

/// Milliseconds of the passes that add up: everything of the technique between layers and resolve.
fn accumulation_ms(times: &FrameTimes) -> f64 {
    passes_ms(times, |name| name.starts_with("soft_shadow_map"))
}

/// What each frame's accumulation took.
fn accumulations(times: &[FrameTimes]) -> Vec<f64> {
    times.iter().map(accumulation_ms).collect()
}

/// The gather beside the blend: accumulation passes alone, one side, N = M, in turns.
fn gather_and_blend(device: &HeadlessDevice, scale: &Scale, table: &mut Table) {
    table.head("L|N|gather ms|q1|q3|blend ms|q1|q3|ratio");
    let lights = [0.1, 0.4, 1.0];
    let mut all = [Vec::new(), Vec::new()];
    for light in lights {
        let scene = scene("spheres", light);
        for &n in scale.sides {
            let words = format!("receivers=map sides=one map={n} receiver_map={n}");
            let mut stages = ["gather", "blend"]
                .map(|how| ready(device, &scene, 32, &format!("{words} accumulate={how}")));
            let times = in_turns(&mut stages, scale.rounds);
            let [[g1, g, g3], [b1, b, b3]] = [0, 1].map(|i| quartiles(&accumulations(&times[i])));
            all[0].push((light, f64::from(n), g));
            all[1].push((light, f64::from(n), b));
            let gather = format!("{g:.1}|{g1:.1}|{g3:.1}");
            table.row(format!("{light}|{n}|{gather}|{b:.1}|{b1:.1}|{b3:.1}|{:.2}", g / b));
        }
    }
    let largest = scale.sides.iter().copied().max().map_or(0.0, f64::from);
    let grows = |points: Vec<_>| exponent(&points).unwrap_or(f64::NAN);
    for (name, all) in ["gather", "blend"].iter().zip(&all) {
        for light in lights {
            let own = all.iter().filter(|p| p.0 == light && p.1 >= 128.0);
            let e = grows(own.map(|p| (p.1, p.2)).collect());
            println!("{name}, L = {light}: time grows as N^{e:.2}");
        }
        let e = grows(all.iter().filter(|p| p.1 == largest).map(|p| (p.0, p.2)).collect());
        println!("{name}, N = {largest}: time grows as L^{e:.2}");
    }
}

/// The gather beside the paper's own scheme (Atty 2006 section 4.1), whole frames: one side, N = M, in
/// turns. The node's frame ends in 32×32 pixels, which weigh nothing; the paper's ends with its map.
fn gather_and_readback(device: &HeadlessDevice, scale: &Scale, table: &mut Table) {
    table.head("L|N|gather ms|readback ms|depth|rectangles|blend|MB moved|ratio");
    for light in [0.1, 0.4, 1.0] {
        let scene = scene("spheres", light);
        let lamp = *scene.light(None).unwrap().light.rectangle();
        for &n in &scale.sides[1..] {
            let words = format!("receivers=map sides=one map={n} receiver_map={n}");
            let mut gather = ready(device, &scene, 32, &words);
            let mut readback = ReadbackScheme::new(device, &scene, n, n).unwrap();
            readback.run(&lamp, None).unwrap();
            let mut frames = Vec::new();
            let mut parts: [Vec<f64>; 4] = Default::default();
            let mut bytes = 0;
            for _ in 0..scale.rounds {
                frames.push(frame_ms(&gather.run()));
                let times = readback.run(&lamp, None).unwrap();
                let all = [times.frame, times.depth, times.rectangles, times.blend];
                for (list, part) in parts.iter_mut().zip(all) {
                    list.push(part.as_secs_f64() * 1e3);
                }
                bytes = times.bytes;
            }
            let (ms, [whole, depth, squares, blend]) = (median(&frames), parts.map(|p| median(&p)));
            let (mb, ratio) = (bytes as f64 / 1e6, ms / whole);
            let parts = format!("{whole:.1}|{depth:.1}|{squares:.1}|{blend:.1}");
            table.row(format!("{light}|{n}|{ms:.1}|{parts}|{mb:.1}|{ratio:.2}"));
        }
    }
}

/// One side, the larger of two and their mean, at the pixels and on a map, of the bunny.
fn sides(device: &HeadlessDevice, scale: &Scale, table: &mut Table) {
    table.head("receivers|one ms|two ms|mean ms|two / one|mean / two");
    let scene = scene("bunny", 0.4);
    for receivers in ["pixels", "map"] {
        let mut stages = ["one", "two", "mean"].map(|sides| {
            ready(device, &scene, 256, &format!("receivers={receivers} sides={sides}"))
        });
        let times = in_turns(&mut stages, scale.rounds);
        let [one, two, mean] = [0, 1, 2].map(|i| median_of(&times[i], accumulation_ms));
        let ratios = format!("{:.2}|{:.2}", two / one, mean / two);
        table.row(format!("{receivers}|{one:.1}|{two:.1}|{mean:.1}|{ratios}"));
    }
}

/// Visibility at the pixels beside a map projected onto them, on scenes with a split.
fn pixels_and_map(device: &HeadlessDevice, scale: &Scale, table: &mut Table) {
    table.head("scene|pixels %|map %|noise %|pixels ms|map ms");
    for name in ["card", "spheres", "tall box", "bunny", "suzanne"] {
        let scene = scene(name, 0.4);
        let mut stages =
            ["receivers=pixels", "receivers=map"].map(|words| ready(device, &scene, 256, words));
        let (truth, noise) = stages[0].traced(&scene, if scale.quick { 128 } else { 512 });
        let times = in_turns(&mut stages, scale.rounds);
        let [pixels, map] = [0, 1].map(|i| median_of(&times[i], frame_ms));
        let [error, of_map] = stages.each_mut().map(|s| s.error(&truth));
        let noise = 100.0 * noise;
        table.row(format!("{name}|{error:.2}|{of_map:.2}|{noise:.2}|{pixels:.1}|{map:.1}"));
    }
}

/// What the tolerance gives and takes, against a tolerance of 0 on the same maps.
fn tolerance(device: &HeadlessDevice, scale: &Scale, table: &mut Table) {
    table.head("scene|tolerance|worst|ms");
    let tolerances = [0.0, 1e-5, 1e-4, 1e-3, 1e-2];
    for name in ["spheres", "foliage"] {
        let scene = scene(name, 0.4);
        let mut stages =
            tolerances.map(|t| ready(device, &scene, 256, &format!("sides=one tolerance={t}")));
        let exact = stages[0].visibility();
        let times = in_turns(&mut stages, scale.rounds);
        for ((stage, tolerance), times) in stages.iter_mut().zip(tolerances).zip(&times) {
            let image = stage.visibility();
            let differences = image.iter().zip(&exact).map(|(a, b)| (a - b).abs());
            let (worst, ms) = (differences.fold(0.0, f32::max), median_of(times, accumulation_ms));
            table.row(format!("{name}|{tolerance}|{worst:.1e}|{ms:.1}"));
        }
    }
}

/// The frame's time against triangles: a sphere from 1k to 871k, and the dragon where it was fetched.
fn triangles(device: &HeadlessDevice, scale: &Scale, table: &mut Table) {
    table.head("model|triangles|frame ms|layers ms|plan us|record us");
    let folder = antumbra_bench::options::Options::root().join("target/dragon");
    let spheres = [22, 45, 90, 180, 360, 660]
        .map(|rows| ("sphere", Some(generate::uv_sphere(0.5, rows + 1, rows))));
    let dragons = ["dragon_vrip_res4", "dragon_vrip_res3", "dragon_vrip_res2", "dragon_vrip"]
        .map(|file| ("dragon", ply(&folder.join(Path::new(file).with_extension("ply")))));
    if dragons.iter().all(|(_, mesh)| mesh.is_none()) {
        println!("the dragon is not there; benches/fetch_dragon.sh fetches it");
    }
    let mut points: Vec<(&str, f64, f64)> = Vec::new();
    for (name, mesh) in spheres.into_iter().chain(dragons) {
        let Some(mesh) = mesh else { continue };
        let mut object = Scene::default();
        object.add(name, mesh, DMat4::IDENTITY, Role::Occluder);
        let light = generate::square_light(0.4).unwrap();
        let scene = generate::normalized(&object, light).unwrap();
        let mut ready = ready(device, &scene, 256, "map=256");
        let frames: Vec<_> = (0..scale.rounds.max(5)).map(|_| ready.run()).collect();
        let layers = median_of(&frames, |f| passes_ms(f, |pass| pass.starts_with("depth_layers")));
        let (frame, record) =
            (median_of(&frames, frame_ms), median_of(&frames, |f| f.record.as_secs_f64() * 1e6));
        let plan = median(&(0..21).map(|_| ready.plan_us()).collect::<Vec<_>>());
        let count = scene.triangles();
        points.push((name, count as f64, layers));
        table.row(format!("{name}|{count}|{frame:.1}|{layers:.1}|{plan:.1}|{record:.1}"));
    }
    for model in ["sphere", "dragon"] {
        let own: Vec<_> =
            points.iter().filter(|p| p.0 == model).map(|p| (p.1 / 1e5, p.2)).collect();
        if let Some(line) = line(&own).filter(|_| own.len() > 2) {
            println!(
                "{model}: layers take {:.1} ms + {:.2} ms a hundred thousand triangles, R² = {:.3}",
                line.base, line.slope, line.r2
            );
        }
    }
}
