//! Meshes that textures cut out, in every technique: beside the traced truth that looks the textures up, beside the same
//! shapes as triangles, and by what must change nothing.

use antumbra::lent::OpacityTexture;
use antumbra::scene::{Mesh, OpacityMap, Scene, Wrap, from_gltf_bytes, generate};
use antumbra::truth::{Receiver, Sampling, Tracer};
use antumbra::{Light, MeshInstance, RectangleLight};
use antumbra_harness::{GBuffer, HostBuffer, Stage, View};
use antumbra_tests::cut_outs::{Made, panes, picket_fence, tree};
use antumbra_tests::device;
use antumbra_tests::measure::{Setup, percent, settings};
use antumbra_tests::situations::Situation;
use antumbra_tests::textured_file::glb;
use ash::vk;
use glam::{DMat4, DVec3};
use std::path::Path;

const EXTENT: [u32; 2] = [160, 120];

/// Each technique, with the most that it may err on the fence, the tree and the panes, in percent: what was measured, and
/// half as much again.
const TECHNIQUES: [(&str, [f64; 3]); 9] = [
    ("hard", [25.0, 20.0, 12.0]),
    ("pcss", [4.5, 8.0, 8.0]),
    // It fills the gaps between texels, and takes a pane as whole.
    ("back-projection", [3.0, 9.0, 25.0]),
    ("many-lights samples=64", [3.0, 4.0, 6.5]),
    ("soft-shadow-map", [4.0, 8.0, 5.5]),
    ("ray-march", [3.0, 5.0, 6.0]),
    ("occlusion-textures", [5.0, 8.0, 4.5]),
    ("linear-light", [6.0, 6.0, 11.0]),
    ("traced", [2.6, 2.6, 2.6]),
];

/// How much a textured scene may err more than its twin of triangles: a texel of a map more or less along an edge.
const MORE: f64 = 0.4;

fn setup(situation: &Situation) -> Setup<'_> {
    let view = View::of(&situation.camera, EXTENT);
    let scene = &situation.scene;
    Setup { scene, view, extent: EXTENT, window: None, occluders_seen: true }
}

fn image(setup: &Setup, stage: &mut Stage, words: &str) -> Vec<f32> {
    let technique = settings(&format!("technique={words}"));
    stage.configure_with(technique, |d| d.normals = Some(GBuffer::NORMALS)).unwrap();
    setup.visibility(stage)
}

/// The error of each technique in a situation, in percent.
fn errors(situation: &Situation) -> Vec<f64> {
    let device = device();
    let setup = setup(situation);
    let mut stage = setup.stage(&device, "technique=hard");
    let (truth, _) = setup.traced(&stage, 128);
    let error = |(words, _): &(&str, _)| percent(&truth, &image(&setup, &mut stage, words));
    TECHNIQUES.iter().map(error).collect()
}

/// Holds a textured scene to its bounds, and to what the same shapes err by as triangles.
fn hold(name: &str, nth: usize, make: fn(Made) -> Situation) {
    let (cut, textured) = (errors(&make(Made::Cut)), errors(&make(Made::Textured)));
    let mut wrong = Vec::new();
    for (((words, most), cut), textured) in TECHNIQUES.iter().zip(cut).zip(textured) {
        println!("{name}, {words}: {textured:.2} %, and {cut:.2} % as triangles");
        if !(0.0..=most[nth].min(cut + MORE)).contains(&textured) {
            wrong.push(format!("{words}: {textured:.2} %, and {cut:.2} % as triangles"));
        }
    }
    assert!(wrong.is_empty(), "{name}:\n{}", wrong.join("\n"));
}

#[test]
fn a_textured_fence_is_as_good_as_one_of_boards() {
    hold("fence", 0, picket_fence);
}

#[test]
fn a_tree_of_cut_out_leaves_is_as_good_as_one_of_ellipses() {
    hold("tree", 1, tree);
}

/// What is drawn whole is far from the truth: the bounds above say something.
#[test]
fn quads_without_their_textures_are_no_fence_and_no_tree() {
    let device = device();
    for make in [picket_fence as fn(Made) -> Situation, tree] {
        let (textured, whole) = (make(Made::Textured), make(Made::Whole));
        let of_truth = setup(&textured);
        let (truth, _) = of_truth.traced(&of_truth.stage(&device, "technique=hard"), 32);
        let of_whole = setup(&whole);
        let mut stage = of_whole.stage(&device, "technique=hard");
        let found = percent(&truth, &image(&of_whole, &mut stage, "traced"));
        assert!(found > 12.0, "{found} %");
    }
}

