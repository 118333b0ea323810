//! Error and time against how many views a light may have, and against the side of their maps.

use crate::groups::{Entry, Group};
use crate::options::Scale;
use crate::places::{ROOM, STREET, SUN};
use crate::scenes::{SceneSpec, Source};

/// A study a technique, so that not all of their nodes are there at once: its name, and the technique.
pub const STUDIES: [(&str, &str); 4] = [
    ("views of ray-march", "ray-march"),
    ("views of soft-shadow-map", "soft-shadow-map"),
    ("views of occlusion-textures", "occlusion-textures"),
    ("views of pcss", "pcss"),
];

/// The sides of maps, texels.
pub const SIDES: [u32; 4] = [128, 256, 512, 1024];

/// The most views that a light may have.
const VIEWS: [u32; 6] = [1, 2, 3, 4, 6, 8];

/// What a curve of maps of a side is called.
pub fn curve(side: u32) -> String {
    format!("{side}²")
}

/// The groups, a scene after the other. The quick run has two techniques under a sun, with a few views each.
pub fn all(scale: &Scale) -> Vec<Group> {
    let of = |(study, technique): (&'static str, &'static str), scene: &'static str, light| {
        let sides = SIDES.iter().filter(|side| !scale.quick || [128, 512].contains(side));
        let entries = sides.flat_map(|&side| {
            let views = VIEWS.iter().filter(|views| !scale.quick || [1, 2, 4].contains(views));
            views.map(move |&views| {
                let words = format!("views={views} map={side}");
                Entry::new(technique, &curve(side), words, f64::from(views))
            })
        });
        let spec = SceneSpec { name: scene.into(), source: Source::Place(scene) };
        Group::seen(study, &spec, light, scale.view, entries.collect())
    };
    let is_quick = |technique: &str| ["ray-march", "pcss"].contains(&technique);
    let wanted = STUDIES.into_iter().filter(|s| !scale.quick || is_quick(s.1));
    let scenes = [(STREET, SUN), (ROOM, "ceiling panel")];
    let scenes = &scenes[..if scale.quick { 1 } else { scenes.len() }];
    wanted.flat_map(|study| scenes.iter().map(move |(s, l)| of(study, s, l))).collect()
}
