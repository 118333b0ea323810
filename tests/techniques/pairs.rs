//! Scenes that must look the same: the same with something elsewhere, larger, or far away by its vertices.

use antumbra::scene::{AreaLight, Scene};
use antumbra::{Geometry, Light, MeshBuffers, MeshInstance, RectangleLight};
use antumbra_harness::{GBuffer, HeadlessDevice, HostBuffer, Stage, View};
use antumbra_tests::device;
use antumbra_tests::measure::{percent, settings};
use antumbra_tests::situations::{self, Situation};
use ash::vk;
use glam::{DMat4, DVec3};

const EXTENT: [u32; 2] = [160, 120];

const TECHNIQUES: [&str; 4] = ["ray-march", "soft-shadow-map", "occlusion-textures", "pcss"];

/// A stage that shows a situation.
fn stage(device: &HeadlessDevice, situation: &Situation) -> Stage {
    let view = View::of(&situation.camera, EXTENT);
    let technique = settings("technique=hard");
    Stage::new(device, &situation.scene, &view, EXTENT, technique, |_| true).unwrap()
}

/// Its image by a technique; `change` may lend other meshes.
fn image(
    stage: &mut Stage,
    light: Light,
    words: &str,
    meshes: Option<&[MeshInstance]>,
) -> Vec<f32> {
    let technique = settings(&format!("technique={words}"));
    stage.configure_with(technique, |d| d.normals = Some(GBuffer::NORMALS)).unwrap();
    let own = stage.instances().to_vec();
    let meshes = meshes.unwrap_or(&own);
    let plan = stage.plan_with(light, |frame| frame.meshes = meshes).unwrap();
    stage.run(&plan).unwrap();
    stage.visibility().unwrap()
}

fn images(device: &HeadlessDevice, situation: &Situation, words: &[&str]) -> Vec<Vec<f32>> {
    let mut stage = stage(device, situation);
    let light = situation.scene.lights[0].light;
    words.iter().map(|words| image(&mut stage, light, words, None)).collect()
}

/// The situation under an affine transform of vertices, lamp and camera: a scale and a translation.
fn moved(situation: &Situation, scale: f64, by: DVec3) -> Situation {
    let mut made = situation.clone();
    for mesh in 0..made.scene.instances.len() {
        let instance = &mut made.scene.instances[mesh];
        let place = std::mem::replace(&mut instance.world_from_mesh, DMat4::IDENTITY);
        // Each instance has a mesh of its own.
        for p in &mut made.scene.meshes[instance.mesh].positions {
            let world = place.transform_point3(DVec3::from_array(p.map(f64::from)));
            *p = (world * scale + by).as_vec3().to_array();
        }
        for n in &mut made.scene.meshes[instance.mesh].normals {
            let turned = place.transform_vector3(DVec3::from_array(n.map(f64::from)));
            *n = turned.as_vec3().to_array();
        }
    }
    let AreaLight { light, .. } = &mut made.scene.lights[0];
    let rectangle = *light.rectangle();
    let [a, b] = rectangle.half_extents();
    let axis = |axis: DVec3, half: f64| rectangle.world_from_light().transform_vector3(axis) * half;
    let center = rectangle.center() * scale + by;
    // Light leaves along half_v × half_u.
    let [u, v] = [axis(DVec3::X, a), axis(DVec3::Y, -b)].map(|half| half * scale);
    *light = RectangleLight::new(center, u, v).unwrap().into();
    let eye = &mut made.camera.world_from_view.w_axis;
    *eye = (eye.truncate() * scale + by).extend(1.0);
    made.camera.near *= scale;
    made
}

/// What roundings change that lie otherwise: places of slices above all, which follow from a histogram of depths.
const ROUNDED: f64 = 0.15;

/// How far images of each technique may be apart, and are at least, in percent of the pixels in shadow.
fn apart(name: &str, a: &Situation, b: &Situation, ranges: [[f64; 2]; 4]) {
    let device = device();
    let (a, b) = (images(&device, a, &TECHNIQUES), images(&device, b, &TECHNIQUES));
    let mut wrong = Vec::new();
    for (((words, a), b), [least, most]) in TECHNIQUES.iter().zip(&a).zip(&b).zip(ranges) {
        let found = percent(a, b);
        println!("{name}, {words}: {found:.3} % apart");
        if !(least..=most).contains(&found) {
            wrong.push(format!("{words}: {found:.3} % apart, not {least} to {most}"));
        }
    }
    assert!(wrong.is_empty(), "{name}:\n{}", wrong.join("\n"));
}

fn base() -> Situation {
    situations::post_and_board(0.0015)
}

#[test]
fn a_block_far_away_changes_nothing() {
    let block = base().and_box("block", [-320.0, -20.0, -20.0], [-280.0, 20.0, 20.0]);
    apart("a block 300 m away", &base(), &block, [[0.0, ROUNDED]; 4]);
}

