//! Plans of many meshes: they take no memory after the first frame, and leave out nothing that casts a shadow.

use allocation_counter::measure;
use antumbra::LightIndex;
use antumbra::frame::{CutOuts, Limits, plan, plan_all};
use antumbra::graph::{MeshList, Scope};
use antumbra::lent::OpacityTexture;
use antumbra::scene::{Role, Scene, generate};
use antumbra::truth::{Exact, PolygonLight, Receiver};
use antumbra::{
    Description, Frame, FramePlan, FramePlans, Geometry, HostImage, Light, MeshBuffers,
    MeshInstance, RectangleLight, Slot,
};
use antumbra_tests::measure::settings;
use ash::vk::{self, Handle};
use glam::{DMat4, DVec3};
use std::collections::BTreeSet;

/// Cubes over a ground, in a row.
fn meshes(shift: f64) -> Vec<MeshInstance> {
    let buffers = MeshBuffers::indexed(vk::Buffer::from_raw(3), 12, vk::Buffer::from_raw(4), 36);
    let mesh = |bounds, at, role| {
        MeshInstance::new(Geometry::Buffers(buffers), DMat4::from_translation(at), bounds, role)
    };
    let ground = mesh([[-9.0, 0.0, -9.0], [9.0, 0.0, 9.0]], DVec3::ZERO, Role::Receiver);
    let at = |i: u32| DVec3::new(shift + 0.5 * f64::from(i) - 5.0, 1.0, 0.1 * f64::from(i % 5));
    let cube = |i| mesh([[-0.2; 3], [0.2; 3]], at(i), Role::Both);
    // Several views show a wall that reaches up to a lamp.
    let wall = mesh([[-0.1, 0.0, -3.0], [0.1, 9.0, 3.0]], DVec3::new(7.0, 0.0, 0.0), Role::Both);
    std::iter::once(ground).chain((0..20).map(cube)).chain([wall]).collect()
}

/// A G-buffer's depth that nobody looks at.
fn image() -> HostImage {
    HostImage {
        image: vk::Image::from_raw(1),
        view: vk::ImageView::from_raw(2),
        format: vk::Format::D32_SFLOAT,
        extent: [64, 64],
        usage: vk::ImageUsageFlags::SAMPLED,
        before: Scope::FRAGMENT_SAMPLED,
        after: Scope::FRAGMENT_SAMPLED,
    }
}

/// Frames of four lights, at a moment.
fn frames(meshes: &[MeshInstance], moment: u32, stays: bool, with_sun: bool) -> [Frame<'_>; 4] {
    [0, 1, 2, 3].map(|light_index| {
        let lamp = Light::from(generate::square_light(0.3).unwrap());
        let sun = Light::sun(DVec3::new(0.3, -1.0, 0.2), 0.01, DVec3::ZERO, 13.0).unwrap();
        let light = if light_index == 2 && with_sun { sun } else { lamp };
        // Reversed depth without a far plane, from 4 m above.
        let clip_from_view = DMat4::from_cols_array(&[
            1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.1, 0.0,
        ]);
        let above = DVec3::new(0.1 * f64::from(moment), 4.0, 0.5);
        let world_from_view = DMat4::from_translation(above) * DMat4::from_rotation_x(-0.8);
        let camera = world_from_view * clip_from_view.inverse();
        Frame {
            light_index: LightIndex(light_index),
            background: Some(0.0),
            reach: (light_index == 3).then_some(3.5),
            revision: stays.then_some(1),
            ..Frame::new(Slot(0), light, camera, meshes, image())
        }
    })
}

