//! Meshes that textures cut out, in every technique, beside the traced truth that looks the textures up.

use antumbra_harness::{GBuffer, View};
use antumbra_tests::cut_outs::{Made, panes, picket_fence, tree};
use antumbra_tests::device;
use antumbra_tests::measure::{Setup, percent, settings};
use antumbra_tests::situations::Situation;

const EXTENT: [u32; 2] = [320, 240];

const TECHNIQUES: [&str; 9] = [
    "hard",
    "pcss",
    "back-projection",
    "many-lights samples=64",
    "soft-shadow-map",
    "ray-march",
    "occlusion-textures",
    "linear-light",
    "traced",
];

fn errors(situation: &Situation, name: &str) -> Vec<f64> {
    let device = device();
    let Situation { scene, camera } = situation;
    let view = View::of(camera, EXTENT);
    let setup = Setup { scene, view, extent: EXTENT, window: None, occluders_seen: true };
    let mut stage = setup.stage(&device, "technique=hard");
    let (truth, _) = setup.traced(&stage, 128);
    let write = |path: String, image: &[f32]| {
        if let Ok(dir) = std::env::var("PNG") {
            let bytes: Vec<u8> = image.iter().map(|v| (v * 255.0).round() as u8).collect();
            let image = image::GrayImage::from_raw(EXTENT[0], EXTENT[1], bytes).unwrap();
            image.save(format!("{dir}/{path}.png")).unwrap();
        }
    };
    write(format!("{name}_truth"), &truth);
    let mut all = Vec::new();
    for words in TECHNIQUES {
        let technique = settings(&format!("technique={words}"));
        stage.configure_with(technique, |d| d.normals = Some(GBuffer::NORMALS)).unwrap();
        let image = setup.visibility(&mut stage);
        write(format!("{name}_{words}"), &image);
        all.push(percent(&truth, &image));
    }
    all
}

#[test]
fn probe() {
    for (name, make) in [
        ("panes", (|_| panes(&[128, 128])) as fn(Made) -> Situation),
        ("fence", picket_fence as fn(Made) -> Situation),
        ("tree", tree),
    ] {
        let cut = errors(&make(Made::Cut), &format!("{name}_cut"));
        let textured = errors(&make(Made::Textured), &format!("{name}_tex"));
        for ((words, cut), textured) in TECHNIQUES.iter().zip(cut).zip(textured) {
            println!("{name} {words}: cut {cut:.2} textured {textured:.2}");
        }
    }
}
