//! Rays at the G-buffer's pixels beside rays at fragments as they are drawn.

use crate::Scale;
use crate::ray_march::ms;
use crate::ready::{median_of, passes_ms};
use crate::table::Table;
use antumbra::scene::{Camera, Instance, Role, Scene, generate};
use antumbra_bench::scenes::committed;
use antumbra_bench::stats::median;
use antumbra_harness::{Forward, HeadlessDevice, Stage, View, technique};

const EXTENT: [u32; 2] = [640, 480];

/// Scenes whose objects shadow themselves, from a camera; what is drawn first is the ground.
fn scenes() -> [(&'static str, Scene); 3] {
    let light = generate::square_light(0.4).unwrap();
    let foliage = generate::foliage(light, 300, 7).with_occluders_as(Role::Both);
    let spheres = generate::spheres(light).with_occluders_as(Role::Both);
    [("bunny", committed("bunny").unwrap()), ("foliage", foliage), ("spheres", spheres)]
}

/// The cost of evaluating per fragment: the same rays by the same maps, without a filter. Deferred are the
/// G-buffer and the node's passes over pixels, forward is the drawing that sends rays (the ratio is between
/// these); the levels are either's. What forward pays for: fragments that are drawn over, and those outside of
/// a triangle that its edge pixels' 2×2 quads are filled up with, which cost as much; small triangles have
/// three of those for each that is seen. What deferred pays for: a plane from a dozen depths, and the list.
pub fn forward(device: &HeadlessDevice, scale: &Scale, table: &mut Table) {
    table.head("scene|rays|levels ms|gbuffer|pixels|forward|ratio|differ %|mean");
    for (name, scene) in scenes() {
        let light = scene.light(None).unwrap().light;
        let aspect = f64::from(EXTENT[0]) / f64::from(EXTENT[1]);
        let camera = scene.camera.unwrap_or_else(|| Camera::framing(&scene, aspect));
        let view = View::of(&camera, EXTENT);
        for rays in [4, 9, 16] {
            let settings = technique(&format!("ray-march map=512 rays={rays} filter=off"));
            let keep = |_: &Instance| true;
            let mut stage = Stage::new(device, &scene, &view, EXTENT, settings, keep).unwrap();
            let plan = stage.plan(light, None).unwrap();
            let mut forward = Forward::new(device, stage, plan, &scene, keep).unwrap();
            let mut drawn = Vec::new();
            let mut parts: [Vec<f64>; 3] = Default::default();
            for round in 0..=scale.rounds {
                let painted = forward.paint_gbuffer().unwrap();
                let deferred = forward.run_deferred().unwrap();
                let times = forward.run().unwrap();
                if round == 0 {
                    // What the driver compiles, it compiles now.
                    continue;
                }
                parts[0].push(painted.as_secs_f64() * 1e3);
                parts[1].push(ms(&deferred, &["start", "classify", "trace"]));
                parts[2].push(times.passes.last().unwrap().1);
                drawn.push(times);
            }
            let [gbuffer, pixels, at_fragments] = parts.map(|times| median(&times));
            let common = median_of(&drawn, |t| passes_ms(t, |_| true) - t.passes.last().unwrap().1);
            let images = (forward.deferred_visibility().unwrap(), forward.visibility().unwrap());
            let pairs = || images.0.iter().zip(&images.1).filter(|(a, b)| **a < 1.0 || **b < 1.0);
            let count = pairs().count() as f64;
            let differ = pairs().filter(|(a, b)| (*a - *b).abs() > 1e-3).count() as f64;
            let differ = 100.0 * differ / count;
            let mean = pairs().map(|(a, b)| f64::from((a - b).abs())).sum::<f64>() / count;
            let ratio = at_fragments / (gbuffer + pixels);
            let times = format!("{common:.1}|{gbuffer:.1}|{pixels:.1}|{at_fragments:.1}");
            table.row(format!("{name}|{rays}|{times}|{ratio:.2}|{differ:.1}|{mean:.4}"));
        }
    }
}
