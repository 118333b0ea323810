//! A node makes its objects for the kinds of pass that each of its frames has.

use super::*;

/// Every technique, and every setting with passes of its own.
pub(super) const WAYS: [&str; 14] = [
    "hard",
    "pcss",
    "back-projection",
    "many-lights samples=4",
    "soft-shadow-map",
    "soft-shadow-map sides=one",
    "soft-shadow-map receivers=map sides=two",
    "soft-shadow-map receivers=map accumulate=blend",
    "ray-march",
    "ray-march layers=3 filter=off",
    "ray-march layers=2 levels=mip",
    "occlusion-textures",
    "occlusion-textures combine=product placement=uniform prefilter=mip",
    "linear-light",
];

#[test]
fn frames_have_the_kinds_that_the_node_was_made_for() {
    let cube = meshes();
    let sheet = vec![cube[0], mesh(GROUND, DVec3::new(0.0, 1.5, 0.0), Role::Occluder)];
    let low = vec![cube[0], mesh(CUBE, DVec3::new(0.0, 0.01, 0.0), Role::Occluder)];
    for words in WAYS {
        let description =
            Description { technique: words.parse().unwrap(), ..Description::new([64, 48]) };
        let full = full_graph(&description);
        let names = |graph: &graph::Graph| graph.kinds().map(|p| p.name).collect::<Vec<_>>();
        for (meshes, side) in
            [(&cube, 0.5), (&sheet, 0.5), (&low, 1e-6), (&sheet, 1e-6), (&Vec::new(), 0.5)]
        {
            let light = generate::square_light(side).unwrap();
            for omit in [Omit::Nothing, Omit::Invisible, Omit::Below(1.0)] {
                let description = Description { omit, ..description.clone() };
                let frame = Frame { light: light.into(), ..frame(meshes) };
                let plan = make(&description, &frame);
                assert_eq!(names(&plan.plan.graph), names(&full), "{words}");
                assert!(plan.plan.graph.passes().len() <= full.passes().len(), "{words}");
                assert!(!plan.plan.skipped.is_empty(), "{words}: lit, or the rest");
            }
        }
    }
}
