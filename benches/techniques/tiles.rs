//! What it saves to find the tiles of pixels that no occluder can affect, and what it costs where there are none.
//!
//! Both are medians of the passes over the pixels.

use crate::ready::{Ready, ending_ms, in_turns, scene};
use crate::table::Table;
use crate::{Bench, Scale};
use antumbra::scene::{Camera, Role, Scene};
use antumbra_bench::scenes::camera_at;
use antumbra_harness::{HeadlessDevice, View};
use glam::{DMat4, DVec3};

pub const BENCH: Bench = Bench {
    name: "tiles",
    about: "Tiles of pixels that no occluder can affect: with and without finding them",
    studies: &[
        ("soft_shadow_map", |device, scale, table| {
            compared("soft-shadow-map", "gather_pixels", device, scale, table);
        }),
        ("pcss", |device, scale, table| compared("pcss", "pcss.visibility", device, scale, table)),
        ("occlusion_textures", |device, scale, table| {
            compared("occlusion-textures", TEXTURES, device, scale, table);
        }),
        // With means from levels.
        ("occlusion_levels", |device, scale, table| {
            let words = "occlusion-textures prefilter=mip slices=8";
            compared(words, TEXTURES, device, scale, table);
        }),
    ],
    full: Scale { rounds: 11, sides: &[256, 512], quick: false },
    quick: Scale { rounds: 5, sides: &[256], quick: true },
};

/// The pass of occlusion textures over the pixels.
const TEXTURES: &str = "occlusion_textures.visibility";

const EXTENT: [u32; 2] = [640, 480];

/// Scenes with what looks at them. Occluders receive as well, so that their own shadows are among the pixels.
fn views(side: f64) -> [(&'static str, Scene, View); 6] {
    let receiving = |name| scene(name, side).with_occluders_as(Role::Both);
    let perspective = |camera: &Camera| View::of(camera, EXTENT);
    let framed = |name, scene: Scene| {
        let view = perspective(&Camera::framing(&scene, 4.0 / 3.0));
        (name, scene, view)
    };
    let card = receiving("card");
    let afar = perspective(&camera_at(&card, DVec3::Y, 3.0));
    // The same camera, turned aside until the shadow is out of sight.
    let mut aside = Camera::framing(&card, 4.0 / 3.0);
    aside.world_from_view =
        DMat4::from_translation(DVec3::new(8.0, 0.0, 8.0)) * aside.world_from_view;
    let lit = perspective(&aside);
    // A host without a mask: all that is seen blocks as well as receives.
    let mut blocks = receiving("bunny");
    blocks.instances.iter_mut().for_each(|i| i.role = Role::Both);
    [
        // Nothing to be spared: the ground under the bunny, from above.
        ("in shadow", scene("bunny", side), View::map_of_ground(0.2, 8.0)),
        ("card afar", card.clone(), afar),
        ("lit ground", card, lit),
        framed("bunny", receiving("bunny")),
        framed("foliage", receiving("foliage")),
        framed("all block", blocks),
    ]
}

fn compared(words: &str, pass: &str, device: &HeadlessDevice, scale: &Scale, table: &mut Table) {
    table.head("scene|L|N|lit %|without ms|tiles ms|listed ms|with/without");
    for side in [0.1, 1.0] {
        for (scene_name, scene, view) in &views(side) {
            for n in scale.sides {
                let mut pair = ["off", "on"].map(|switch| {
                    let words = format!("{words} map={n} classify={switch}");
                    Ready::seen(device, scene, &words, view, EXTENT)
                });
                let [off, on] = pair.each_mut().map(Ready::visibility);
                assert!(off == on, "{scene_name}: tiles change the image");
                let lit = on.iter().filter(|v| **v == 1.0).count() as f64 / on.len() as f64;
                let times = in_turns(&mut pair, scale.rounds);
                let [without, listed] = [0, 1].map(|i| ending_ms(&times[i], &[pass]));
                let finding = ["tiles_start", "tiles", "pcss.nearest", "textures.squares"];
                let tiles = ending_ms(&times[1], &finding);
                let (lit, ratio) = (100.0 * lit, (tiles + listed) / without);
                let ms = format!("{without:.1}|{tiles:.1}|{listed:.1}");
                table.row(format!("{scene_name}|{side}|{n}|{lit:.0}|{ms}|{ratio:.2}"));
            }
        }
    }
}
