//! Rays at the G-buffer's pixels beside rays at fragments as they are drawn.

use super::{Options, median_of, ms, settings};
use crate::technique::table::Table;
use antumbra::scene::{Camera, Instance, Role, Scene, from_gltf, generate};
use antumbra_harness::{Forward, HeadlessDevice, Stage, View};
use std::path::Path;

const EXTENT: [u32; 2] = [640, 480];

/// Scenes whose objects shadow themselves, from a camera; what is drawn first is the ground.
fn scenes() -> Vec<(&'static str, Scene)> {
    let light = generate::square_light(0.4).unwrap();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/bunny.glb");
    let foliage = generate::foliage(light, 300, 7).with_occluders_as(Role::Both);
    let spheres = generate::spheres(light).with_occluders_as(Role::Both);
    vec![("bunny", from_gltf(&path).unwrap()), ("foliage", foliage), ("spheres", spheres)]
}

/// The cost of evaluating per fragment: the same rays by the same maps, without a filter. Deferred are the
/// G-buffer and the node's passes over pixels, forward is the drawing that sends rays (the ratio is between
/// these); the levels are either's. What forward pays for: fragments that are drawn over, and those outside of
/// a triangle that its edge pixels' 2×2 quads are filled up with, which cost as much; small triangles have
/// three of those for each that is seen. What deferred pays for: a plane from a dozen depths, and the list.
pub fn forward(device: &HeadlessDevice, options: &Options) -> Table {
    let columns =
        ["scene", "rays", "levels ms", "gbuffer", "pixels", "forward", "ratio", "differ %", "mean"];
    let mut table = Table::new("forward", &columns);
    for (name, scene) in scenes() {
        let light = scene.light(None).unwrap().light;
        let aspect = f64::from(EXTENT[0]) / f64::from(EXTENT[1]);
        let camera = scene.camera.unwrap_or_else(|| Camera::framing(&scene, aspect));
        let view = View::perspective(&camera, EXTENT);
        for rays in [4, 9, 16] {
            let settings = settings(&format!("map=512 rays={rays} filter=off"));
            let keep = |_: &Instance| true;
            let mut stage = Stage::new(device, &scene, &view, EXTENT, settings, keep).unwrap();
            let plan = stage.plan(&light, None).unwrap();
            let mut forward = Forward::new(device, stage, plan, &scene, keep).unwrap();
            let mut drawn = Vec::new();
            let (mut gbuffer, mut pixels, mut at_fragments) = (Vec::new(), Vec::new(), Vec::new());
            for round in 0..=options.rounds {
                let painted = forward.paint_gbuffer().unwrap();
                let deferred = forward.run_deferred().unwrap();
                let times = forward.run().unwrap();
                if round == 0 {
                    // What the driver compiles, it compiles now.
                    continue;
                }
                gbuffer.push(painted.as_secs_f64() * 1e3);
                pixels.push(ms(&deferred, &["start", "classify", "trace"]));
                at_fragments.push(times.passes.last().unwrap().1);
                drawn.push(times);
            }
            let [gbuffer, pixels, at_fragments] = [gbuffer, pixels, at_fragments]
                .map(|times| crate::technique::table::median(&times));
            let common = |t: &antumbra_harness::FrameTimes| {
                t.passes.iter().map(|(_, ms)| ms).sum::<f64>() - t.passes.last().unwrap().1
            };
            let images = (forward.deferred_visibility().unwrap(), forward.visibility().unwrap());
            let pairs = || images.0.iter().zip(&images.1).filter(|(a, b)| **a < 1.0 || **b < 1.0);
            let count = pairs().count() as f64;
            let differ = pairs().filter(|(a, b)| (*a - *b).abs() > 1e-3).count() as f64;
            let mean = pairs().map(|(a, b)| f64::from((a - b).abs())).sum::<f64>() / count;
            table.row(vec![
                name.into(),
                rays.to_string(),
                format!("{:.1}", median_of(&drawn, common)),
                format!("{gbuffer:.1}"),
                format!("{pixels:.1}"),
                format!("{at_fragments:.1}"),
                format!("{:.2}", at_fragments / (gbuffer + pixels)),
                format!("{:.1}", 100.0 * differ / count),
                format!("{mean:.4}"),
            ]);
        }
    }
    table
}