/// What lets a part of the light through casts the shadow of that part, and two behind each other the product of theirs.
#[test]
fn panes_let_their_parts_of_the_light_through() {
    let mut wrong = Vec::new();
    for opacities in [&[128][..], &[128, 128], &[64, 204]] {
        for ((words, most), found) in TECHNIQUES.iter().zip(errors(&panes(opacities))) {
            println!("panes {opacities:?}, {words}: {found:.2} %");
            if !(0.0..=most[2]).contains(&found) {
                wrong.push(format!("{opacities:?}, {words}: {found:.2} %"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// A situation whose opacity maps are of one opacity.
fn of_one_opacity(situation: &Situation, opacity: u8) -> Situation {
    let mut made = situation.clone();
    for map in &mut made.scene.opacity_maps {
        map.texels.fill(opacity);
    }
    made
}

/// A texture that stops all light changes no bit of the image, and one that stops none is as if there were no mesh.
#[test]
fn a_texture_of_one_opacity_is_all_or_nothing() {
    let device = device();
    let fence = picket_fence(Made::Textured);
    let whole = picket_fence(Made::Whole);
    let mut without = fence.clone();
    without.scene.instances.retain(|i| i.name != "fence");
    for (opacity, same) in [(255, &whole), (0, &without)] {
        let textured = of_one_opacity(&fence, opacity);
        let (a, b) = (setup(&textured), setup(same));
        let mut stages = [a.stage(&device, "technique=hard"), b.stage(&device, "technique=hard")];
        for (words, _) in TECHNIQUES {
            let [x, y] = &mut stages;
            let (textured, same) = (image(&a, x, words), image(&b, y, words));
            let apart = textured.iter().zip(&same).filter(|(a, b)| a != b).count();
            match opacity {
                255 => assert_eq!(apart, 0, "{words}, opaque"),
                // Maps are fitted to the mesh's box all the same; where there is none, all is lit.
                _ => assert!(textured.iter().all(|v| *v == 1.0), "{words}, {apart} not lit"),
            }
        }
    }
}

/// Meshes as they are, but for how their coordinates lie in the buffer and how the texture's numbers are given.
fn written_otherwise(
    stage: &Stage,
    coordinates: &[[f32; 2]],
    change: impl Fn(&mut OpacityTexture),
) -> (HostBuffer, Vec<MeshInstance>) {
    // Four floats each from the third on: u and v halved, and moved by a quarter.
    let mut floats = vec![0.0f32; 3];
    floats.extend(coordinates.iter().flat_map(|[u, v]| [0.5 * u + 0.25, 0.5 * v - 0.25, 7.0, 7.0]));
    let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
    let buffer = HostBuffer::with_data(&device(), "coordinates", &floats, usage).unwrap();
    let mut meshes = stage.instances().to_vec();
    for texture in meshes.iter_mut().filter_map(|mesh| mesh.opacity.as_mut()) {
        texture.coordinates = buffer.raw();
        texture.coordinates_offset = 12;
        texture.coordinates_stride = 16;
        texture.transform = [[2.0, 0.0, -0.5], [0.0, 2.0, 0.5]];
        change(texture);
    }
    (buffer, meshes)
}

/// Where coordinates lie, a transform that undoes what was done to them, and a factor that the cutoff takes back, change
/// nothing.
#[test]
fn coordinates_may_lie_anywhere_in_a_buffer() {
    let device = device();
    let fence = picket_fence(Made::Textured);
    let setup = setup(&fence);
    let mut stage = setup.stage(&device, "technique=hard");
    let mesh = fence.scene.meshes.iter().find(|mesh| mesh.opacity_map.is_some()).unwrap();
    let light = fence.scene.lights[0].light;
    for words in ["ray-march", "occlusion-textures", "linear-light", "traced"] {
        let plain = image(&setup, &mut stage, words);
        let (_buffer, meshes) = written_otherwise(&stage, &mesh.texture_coordinates, |texture| {
            (texture.factor, texture.cutoff) = (0.5, Some(0.25));
        });
        let plan = stage.plan_with(light, |frame| frame.meshes = &meshes).unwrap();
        stage.run(&plan).unwrap();
        let found = percent(&plain, &stage.visibility().unwrap());
        assert!(found < 0.02, "{words}: {found} % apart");
        // Another transform is another fence.
        let (_buffer, meshes) = written_otherwise(&stage, &mesh.texture_coordinates, |texture| {
            texture.transform[0][2] += 0.03;
        });
        let plan = stage.plan_with(light, |frame| frame.meshes = &meshes).unwrap();
        stage.run(&plan).unwrap();
        let found = percent(&plain, &stage.visibility().unwrap());
        assert!(found > 3.0, "{words}: {found} % apart");
    }
}

/// A board over a floor that repeats, mirrors or clamps a few large texels, interpolated or as squares, under a light that
/// is a point: each pixel sees it or does not, as the map says of where its ray goes through the board.
#[test]
fn every_wrap_and_filter_is_that_of_the_map() {
    let device = device();
    let texels: Vec<u8> = (0..20u32).map(|i| (37 * (i + 1) * (i + 3) % 256) as u8).collect();
    let at = DVec3::new(0.1, 3.0, 0.05);
    let light = Light::from(RectangleLight::point(at, DVec3::NEG_Y).unwrap());
    for (nth, wrap) in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp].into_iter().enumerate() {
        for linear in [false, true] {
            let mut board = generate::quad(1.2, 1.2);
            board.texture_coordinates =
                board.positions.iter().map(|p| [1.9 * p[0] + 0.6, 2.3 * p[2] - 0.4]).collect();
            let board = Mesh { double_sided: true, opacity_map: Some(0), ..board };
            let other = [Wrap::Mirror, Wrap::Clamp, Wrap::Repeat][nth];
            let mut scene = Scene {
                opacity_maps: vec![OpacityMap {
                    size: [5, 4],
                    texels: texels.clone(),
                    wrap: [wrap, other],
                    linear,
                    cutoff: Some(0.5),
                }],
                ..Scene::default()
            };
            let up = DMat4::from_translation(DVec3::new(0.0, 1.0, 0.0));
            scene.add("floor", generate::ground(4.0), DMat4::IDENTITY, antumbra::scene::Role::Both);
            scene.add("board", board, up, antumbra::scene::Role::Occluder);
            let view = View::map_of_ground(1.0, 0.9);
            let keep = |i: &antumbra::scene::Instance| i.name == "floor";
            let technique = settings("technique=traced");
            let stage = Stage::new(&device, &scene, &view, EXTENT, technique, keep);
            let mut stage = stage.unwrap();
            let receivers: Vec<Receiver> = Setup::receivers(&stage);
            let tracer = Tracer::new(&scene).unwrap();
            let sampling = Sampling::new(2, 1).unwrap();
            let truth = tracer.visible_fractions(light, &receivers, &sampling).unwrap().visible;
            let lit = truth.iter().filter(|v| **v == 1.0).count() as f64 / truth.len() as f64;
            assert!((0.2..0.95).contains(&lit), "{wrap:?}: {lit} is lit");
            for words in ["traced", "hard map=1024"] {
                let technique = settings(&format!("technique={words}"));
                stage.configure(technique).unwrap();
                let plan = stage.plan_with(light, |_| {}).unwrap();
                stage.run(&plan).unwrap();
                let found = stage.visibility().unwrap();
                let apart = truth.iter().zip(&found).filter(|(a, b)| (*a - *b).abs() > 0.5).count();
                let share = apart as f64 / truth.len() as f64;
                // A map's texels lie beside edges by half of one.
                let most = if words == "traced" { 0.002 } else { 0.03 };
                assert!(share < most, "{words}, {wrap:?}, {other:?}, {linear}: {share} are wrong");
            }
        }
    }
}

/// The audit's exact fractions look textures up, too: its mean is that of the whole image within its own interval.
#[test]
fn an_audit_looks_textures_up() {
    let device = device();
    for situation in [picket_fence(Made::Textured), tree(Made::Textured), panes(&[128, 128])] {
        let setup = setup(&situation);
        let mut stage = setup.stage(&device, "technique=hard");
        let (truth, _) = setup.traced(&stage, 128);
        let technique = settings("technique=pcss");
        let normals = Some(GBuffer::NORMALS);
        stage.configure_with(technique, |d| (d.audit, d.normals) = (8192, normals)).unwrap();
        let found = setup.visibility(&mut stage);
        let measured = stage.node().unwrap().measured_error(Default::default(), Default::default());
        let (measured, whole) = (measured.unwrap(), percent(&truth, &found));
        let mean = 100.0 * measured.mean;
        println!("audit {mean:.2} %, whole image {whole:.2} %");
        assert!((mean - whole).abs() < 0.3 + 0.15 * whole, "{mean} % of {whole} %");
    }
}

/// A texture that does not fit the room for textures is halved, and the shadow is still there.
#[test]
fn textures_beyond_their_room_are_made_smaller() {
    let device = device();
    let leaves = tree(Made::Textured);
    let setup = setup(&leaves);
    let mut stage = setup.stage(&device, "technique=traced");
    let whole = setup.visibility(&mut stage);
    let technique = settings("technique=traced");
    // 64 by 64 texels become 16 by 16.
    stage.configure_with(technique, |d| d.cut_outs.texels = 300).unwrap();
    let found = percent(&whole, &setup.visibility(&mut stage));
    assert!((0.01..3.0).contains(&found), "{found} % apart");
}

/// Fence, leaves and glass out of a .glb with their PNG are the same to the bit as those that never were in a file.
#[test]
fn a_file_with_its_png_shows_what_was_written_into_it() {
    let device = device();
    for made in [picket_fence(Made::Textured), tree(Made::Textured), panes(&[100])] {
        let mut read = made.clone();
        let scene = &mut read.scene;
        let place = scene.meshes.iter().position(|mesh| mesh.opacity_map.is_some()).unwrap();
        let file = glb(&scene.meshes[place], &scene.opacity_maps[0]);
        let mut loaded = from_gltf_bytes(&file, Path::new("made.glb")).unwrap();
        assert!(loaded.notes.is_empty(), "{:?}", loaded.notes);
        scene.meshes[place] = loaded.meshes.remove(0);
        scene.opacity_maps = loaded.opacity_maps;
        let images = [&made, &read].map(|situation| {
            let setup = setup(situation);
            let mut stage = setup.stage(&device, "technique=hard");
            let (truth, _) = setup.traced(&stage, 8);
            let by = ["soft-shadow-map", "traced"].map(|words| image(&setup, &mut stage, words));
            (truth, by)
        });
        assert_eq!(images[0], images[1]);
    }
}

/// The node refuses what it has no room for, and textures that no shader reads.
#[test]
fn more_cut_outs_than_there_is_room_for_are_refused() {
    let device = device();
    let fence = picket_fence(Made::Textured);
    let setup = setup(&fence);
    let mut stage = setup.stage(&device, "technique=hard");
    let light = fence.scene.lights[0].light;
    let mut refusal = |change: &dyn Fn(&mut OpacityTexture)| {
        let mut meshes = stage.instances().to_vec();
        meshes.iter_mut().filter_map(|mesh| mesh.opacity.as_mut()).for_each(change);
        stage.plan_with(light, |frame| frame.meshes = &meshes).unwrap_err().to_string()
    };
    let of = |what: &str| format!("mesh 1: its opacity texture{what}");
    for (found, right) in [
        (refusal(&|t| t.extent = [0, 4]), of(" of 0×4 texels is outside 1×1 to 16384×16384")),
        (
            refusal(&|t| t.layout = vk::ImageLayout::UNDEFINED),
            of(
                " is in the layout UNDEFINED; shaders read it in SHADER_READ_ONLY_OPTIMAL or GENERAL",
            ),
        ),
        (
            refusal(&|t| t.coordinates_stride = 6),
            of(
                "'s coordinates have a stride of 6 bytes; two floats take 8, and strides are multiples of 4 up to 4092",
            ),
        ),
        (
            refusal(&|t| t.coordinates_offset = 2),
            of("'s coordinates begin at byte 2; they must begin at a multiple of 4"),
        ),
        (
            refusal(&|t| t.cutoff = Some(f32::NAN)),
            of("'s transform, factor and cutoff must be finite numbers"),
        ),
    ] {
        assert_eq!(found, right);
    }
    stage.configure_with(settings("technique=hard"), |d| d.cut_outs.meshes = 0).unwrap();
    let refused = stage.plan_with(light, |_| {}).unwrap_err().to_string();
    assert_eq!(
        refused,
        "1 meshes have an opacity texture, and the description's cut_outs has room for 0; raise it"
    );
    let most = stage.configure_with(settings("technique=hard"), |d| d.cut_outs.meshes = 1 << 15);
    assert!(most.unwrap_err().to_string().starts_with("cut_outs of 32768 meshes and"));
}
