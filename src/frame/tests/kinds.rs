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

const WALL: MeshBounds = [[-0.1, 0.0, -3.0], [0.1, 9.0, 3.0]];

/// A perspective camera 3 m above the ground, with reversed depth.
fn looking_down() -> DMat4 {
    let clip_from_view = DMat4::from_cols_array(&[
        1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.1, 0.0,
    ]);
    let world_from_view =
        DMat4::from_translation(DVec3::new(0.0, 3.0, 0.5)) * DMat4::from_rotation_x(-0.3);
    world_from_view * clip_from_view.inverse()
}

/// Each technique with views is seen through several where walls reach up to a lamp, or a sun shines on wide ground.
#[test]
fn several_views_are_planned_where_they_are_called_for() {
    let wide = [[-150.0, 0.0, -150.0], [150.0, 0.0, 150.0]];
    let yard = [
        mesh(wide, DVec3::ZERO, Role::Both),
        mesh(WALL, DVec3::new(1.0, 0.0, -2.0), Role::Both),
        mesh(WALL, DVec3::new(60.0, 0.0, -90.0), Role::Both),
    ];
    let room = [meshes()[0], meshes()[1], mesh(WALL, DVec3::new(3.0, 0.0, 0.0), Role::Both)];
    let sun = Light::sun(DVec3::new(0.2, -1.0, 0.1), 0.01, DVec3::ZERO, 220.0).unwrap();
    for words in
        ["hard", "pcss", "back-projection", "soft-shadow-map", "ray-march", "occlusion-textures"]
    {
        let description = Description { technique: words.parse().unwrap(), ..description(&[]) };
        let world_from_ndc = looking_down();
        let lamp = Frame { world_from_ndc, ..frame(&room) };
        let under_sun = Frame { light: sun, world_from_ndc, ..frame(&yard) };
        for (frame, is_parallel) in [(lamp, false), (under_sun, true)] {
            let plan = make(&description, &frame);
            let views = plan.views();
            assert!(views.len() > 1 && views.len() <= 6, "{words}: {}", plan.explain());
            assert!(views.iter().all(|view| view.is_parallel == is_parallel));
            let texels: Vec<f64> = views.iter().map(|view| view.texel[0]).collect();
            assert!(is_parallel || texels.is_sorted(), "{words}: the finest first: {texels:?}");
            let most = plan.plan.steps.iter().map(|s| s.barriers.len()).max();
            println!("{words}: {most:?} barriers in a step");
            let said = format!("views: {}, since ", views.len());
            assert!(plan.explain().contains(&said) && !plan.why_views().is_empty());
            let mut one = description.clone();
            one.technique.set("views", "1").unwrap();
            assert_eq!(make(&one, &frame).views().len(), 1, "{words}");
        }
        let few = meshes();
        assert_eq!(make(&description, &frame(&few)).views().len(), 1, "{words}");
        assert!(make(&description, &frame(&[])).views().is_empty(), "{words}: nothing is shadowed");
    }
}

/// The nearest receiver decides how fine a sun's views are, wherever it stands in the list of meshes.
#[test]
fn the_last_of_many_meshes_may_be_the_nearest() {
    let wide = [[-150.0, 0.0, -150.0], [150.0, 0.0, 150.0]];
    let far = (0..300).map(|i| {
        let at = DVec3::new(f64::from(i % 20) * 6.0 - 60.0, 0.0, -80.0 - f64::from(i / 20));
        mesh(WALL, at, Role::Both)
    });
    let ground = mesh(wide, DVec3::ZERO, Role::Both);
    let mut meshes: Vec<_> = far.chain([ground]).collect();
    let sun = Light::sun(DVec3::new(0.2, -1.0, 0.1), 0.01, DVec3::ZERO, 220.0).unwrap();
    let description = Description { technique: "hard".parse().unwrap(), ..description(&[]) };
    let views = |meshes: &[MeshInstance]| {
        let frame = Frame { light: sun, world_from_ndc: looking_down(), ..frame(meshes) };
        make(&description, &frame).views().to_vec()
    };
    let last = views(&meshes);
    meshes.rotate_right(1);
    let first = views(&meshes);
    assert_eq!(last.len(), first.len());
    for (a, b) in last.iter().zip(&first) {
        assert!((a.texel[0] / b.texel[0] - 1.0).abs() < 1e-9, "{last:?}, {first:?}");
    }
    assert!(last[0].texel[0] < 0.1, "{last:?}");
}

#[test]
fn frames_have_the_kinds_that_the_node_was_made_for() {
    let cube = meshes();
    let sheet = vec![cube[0], mesh(GROUND, DVec3::new(0.0, 1.5, 0.0), Role::Occluder)];
    // Several views show what reaches up to the light's plane.
    let walls = vec![cube[0], cube[1], mesh(WALL, DVec3::new(3.0, 0.0, 0.0), Role::Both)];
    let low = vec![cube[0], mesh(CUBE, DVec3::new(0.0, 0.01, 0.0), Role::Occluder)];
    for words in WAYS {
        let description =
            Description { technique: words.parse().unwrap(), ..Description::new([64, 48]) };
        let full = full_graph(&description);
        let names = |graph: &graph::Graph| graph.kinds().map(|p| p.name).collect::<Vec<_>>();
        let lamp = |side| Light::from(generate::square_light(side).unwrap());
        let sun = Light::sun(DVec3::new(0.2, -1.0, 0.1), 0.01, DVec3::ZERO, 6.0).unwrap();
        let point = RectangleLight::point(DVec3::Y * 4.0, DVec3::NEG_Y).unwrap().into();
        for (meshes, light) in [
            (&cube, lamp(0.5)),
            (&sheet, lamp(0.5)),
            (&low, lamp(1e-6)),
            (&sheet, lamp(1e-6)),
            (&Vec::new(), lamp(0.5)),
            (&walls, lamp(0.5)),
            (&cube, sun),
            (&walls, sun),
            (&cube, point),
            (&walls, point),
        ] {
            for omit in [Omit::Nothing, Omit::Invisible, Omit::Below(1.0)] {
                let description = Description { omit, ..description.clone() };
                let frame = Frame { light, world_from_ndc: looking_down(), ..frame(meshes) };
                let plan = make(&description, &frame);
                assert_eq!(names(&plan.plan.graph), names(&full), "{words}");
                assert!(plan.plan.graph.passes().len() <= full.passes().len(), "{words}");
                assert!(!plan.plan.skipped.is_empty(), "{words}: lit, or the rest");
            }
        }
    }
}
