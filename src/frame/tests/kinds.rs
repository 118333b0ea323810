//! What a node makes its objects from is the same kinds of row as any frame of it has.

use super::*;
use crate::settings::Settings;

/// Every technique, and those settings that have rows of their own.
pub(super) const WAYS: [&str; 14] = [
    "technique=hard",
    "technique=pcss",
    "technique=back-projection",
    "technique=many-lights samples=4",
    "technique=soft-shadow-map",
    "technique=soft-shadow-map sides=one",
    "technique=soft-shadow-map receivers=map sides=two",
    "technique=soft-shadow-map receivers=map accumulate=blend",
    "technique=ray-march",
    "technique=ray-march layers=3 filter=off",
    "technique=ray-march layers=2 levels=mip",
    "technique=occlusion-textures",
    "technique=occlusion-textures combine=product placement=uniform prefilter=mip",
    "technique=linear-light",
];

pub(super) fn settings(words: &str) -> Settings {
    let mut settings = Settings::default();
    for word in words.split_whitespace() {
        match word.split_once('=').unwrap() {
            ("technique", name) => settings.technique = name.parse().unwrap(),
            (key, value) => settings.set(key, value).unwrap(),
        }
    }
    settings
}

#[test]
fn frames_have_the_kinds_that_the_node_was_made_for() {
    let cube = meshes();
    let sheet = vec![cube[0], mesh(GROUND, DVec3::new(0.0, 1.5, 0.0), Role::Occluder)];
    let low = vec![cube[0], mesh(CUBE, DVec3::new(0.0, 0.01, 0.0), Role::Occluder)];
    for words in WAYS {
        let description = Description { settings: settings(words), ..Description::new([64, 48]) };
        let full = full_graph(&description);
        let names = |graph: &graph::Graph| graph.kinds().map(|p| p.name).collect::<Vec<_>>();
        for (meshes, side) in
            [(&cube, 0.5), (&sheet, 0.5), (&low, 1e-6), (&sheet, 1e-6), (&Vec::new(), 0.5)]
        {
            let light = generate::square_light(side).unwrap();
            for max_error in [None, Some(0.0), Some(1.0)] {
                let description = Description { max_error, ..description.clone() };
                let frame = Frame { light, ..frame(meshes) };
                let plan = make(&description, &frame);
                assert_eq!(names(&plan.plan.graph), names(&full), "{words}");
                assert!(plan.plan.graph.passes().len() <= full.passes().len(), "{words}");
                assert!(!plan.plan.skipped.is_empty(), "{words}: lit, or the rest");
            }
        }
    }
}
