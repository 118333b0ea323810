//! Devices that have less than the drivers here: what they can do is the same to the bit, and what they cannot is
//! refused.
//!
//! They are these drivers, which say less of themselves; that no row asks for more than every device has is held by
//! `tests/limits/row_limits.rs`.

use antumbra::scene::{Instance, Role, Scene, generate};
use antumbra::{Error, RectangleLight};
use antumbra_harness::{Stage, View};
use antumbra_tests::TestDevice;
use antumbra_tests::bench::SMALLEST;
use antumbra_tests::measure::settings;
use antumbra_tests::tables::{self, POORER, Pretence};

const EXTENT: [u32; 2] = [40, 24];

/// On SwiftShader each takes seconds to compile: those whose numbers depend on a limit, and each kind of row.
const FEW: [&str; 5] = [
    "map=16",
    "technique=ray-march map=16 rays=4",
    "technique=hard map=16",
    "map=16 receivers=map receiver_map=16 sides=two",
    "technique=linear-light map=16 samples=2 lines=1",
];

fn words(device: &TestDevice) -> &'static [&'static str] {
    if device.leaves_to_others("most techniques on poorer devices") { &FEW } else { &SMALLEST }
}

fn light() -> RectangleLight {
    generate::square_light(0.4).unwrap()
}

fn stage(device: &TestDevice, scene: &Scene, words: &str) -> Result<Stage, Error> {
    let view = View::map_of_ground(1.5, 8.0);
    let seen = |i: &Instance| i.role != Role::Occluder;
    Stage::new(device, scene, &view, EXTENT, settings(words), seen)
}

/// A frame's visible fractions, and whether it was timed.
fn image(stage: &mut Stage) -> (Vec<f32>, bool) {
    let plan = stage.plan(light(), None).unwrap();
    let times = stage.run(&plan).unwrap();
    let image = stage.visibility().unwrap();
    assert!(image.iter().all(|v| (0.0..=1.0).contains(v)) && image.iter().any(|v| *v < 1.0));
    (image, !times.passes.is_empty())
}

/// Each technique's image on the device as it is, and as poorer devices: without blending of floats; with the least
/// limits of all, and the driver's own sub-pixel bits, by which surfaces stand off the planes that they shadow; and
/// with the four bits that every device has, for a card that is nowhere near the ground that it shadows.
#[test]
fn what_poorer_devices_can_do_is_the_same() {
    let device = TestDevice::through(POORER);
    let own_bits = device.limits().sub_pixel_precision_bits;
    let pretences = [
        Pretence { no_blending: true, ..Pretence::TRUTH },
        Pretence { least: true, sub_pixel_bits: Some(own_bits), ..Pretence::TRUTH },
        Pretence { least: true, sub_pixel_bits: Some(4), ..Pretence::TRUTH },
    ];
    let scene = generate::card(light());
    for words in words(&device) {
        tables::pretend(Pretence::TRUTH);
        let (own, own_times) = image(&mut stage(&device, &scene, words).unwrap());
        for pretence in pretences {
            tables::pretend(pretence);
            let (poor, poor_times) = image(&mut stage(&device, &scene, words).unwrap());
            let pairs = own.iter().zip(&poor);
            let differ = pairs.filter(|(a, b)| a.to_bits() != b.to_bits()).count();
            assert_eq!(differ, 0, "{words}: {pretence:?}");
            assert_eq!(poor_times, own_times && !pretence.least, "{words}: timestamps");
        }
    }
    device.finish();
}

/// Where leaves shadow each other, fewer sub-pixel bits ask for more distance before one does: pixels of a hard shadow
/// are told lit for it, and none is told dark.
#[test]
fn with_fewer_sub_pixel_bits_a_shadow_only_shrinks() {
    let device = TestDevice::through(POORER);
    let scene = generate::foliage(light(), 300, 7).with_occluders_as(Role::Both);
    let mut images = [16, 4].map(|bits| {
        tables::pretend(Pretence { sub_pixel_bits: Some(bits), ..Pretence::TRUTH });
        image(&mut stage(&device, &scene, "technique=hard map=16").unwrap()).0
    });
    let [fine, coarse] = &mut images;
    let changed = fine.iter().zip(&*coarse).filter(|(a, b)| a != b).count();
    println!("{changed} of {} pixels", fine.len());
    assert!(changed > 0, "four bits are as good as sixteen");
    assert!(fine.iter().zip(coarse).all(|(fine, coarse)| fine <= coarse));
    device.finish();
}

#[test]
fn without_blending_of_floats_its_setting_is_refused() {
    let device = TestDevice::through(POORER);
    tables::pretend(Pretence { no_blending: true, ..Pretence::TRUTH });
    let words = "map=16 receivers=map receiver_map=16 accumulate=blend";
    let sentence = stage(&device, &generate::card(light()), words).err().unwrap().to_string();
    println!("{sentence}");
    for word in ["setting accumulate", device.name(), "R32_SFLOAT", "accumulate=gather"] {
        assert!(sentence.contains(word), "{sentence}");
    }
    device.finish();
}

/// A G-buffer beyond the device's images is refused before anything is made.
#[test]
fn a_gbuffer_beyond_the_devices_images() {
    tables::pretend(Pretence { least: true, ..Pretence::TRUTH });
    let device = TestDevice::through(POORER);
    let mut stage = stage(&device, &generate::card(light()), "technique=hard map=16").unwrap();
    let beyond = [4097, 16];
    // The first call that makes anything would be the one to fail.
    tables::fail(0, ash::vk::Result::ERROR_UNKNOWN);
    let allocator = device.allocator();
    let mut allocator = allocator.lock().unwrap();
    let node = stage.node().unwrap();
    let resized = node.resize(&mut *allocator, beyond).err().unwrap();
    let description = antumbra::Description { extent: beyond, ..node.description().clone() };
    let reconfigured = node.reconfigure(&mut *allocator, description).err().unwrap();
    drop(allocator);
    assert_eq!(tables::end(), (None, 0), "calls that make something");
    for sentence in [resized, reconfigured].map(|e| e.to_string()) {
        println!("{sentence}");
        assert!(
            ["4097×16", "4096 a side", device.name()].iter().all(|w| sentence.contains(w)),
            "{sentence}"
        );
    }
    image(&mut stage);
    drop(stage);
    device.finish();
}
