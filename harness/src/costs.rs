//! Measures the times of passes on a device by small frames, in under half a second.

use crate::{HeadlessDevice, Stage, View};
use antumbra::Error;
use antumbra::auto::{Costs, Measured, Table};
use antumbra::scene::{Camera, generate};

/// The image's size in pixels.
const EXTENT: [u32; 2] = [256, 192];

/// The number of frames whose median is the result; one before them warms the driver up.
const FRAMES: usize = 3;

/// The factors between this device and the one that measured the table that `auto` chooses by.
///
/// # Errors
/// Whatever the device refuses.
pub fn measure_costs(device: &HeadlessDevice) -> Result<Costs, Error> {
    let here = probe(device)?;
    let there = Table::own().probe;
    Ok(Costs::new(here.maps_ms / there.maps_ms, here.pixels_ms / there.pixels_ms))
}

/// Milliseconds of the maps and of the pixels of a frame that is the same everywhere: a soft shadow map of spheres.
///
/// # Errors
/// Whatever the device refuses.
pub fn probe(device: &HeadlessDevice) -> Result<Measured, Error> {
    let scene = generate::spheres(generate::square_light(0.4)?);
    let light = scene.light(None)?.clone();
    let camera = Camera::framing(&scene, f64::from(EXTENT[0]) / f64::from(EXTENT[1]));
    let view = View::of(&camera, EXTENT);
    let settings = "soft-shadow-map map=128".parse()?;
    let mut stage = Stage::new(device, &scene, &view, EXTENT, settings, |_| true)?;
    let plan = stage.plan_under(&light, None)?;
    stage.run(&plan)?;
    let mut sums = Vec::with_capacity(FRAMES);
    for _ in 0..FRAMES {
        let times = stage.run(&plan)?;
        let is_pixels = |name: &str| name == "soft_shadow_map.gather_pixels";
        let sum = |pixels| {
            let passes = times.passes.iter().filter(|(name, _)| is_pixels(name) == pixels);
            passes.map(|(_, ms)| ms).sum::<f64>()
        };
        sums.push((sum(false), sum(true)));
    }
    let median = |of: fn(&(f64, f64)) -> f64| {
        let mut all: Vec<f64> = sums.iter().map(of).collect();
        all.sort_by(f64::total_cmp);
        all[FRAMES / 2]
    };
    Ok(Measured { error: 0.0, maps_ms: median(|s| s.0), pixels_ms: median(|s| s.1) })
}
