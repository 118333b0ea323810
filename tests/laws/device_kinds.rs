//! Shaders for GPUs and shaders for processors write the same image, to the bit.

use antumbra::scene::generate;
use antumbra_harness::View;
use antumbra_tests::device::TestDevice;
use antumbra_tests::measure::{Setup, model};
use antumbra_tests::room;

/// The settings that reach each pass that has two shaders, with what belongs to its edges: maps whose side is no multiple of a
/// block or of a part of a row, and each way of combining sides.
const SETTINGS: [&str; 9] = [
    "technique=soft-shadow-map",
    "technique=soft-shadow-map map=100 sides=two",
    "technique=soft-shadow-map map=77 sides=mean",
    "technique=soft-shadow-map map=256 sides=bottom",
    "technique=soft-shadow-map receivers=map sides=two map=90",
    "technique=soft-shadow-map receivers=map accumulate=blend-fp16 map=64 receiver_map=64",
    "technique=occlusion-textures",
    "technique=occlusion-textures map=100 combine=product",
    "technique=occlusion-textures map=33 slices=5 placement=uniform",
];

#[test]
fn a_gpus_shaders_write_what_a_processors_do() {
    let (gpu, processor) = (TestDevice::taken_for(false), TestDevice::taken_for(true));
    let cards = generate::stacked_cards(generate::square_light(0.4).unwrap());
    let bunny = model("bunny");
    let extent = [160, 120];
    let view = View::of(&bunny.camera.unwrap(), extent);
    let setups = [
        ("bunny", Setup { scene: &bunny, view, extent, window: None, occluders_seen: true }),
        ("cards", Setup::ground(&cards, 2.2, 128)),
    ];
    // A room, which several views share, for one of the settings of each technique.
    let (room, extent) = (room::room(), [96, 72]);
    let view = View::of(&room::camera(), extent);
    let room = Setup { scene: &room, view, extent, window: None, occluders_seen: true };
    let all = setups.iter().flat_map(|setup| SETTINGS.map(|words| (setup, words)));
    let room = &("room", room);
    let in_room = ["technique=soft-shadow-map", "technique=occlusion-textures"];
    for ((name, setup), words) in all.chain(in_room.map(|words| (room, words))) {
        let image = |device| {
            let mut stage = setup.stage(device, words);
            let image = setup.visibility(&mut stage);
            let plan = stage.plan(setup.light(), None).unwrap();
            let graph = &plan.plan().graph;
            let shaders = graph.passes().iter().filter_map(|pass| pass.work.compute_shader());
            (image, shaders.map(|shader| shader.path).collect::<Vec<_>>())
        };
        let ((a, of_gpu), (b, of_processor)) = (image(&gpu), image(&processor));
        assert_ne!(of_gpu, of_processor, "{words}: both run the same shaders");
        let differ = a.iter().zip(&b).filter(|(a, b)| a.to_bits() != b.to_bits()).count();
        assert_eq!(differ, 0, "{name}, {words}");
        assert!(a.iter().any(|v| *v < 0.5), "{name}, {words}: no shadow");
    }
}