#[test]
fn planning_takes_no_memory_after_the_first_frame() {
    for (words, audit) in [
        ("technique=soft-shadow-map", 0),
        ("technique=soft-shadow-map receivers=map accumulate=blend", 0),
        ("technique=ray-march", 0),
        ("technique=occlusion-textures", 0),
        ("technique=pcss", 0),
        ("technique=pcss", 64),
        ("technique=hard", 0),
        ("technique=back-projection", 0),
        ("technique=traced", 0),
    ] {
        let plain = Description::new([64; 2]);
        let cut_outs = CutOuts { meshes: 8, texels: 100 };
        let technique = settings(words);
        let description = Description { technique, lights: 4, audit, cut_outs, ..plain };
        for stays in [false, true] {
            let mut plans = FramePlans::new();
            // To and fro: where more meshes matter than ever before, their list grows.
            for (nth, moment) in [2, 1, 0, 1, 2, 1, 0].into_iter().enumerate() {
                let mut meshes = meshes(if stays { 0.0 } else { 0.05 * f64::from(moment) });
                // Every fourth cube is cut out, by two textures in turn.
                for (nth, mesh) in meshes.iter_mut().enumerate().skip(1).step_by(4) {
                    let view = vk::ImageView::from_raw(10 + nth as u64 % 8);
                    let coordinates = vk::Buffer::from_raw(5);
                    mesh.opacity = Some(OpacityTexture::new(view, [16, 9], coordinates));
                }
                // The weights of round lights are made anew for each plan of traced.
                let with_sun = !words.contains("traced");
                let frames = frames(&meshes, moment, stays, with_sun);
                let taken = measure(|| {
                    plan_all(&description, Limits::default(), &frames, &mut plans).unwrap();
                });
                let some = taken.count_total;
                let known = nth > if stays { 0 } else { 2 };
                assert!(!known || some == 0, "{words}, frame {nth}: {some} allocations");
                assert!(nth > 0 || some > 0, "nothing is counted");
            }
        }
    }
}

/// A plan in memory of earlier frames has the passes of one that is made alone, whatever came and went: so many meshes that
/// the hierarchy has a level of boxes more, and textures that cut some of them out.
#[test]
fn a_plan_after_others_is_that_of_a_frame_alone() {
    for (words, audit) in [("technique=traced", 0), ("technique=pcss", 64), ("technique=hard", 0)] {
        let description = Description {
            technique: settings(words),
            audit,
            cut_outs: CutOuts { meshes: 8, texels: 100 },
            ..Description::new([64; 2])
        };
        let mut plans = FramePlans::new();
        let mut seen = BTreeSet::new();
        for (count, cut) in [(3, 0), (22, 0), (22, 2), (3, 1), (22, 1), (3, 0), (3, 1)] {
            let mut meshes = meshes(0.0);
            // The wall is the last of them, and stays.
            meshes.drain(1..22 - (count - 2));
            let texture =
                OpacityTexture::new(vk::ImageView::from_raw(7), [8, 8], vk::Buffer::from_raw(5));
            meshes.iter_mut().skip(1).take(cut).for_each(|mesh| mesh.opacity = Some(texture));
            let [frame, ..] = frames(&meshes, 0, false, false);
            let alone = plan(&description, Limits::default(), &frame).unwrap();
            plan_all(&description, Limits::default(), &[frame], &mut plans).unwrap();
            let names = |plan: &FramePlan| -> Vec<&str> {
                let graph = &plan.plan().graph;
                plan.plan().steps.iter().map(|step| graph.passes()[step.pass].name).collect()
            };
            let passes = names(&alone);
            assert_eq!(names(&plans.all()[0]), passes, "{words}: {count} meshes, {cut} cut out");
            seen.insert(passes);
        }
        assert!(seen.len() > 1, "{words}: all frames have the same passes");
    }
}

/// Numbers from −1 to 1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as f64 / f64::from(1u32 << 30) - 1.0
    }

    fn point(&mut self) -> DVec3 {
        DVec3::new(self.next(), self.next(), self.next())
    }
}

