//! What skipping the tiles that no occluder can shadow saves, and what it costs where there are none.
//!
//! `cargo bench --bench tiles` (`-- --quick` for fewer rounds, names of tables for those alone). With and without
//! are measured in one process, in turns, and told as medians of the passes over the pixels.

// A bench tells what goes wrong by panicking.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "../technique/mod.rs"]
mod technique;

use antumbra::Technique;
use antumbra::scene::{Camera, Role, Scene};
use antumbra_harness::{FrameTimes, HeadlessDevice, View};
use glam::{DMat4, DVec3};
use technique::table::{Table, median};
use technique::{Options, Ready, Study, in_turns, make_tables, scene, settings};

const STUDIES: [Study; 4] = [
    ("soft_shadow_map", soft_shadow_map),
    ("pcss", pcss),
    ("occlusion_textures", occlusion_textures),
    ("occlusion_levels", occlusion_levels),
];

const EXTENT: [u32; 2] = [640, 480];

fn main() {
    let full = Options { rounds: 11, sides: &[256, 512] };
    make_tables(&STUDIES, full, Options { rounds: 5, sides: &[256] });
}

/// Stands further off from what it frames, by this factor.
fn from_afar(scene: &Scene, factor: f64) -> Camera {
    let mut camera = Camera::framing(scene, 4.0 / 3.0);
    let target = DVec3::new(0.0, 1.0, 0.0);
    let eye = camera.world_from_view.w_axis.truncate();
    camera.world_from_view.w_axis = (target + factor * (eye - target)).extend(1.0);
    camera
}

/// Scenes with what looks at them. Occluders receive as well, so that their own shadows are among the pixels.
fn views(side: f64) -> Vec<(&'static str, Scene, View)> {
    let receiving = |name| scene(name, side).with_occluders_as(Role::Both);
    let perspective = |camera: &Camera| View::perspective(camera, EXTENT);
    let framed = |name| {
        let scene = receiving(name);
        let view = perspective(&Camera::framing(&scene, 4.0 / 3.0));
        (name, scene, view)
    };
    let card = receiving("card");
    let afar = perspective(&from_afar(&card, 3.0));
    // The same camera, turned aside until the shadow is out of sight.
    let mut aside = Camera::framing(&card, 4.0 / 3.0);
    aside.world_from_view =
        DMat4::from_translation(DVec3::new(8.0, 0.0, 8.0)) * aside.world_from_view;
    let lit = perspective(&aside);
    // A host without a mask: all that is seen blocks as well as receives.
    let mut blocks = receiving("bunny");
    blocks.instances.iter_mut().for_each(|i| i.role = Role::Both);
    let blocking = perspective(&Camera::framing(&blocks, 4.0 / 3.0));
    // Nothing to be spared: the ground under the bunny, from above.
    let shadow = (scene("bunny", side), View::map_of_ground(0.2, 8.0));
    vec![
        ("in shadow", shadow.0, shadow.1),
        ("card afar", card.clone(), afar),
        ("lit ground", card, lit),
        framed("bunny"),
        framed("foliage"),
        ("all block", blocks, blocking),
    ]
}

/// Median milliseconds of the passes that end so.
fn ms(times: &[FrameTimes], ends: &[&str]) -> f64 {
    let sum = |t: &FrameTimes| {
        let passes = t.passes.iter().filter(|(name, _)| ends.iter().any(|e| name.ends_with(e)));
        passes.map(|(_, ms)| ms).sum::<f64>()
    };
    median(&times.iter().map(sum).collect::<Vec<_>>())
}

fn compared(
    name: &'static str,
    technique: Technique,
    words: &str,
    pass: &str,
    device: &HeadlessDevice,
    options: &Options,
) -> Table {
    let columns =
        ["scene", "L", "N", "lit %", "without ms", "tiles ms", "listed ms", "with/without"];
    let mut table = Table::new(name, &columns);
    for side in [0.1, 1.0] {
        for (scene_name, scene, view) in &views(side) {
            for n in options.sides {
                let mut pair = ["off", "on"].map(|switch| {
                    let words = format!("map={n} classify={switch} {words}");
                    Ready::seen(device, scene, settings(technique, &words), view, EXTENT)
                });
                let [off, on] = pair.each_mut().map(Ready::visibility);
                assert!(off == on, "{scene_name}: tiles change the image");
                let lit = on.iter().filter(|v| **v == 1.0).count() as f64 / on.len() as f64;
                let times = in_turns(&mut pair, options.rounds);
                let without = ms(&times[0], &[pass]);
                let tiles =
                    ms(&times[1], &["tiles_start", "tiles", "pcss.nearest", "textures.squares"]);
                let listed = ms(&times[1], &[pass]);
                table.row(vec![
                    (*scene_name).into(),
                    format!("{side}"),
                    n.to_string(),
                    format!("{:.0}", 100.0 * lit),
                    format!("{without:.1}"),
                    format!("{tiles:.1}"),
                    format!("{listed:.1}"),
                    format!("{:.2}", (tiles + listed) / without),
                ]);
            }
        }
    }
    table
}

fn soft_shadow_map(device: &HeadlessDevice, options: &Options) -> Table {
    let name = "soft_shadow_map";
    compared(name, Technique::SoftShadowMap, "", "gather_pixels", device, options)
}

fn pcss(device: &HeadlessDevice, options: &Options) -> Table {
    compared("pcss", Technique::Pcss, "", "pcss.visibility", device, options)
}

fn occlusion_textures(device: &HeadlessDevice, options: &Options) -> Table {
    let pass = "occlusion_textures.visibility";
    compared("occlusion_textures", Technique::OcclusionTextures, "", pass, device, options)
}

/// The same with means from levels.
fn occlusion_levels(device: &HeadlessDevice, options: &Options) -> Table {
    let (name, pass) = ("occlusion_levels", "occlusion_textures.visibility");
    let words = "prefilter=mip slices=8";
    compared(name, Technique::OcclusionTextures, words, pass, device, options)
}
