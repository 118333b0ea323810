//! Planning takes no memory after the first frame.

// A test says what went wrong by panicking.
#![allow(missing_docs, clippy::unwrap_used)]

use allocation_counter::measure;
use antumbra::frame::{Limits, plan_all};
use antumbra::graph::Scope;
use antumbra::scene::{Role, generate};
use antumbra::{Description, Frame, FramePlans, Geometry, HostImage, MeshBuffers, MeshInstance};
use antumbra_tests::measure::settings;
use ash::vk::{self, Handle};
use glam::{DMat4, DVec3};

/// Cubes over a ground, in a row.
fn meshes(shift: f64) -> Vec<MeshInstance> {
    let buffers = MeshBuffers {
        positions: vk::Buffer::from_raw(3),
        positions_offset: 0,
        positions_stride: 12,
        indices: None,
        count: 36,
    };
    let mesh = |bounds, at, role| {
        MeshInstance::new(Geometry::Buffers(buffers), DMat4::from_translation(at), bounds, role)
    };
    let ground = mesh([[-9.0, 0.0, -9.0], [9.0, 0.0, 9.0]], DVec3::ZERO, Role::Receiver);
    let at = |i: u32| DVec3::new(shift + 0.5 * f64::from(i) - 5.0, 1.0, 0.1 * f64::from(i % 5));
    let cube = |i| mesh([[-0.2; 3], [0.2; 3]], at(i), Role::Both);
    std::iter::once(ground).chain((0..20).map(cube)).collect()
}

/// Frames of four lights, at a moment.
fn frames(meshes: &[MeshInstance], moment: u32, stays: bool) -> [Frame<'_>; 4] {
    let image = HostImage {
        image: vk::Image::from_raw(1),
        view: vk::ImageView::from_raw(2),
        format: vk::Format::D32_SFLOAT,
        extent: [64, 64],
        usage: vk::ImageUsageFlags::SAMPLED,
        before: Scope::FRAGMENT_SAMPLED,
        after: Scope::FRAGMENT_SAMPLED,
    };
    [0, 1, 2, 3].map(|light_index| {
        let light = generate::square_light(0.3).unwrap();
        let camera = DMat4::from_scale(DVec3::splat(4.0 + 0.1 * f64::from(moment)));
        Frame {
            light_index,
            reach: (light_index == 3).then_some(3.5),
            revision: stays.then_some(1),
            ..Frame::new(light, camera, meshes, image)
        }
    })
}

#[test]
fn planning_takes_no_memory_after_the_first_frame() {
    for words in [
        "technique=soft-shadow-map",
        "technique=soft-shadow-map receivers=map accumulate=blend",
        "technique=ray-march",
        "technique=occlusion-textures",
        "technique=pcss",
        "technique=hard",
        "technique=back-projection",
    ] {
        let description =
            Description { settings: settings(words), lights: 4, ..Description::new([64; 2]) };
        for stays in [false, true] {
            let mut plans = FramePlans::new();
            // To and fro: where more meshes matter than ever before, their list grows.
            for (nth, moment) in [2, 1, 0, 1, 2, 1, 0].into_iter().enumerate() {
                let meshes = meshes(if stays { 0.0 } else { 0.05 * f64::from(moment) });
                let frames = frames(&meshes, moment, stays);
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