/// A known fault: what is right is that they are the same. The walls of a dome and the houses of a town lie in the hull of
/// lamp and floor, so that windows hold them: the texels at the board are larger, and the furthest faces over its shadow
/// are the dome's or the streets', a long way below.
const SURROUNDED: [[f64; 2]; 4] = [[0.3, 2.0], [0.2, 1.2], [1.5, 12.0], [0.5, 2.4]];

#[test]
fn a_dome_changes_no_more_than_is_known() {
    apart("a dome of 500 m", &base(), &situations::in_dome(base(), 500.0), SURROUNDED);
}

#[test]
fn a_town_changes_no_more_than_is_known() {
    apart("a town of 400 m", &base(), &situations::in_town(base()), SURROUNDED);
}

/// Every number of a frame is relative to its light: what is left are roundings.
#[test]
fn a_scale_changes_nothing() {
    // A map fits the box around a mesh as its vertices have it, which is another one for a board that its transform turns.
    let once = moved(&base(), 1.0, DVec3::ZERO);
    for scale in [1000.0, 0.001] {
        let name = format!("{scale} times as large");
        apart(&name, &once, &moved(&once, scale, DVec3::ZERO), [[0.0, ROUNDED]; 4]);
    }
}

/// Far away by its vertices a scene is on the grid that f32 has there, of 8 mm here. Brought back it is on that grid, too,
/// and the image of both is the same but for roundings of a camera or lamp that is so far away.
#[test]
fn far_away_by_vertices_changes_nothing() {
    let by = DVec3::new(100_000.0, 0.0, -70_000.0);
    let there = moved(&base(), 1.0, by);
    let here = moved(&there, 1.0, -by);
    apart("far away by vertices", &here, &there, [[0.0, ROUNDED]; 4]);
    // The grid is no excuse for a picture of something else.
    let device = device();
    let [exact, gridded] = [base(), here].map(|s| images(&device, &s, &["traced"]).remove(0));
    let lost = percent(&exact, &gridded);
    println!("the grid of f32 alone: {lost:.2} %");
    assert!((0.1..8.0).contains(&lost), "{lost} %");
}

/// Buffers of a mesh as a host may keep them, far from the mesh's origin; its place in the world is that of an instance.
struct Far {
    positions: HostBuffer,
    indices: HostBuffer,
}

/// Meshes for the node whose vertices are `by` away from their origin and whose transforms bring them back.
fn far_meshes(device: &HeadlessDevice, scene: &Scene, by: DVec3) -> (Vec<Far>, Vec<MeshInstance>) {
    use vk::BufferUsageFlags as Usage;
    let mut kept = Vec::new();
    let mut meshes = Vec::new();
    for instance in &scene.instances {
        let mut mesh = scene.meshes[instance.mesh].clone();
        for p in &mut mesh.positions {
            *p = (DVec3::from_array(p.map(f64::from)) + by).as_vec3().to_array();
        }
        let usage = Usage::VERTEX_BUFFER | Usage::STORAGE_BUFFER;
        let positions = HostBuffer::with_data(device, "far", &mesh.positions, usage).unwrap();
        let usage = Usage::INDEX_BUFFER | Usage::STORAGE_BUFFER;
        let indices = HostBuffer::with_data(device, "far", &mesh.indices, usage).unwrap();
        let count = mesh.indices.len() as u32;
        let buffers = MeshBuffers::indexed(positions.raw(), 12, indices.raw(), count);
        let world_from_mesh = instance.world_from_mesh * DMat4::from_translation(-by);
        meshes.push(MeshInstance::new(
            Geometry::Buffers(buffers),
            world_from_mesh,
            mesh.bounds(),
            instance.role,
        ));
        kept.push(Far { positions, indices });
    }
    assert!(kept.iter().all(|far| far.positions.raw() != far.indices.raw()));
    (kept, meshes)
}

/// A host may hand such meshes to the node as they are: it rounds nothing at the size of their positions.
#[test]
fn the_node_rounds_nothing_where_vertices_are_far() {
    let device = device();
    let by = DVec3::new(60_000.0, 40_000.0, -65_000.0);
    // On the grid that f32 has there.
    let situation = moved(&moved(&base(), 1.0, by), 1.0, -by);
    let light = situation.scene.lights[0].light;
    let mut stage = stage(&device, &situation);
    let (kept, far) = far_meshes(&device, &situation.scene, by);
    for words in
        ["hard", "many-lights samples=16", "linear-light", "traced"].into_iter().chain(TECHNIQUES)
    {
        let near = image(&mut stage, light, words, None);
        let found = percent(&near, &image(&mut stage, light, words, Some(&far)));
        println!("{words}: {found:.4} % apart");
        assert!(found < ROUNDED, "{words}: {found} % apart");
    }
    // Rounded at the size of the positions the board's shadow would be elsewhere: the test could see it.
    let off = moved(&situation, 1.0, DVec3::X * 0.004);
    let shifted = images(&device, &Situation { camera: situation.camera, ..off }, &["traced"]);
    assert!(percent(&image(&mut stage, light, "traced", None), &shifted[0]) > 0.2);
    drop(kept);
}
