//! Which sides of faces pixels see, and where their normals point.

use antumbra::RectangleLight;
use antumbra::scene::{AreaLight, Mesh, Role, Scene, generate};
use antumbra_harness::{Stage, View, shade};
use antumbra_tests::device;
use antumbra_tests::measure::{Setup, percent};
use antumbra_tests::situations::looking;
use glam::{DMat4, DVec3};

const EXTENT: [u32; 2] = [80, 60];

/// A box of two metres whose fronts are inside, placed by a transform, under a lamp in it.
fn hollow(world_from_mesh: DMat4, double_sided: bool) -> Scene {
    let mut mesh = generate::cuboid(DVec3::splat(2.0));
    mesh.indices.chunks_exact_mut(3).for_each(|t| t.swap(1, 2));
    mesh.normals.iter_mut().for_each(|n| *n = n.map(|x| -x));
    mesh.double_sided = double_sided;
    let mut scene = Scene::default();
    scene.add("room", mesh, world_from_mesh, Role::Both);
    let lamp = RectangleLight::facing(DVec3::Y * 0.9, DVec3::NEG_Y, DVec3::Z, [0.3; 2]).unwrap();
    scene.lights.push(AreaLight {
        name: "lamp".into(),
        light: lamp.into(),
        color: [1.0; 3],
        intensity: 1.0,
    });
    scene
}

/// What a camera at (4, 3, 5) sees: the position, the normal and the plane of each pixel of a surface.
fn seen(scene: &Scene) -> (Stage, Vec<[DVec3; 3]>) {
    let device = device();
    let camera = looking([4.0, 3.0, 5.0], [0.0; 3], 0.6);
    let view = View::of(&camera, EXTENT);
    let setup = Setup { scene, view, extent: EXTENT, window: None, occluders_seen: true };
    let stage = setup.stage(&device, "technique=hard");
    let gbuffer = stage.gbuffer();
    let wide = |a: &[f32; 4]| DVec3::new(a[0].into(), a[1].into(), a[2].into());
    let (positions, normals) = (gbuffer.positions().unwrap(), gbuffer.normals().unwrap());
    let planes = gbuffer.planes().unwrap();
    let pixels = positions.iter().zip(normals.iter().zip(&planes));
    let shown = pixels.filter(|(p, _)| p[3] > 0.0);
    let found: Vec<_> = shown.map(|(p, (n, plane))| [wide(p), wide(n), wide(plane)]).collect();
    assert!(found.len() > 1000, "{} pixels show something", found.len());
    (stage, found)
}

const EYE: DVec3 = DVec3::new(4.0, 3.0, 5.0);

/// One looks into a room of single-sided faces from outside: its far walls are seen, however it is placed, mirrored too;
/// of the same room in double-sided faces the near ones are. Whatever is seen has its normals on the viewer's side.
#[test]
fn the_back_of_a_single_sided_face_is_not_seen() {
    let mirrored = DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0));
    for (name, place) in [("as it is", DMat4::IDENTITY), ("mirrored", mirrored)] {
        for double_sided in [false, true] {
            let (_, pixels) = seen(&hollow(place, double_sided));
            let near = pixels.iter().filter(|[p, ..]| p.max_element() > 0.999).count();
            let far = pixels.iter().filter(|[p, ..]| p.min_element() < -0.999).count();
            let (seen, hidden) = if double_sided { (near, far) } else { (far, near) };
            // Where two walls meet a pixel may count for both.
            assert!(
                seen == pixels.len() && hidden < pixels.len() / 20,
                "{name}, double-sided {double_sided}: {near} near and {far} far of {}",
                pixels.len()
            );
            for [p, normal, plane] in pixels {
                let to_viewer = EYE - p;
                assert!(normal.dot(to_viewer) > 0.0, "{name}, {double_sided}: {normal} at {p}");
                assert!(plane.dot(to_viewer) > 0.0, "{name}, {double_sided}: {plane} at {p}");
                assert!((normal - plane).length() < 2e-3, "{normal} is not {plane}");
            }
        }
    }
}

/// A face that is not seen still blocks light from either side: none leaves the room through the walls that one looks
/// through, and inside all is as the truth has it.
#[test]
fn a_face_that_is_not_seen_blocks_light() {
    let device = device();
    // The ground is so near to the room that the raster's grid decides which of them is above the other.
    if device.leaves_to_others("light through the backs of faces") {
        return;
    }
    let mut scene = hollow(DMat4::IDENTITY, false);
    // The ground beside it is seen through no wall, and no light comes through one.
    scene.add(
        "ground",
        generate::ground(6.0),
        DMat4::from_translation(DVec3::Y * -1.001),
        Role::Both,
    );
    let camera = looking([4.0, 3.0, 5.0], [0.0; 3], 0.9);
    let view = View::of(&camera, EXTENT);
    let setup = Setup { scene: &scene, view, extent: EXTENT, window: None, occluders_seen: true };
    let mut stage = setup.stage(&device, "technique=traced");
    let image = setup.visibility(&mut stage);
    let positions = stage.gbuffer().positions().unwrap();
    let outside = |p: &[f32; 4]| p[3] > 0.0 && p[0].abs().max(p[2].abs()) > 1.05;
    let ground: Vec<f32> =
        positions.iter().zip(&image).filter(|(p, _)| outside(p)).map(|(_, v)| *v).collect();
    assert!(ground.len() > 500, "{} pixels of ground", ground.len());
    assert!(ground.iter().all(|v| *v == 0.0), "light comes through a wall from behind");
    let (truth, _) = setup.traced(&stage, 64);
    let error = percent(&truth, &image);
    assert!(error < 1.0, "{error} % from the truth");
}

/// A double-sided wall that the eye and the lamp see from behind is lit in the picture, as is the same wall turned round.
#[test]
fn a_sheet_lit_from_behind_is_lit() {
    let device = device();
    let brightness = |turn: f64| {
        let mut scene = Scene::default();
        let wall = Mesh { double_sided: true, ..generate::quad(2.0, 2.0) };
        scene.add("wall", wall, DMat4::from_rotation_x(turn), Role::Both);
        let at = DVec3::new(0.5, 0.5, 3.0);
        let lamp = RectangleLight::facing(at, -at.normalize(), DVec3::Y, [0.3; 2]).unwrap();
        let light =
            AreaLight { name: "lamp".into(), light: lamp.into(), color: [1.0; 3], intensity: 1.0 };
        scene.lights.push(light.clone());
        let camera = looking([0.5, 0.2, 4.0], [0.0; 3], 0.5);
        let view = View::of(&camera, EXTENT);
        let setup =
            Setup { scene: &scene, view, extent: EXTENT, window: None, occluders_seen: true };
        let mut stage = setup.stage(&device, "technique=soft-shadow-map");
        let image = setup.visibility(&mut stage);
        let gbuffer = stage.gbuffer();
        let (positions, normals) = (gbuffer.positions().unwrap(), gbuffer.normals().unwrap());
        let shaded = shade::shade(&light, &image, &positions, &normals);
        let middle = (EXTENT[0] * (EXTENT[1] / 2) + EXTENT[0] / 2) as usize;
        (image[middle], shaded[3 * middle])
    };
    // The quad's front looks along +y, so that a quarter turn brings it before the eye, and the other away from it.
    let quarter = std::f64::consts::FRAC_PI_2;
    let (before, behind) = (brightness(quarter), brightness(-quarter));
    assert!(before.0 == 1.0 && before.1 > 150, "{before:?}");
    assert_eq!(before, behind);
}