/// Boxes and sheets turned any way, all about a light.
fn surroundings(random: &mut Random, light: RectangleLight) -> Scene {
    let mut scene = Scene::default();
    for i in 0..24 {
        let size = 0.2 + 0.6 * random.point().abs();
        let size = if i % 4 == 0 { size.with_y(0.0) } else { size };
        let turned = DMat4::from_axis_angle(random.point().normalize(), 3.0 * random.next());
        let place = DMat4::from_translation(light.center() + 5.0 * random.point()) * turned;
        let role = [Role::Occluder, Role::Receiver, Role::Occluder, Role::Both][i % 4];
        let mesh =
            if size.y == 0.0 { generate::quad(size.x, size.z) } else { generate::cuboid(size) };
        scene.add(&format!("{i}"), mesh, place, role);
    }
    scene
}

/// The exact visible fraction of every receiver is the same without the occluders that a plan leaves out.
#[test]
fn what_is_not_drawn_hides_nothing() {
    let mut random = Random(7);
    let description = Description::new([64; 2]);
    let (mut drawn, mut left_out, mut shadowed, mut asked) = (0, 0, 0, 0);
    for _ in 0..150 {
        let half_u = random.point().normalize() * (0.6 + 0.5 * random.next());
        let half_v = half_u.any_orthogonal_vector().normalize() * (0.6 + 0.5 * random.next());
        let light = RectangleLight::new(random.point(), half_u, half_v).unwrap();
        let scene = surroundings(&mut random, light);
        let buffers =
            MeshBuffers::indexed(vk::Buffer::from_raw(3), 12, vk::Buffer::from_raw(4), 36);
        let instance = |i: &antumbra::scene::Instance| {
            let bounds = scene.meshes[i.mesh].bounds();
            MeshInstance::new(Geometry::Buffers(buffers), i.world_from_mesh, bounds, i.role)
        };
        let meshes: Vec<_> = scene.instances.iter().map(instance).collect();
        let camera = DMat4::from_scale(DVec3::splat(9.0));
        let own = Frame::new(Slot(0), light, camera, &meshes, image());
        let frame = Frame { background: Some(0.0), ..own };
        let plan = plan(&description, Limits::default(), &frame).unwrap();
        let kept = plan.meshes(MeshList::Occluders);
        let mut fewer = scene.clone();
        for i in fewer.instances.iter_mut().filter(|i| i.role.blocks()) {
            if kept.iter().any(|d| d.mesh.world_from_mesh == i.world_from_mesh) {
                drawn += 1;
            } else {
                left_out += 1;
                i.role = Role::Receiver;
            }
        }
        let mut receivers = Vec::new();
        for i in scene.instances.iter().filter(|i| i.role.receives()) {
            let mesh = &scene.meshes[i.mesh];
            for corners in mesh.indices.chunks_exact(3).step_by(2) {
                let corner = |n: usize| {
                    let at = mesh.positions[corners[n] as usize].map(f64::from);
                    i.world_from_mesh.transform_point3(DVec3::from_array(at))
                };
                let (a, b, c) = (corner(0), corner(1), corner(2));
                let position = (a + b + c) / 3.0;
                // The light shines to one side.
                if (position - light.center()).dot(light.emission()) > 0.0 {
                    receivers.push(Receiver { position, normal: (b - a).cross(c - a).normalize() });
                }
            }
        }
        let seen = |scene: &Scene| {
            let truth = Exact::new(scene).unwrap();
            truth.visible_fractions(&PolygonLight::from(&light), &receivers).unwrap()
        };
        for (all, fewer) in seen(&scene).into_iter().zip(seen(&fewer)) {
            assert!((all - fewer).abs() < 1e-9, "{all} of the light is seen, and {fewer} is drawn");
            shadowed += usize::from(all > 0.0 && all < 1.0);
            asked += 1;
        }
    }
    println!("{drawn} drawn, {left_out} left out; {shadowed} of {asked} receivers in penumbra");
    assert!(left_out > drawn / 2 && shadowed > 500, "nothing is tested");
}
