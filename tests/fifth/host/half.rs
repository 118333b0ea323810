//! Renders a card's shadow by the sketched technique, found by its name as any other.

#![allow(missing_docs, clippy::unwrap_used, clippy::panic)]

use antumbra::scene::generate;
use antumbra::{RectangleLight, Technique};
use antumbra_harness::{HeadlessDevice, HeadlessOptions, Stage, View, technique};

fn main() {
    assert!(Technique::NAMES.contains(&"half"));
    let options = HeadlessOptions { validation: true, ..Default::default() };
    let device = HeadlessDevice::new(&options).unwrap();
    let light: RectangleLight = generate::square_light(0.4).unwrap();
    let scene = generate::card(light);
    let view = View::map_of_ground(2.2, 8.0);
    let mut stage =
        Stage::new(&device, &scene, &view, [48; 2], technique("half map=32"), |_| true).unwrap();
    let plan = stage.plan(&light, None).unwrap();
    stage.run(&plan).unwrap();
    let image = stage.visibility().unwrap();
    assert!(image.iter().all(|v| *v == 0.5), "{:?}", &image[..4]);
    println!("{}", plan.explain());
}
