//! Normals that the host lends: every encoding, bad ones, and what they do to the error.

use antumbra::scene::Scene;
use antumbra::{NormalEncoding, Normals};
use antumbra_harness::{GBuffer, HeadlessDevice, OwnedImage, Stage, View};
use antumbra_tests::device;
use antumbra_tests::measure::{Setup, model, percent, settings};
use ash::vk::{self, Format as F};
use glam::{DMat3, DVec3};

const EXTENT: [u32; 2] = [160, 120];

/// Techniques of which each takes the pixels' planes through another shader.
const TECHNIQUES: [&str; 7] = [
    "technique=soft-shadow-map",
    "technique=soft-shadow-map receivers=map accumulate=gather",
    "technique=ray-march",
    "technique=occlusion-textures",
    "technique=pcss",
    "technique=many-lights samples=16",
    "technique=hard",
];

fn bunny(scene: &Scene) -> Setup<'_> {
    let view = View::of(&scene.camera.unwrap(), EXTENT);
    Setup { scene, view, extent: EXTENT, window: None, occluders_seen: true }
}

/// An image in which shaders find these texels.
fn image<T: bytemuck::NoUninit>(device: &HeadlessDevice, format: F, texels: &[T]) -> OwnedImage {
    let usage = vk::ImageUsageFlags::SAMPLED;
    let image = OwnedImage::new(device, "test.normals", format, EXTENT, usage).unwrap();
    image.write(texels, vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL).unwrap();
    image
}

/// The visible fractions with an image of normals.
fn with(
    stage: &mut Stage,
    setup: &Setup,
    words: &str,
    encoding: NormalEncoding,
    image: &OwnedImage,
    world_from_normal: DMat3,
) -> Vec<f32> {
    let normals = Some(Normals { format: image.format(), encoding });
    stage.configure_with(settings(words), |d| d.normals = normals).unwrap();
    let scope = antumbra::Scope::COMPUTE_SAMPLED;
    let plan = stage.plan_with(setup.light(), |frame| {
        frame.normals = Some(image.lend(scope, scope));
        frame.world_from_normal = world_from_normal;
    });
    stage.run(&plan.unwrap()).unwrap();
    stage.visibility().unwrap()
}

/// The visible fractions without.
fn without(stage: &mut Stage, setup: &Setup, words: &str) -> Vec<f32> {
    stage.configure(settings(words)).unwrap();
    setup.visibility(stage)
}

/// The octahedron's surface, unfolded (Cigolle et al. 2014, section 3).
fn octahedral(n: DVec3) -> [f64; 2] {
    let flat = n / n.abs().element_sum();
    let over = |a: f64, b: f64| (1.0 - b.abs()).copysign(a);
    match n.z < 0.0 {
        true => [over(flat.x, flat.y), over(flat.y, flat.x)],
        false => [flat.x, flat.y],
    }
}

/// One normal in a format, whose channels are signed or not, in this many bits.
fn unorm(c: f64, bits: u32) -> u16 {
    ((0.5 * c + 0.5) * f64::from((1u32 << bits) - 1)).round() as u16
}

fn snorm(c: f64, bits: u32) -> i16 {
    (c * f64::from((1i32 << (bits - 1)) - 1)).round() as i16
}

/// How far two images are apart, in the mean over the pixels.
fn apart(a: &[f32], b: &[f32]) -> f64 {
    a.iter().zip(b).map(|(a, b)| f64::from((a - b).abs())).sum::<f64>() / a.len() as f64
}

#[test]
fn every_encoding_gives_the_same_image_within_its_precision() {
    let device = device();
    let scene = model("bunny");
    let setup = bunny(&scene);
    let words = "technique=soft-shadow-map";
    let mut stage = setup.stage(&device, words);
    let read = stage.gbuffer().planes().unwrap();
    let wide = |n: &[f32; 4]| DVec3::new(n[0].into(), n[1].into(), n[2].into());
    let normals: Vec<DVec3> = read.iter().map(wide).collect();
    // World to the space of the normals: turned anyhow, and mirrored.
    let turn = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, -0.5).normalize(), 1.1)
        * DMat3::from_diagonal(DVec3::new(1.0, -1.0, 1.0));
    stage.configure_with(settings(words), |d| d.normals = Some(GBuffer::NORMALS)).unwrap();
    let exact = setup.visibility(&mut stage);
    let depths = without(&mut stage, &setup, words);
    assert!(apart(&exact, &depths) > 1e-3, "lent normals change nothing");

    use NormalEncoding::{OctahedralSigned, OctahedralUnsigned, Signed, Unsigned};
    for (what, turned) in [("world", DMat3::IDENTITY), ("another space", turn)] {
        let back = turned.transpose();
        let n: Vec<DVec3> = normals.iter().map(|n| turned * *n).collect();
        let of =
            |one: fn(DVec3) -> [u8; 4]| -> Vec<[u8; 4]> { n.iter().map(|n| one(*n)).collect() };
        let floats: Vec<[f32; 4]> = n.iter().map(|n| n.as_vec3().extend(0.0).to_array()).collect();
        let bytes = of(|n| [n.x, n.y, n.z, 1.0].map(|c| unorm(c, 8) as u8));
        let signed = of(|n| [n.x, n.y, n.z, 1.0].map(|c| snorm(c, 8) as i8 as u8));
        // Background has no normal, and any will do.
        let flat: Vec<[f64; 2]> =
            n.iter().map(|n| octahedral(if *n == DVec3::ZERO { DVec3::Z } else { *n })).collect();
        let words_16: Vec<[u16; 2]> = flat.iter().map(|c| c.map(|c| unorm(c, 16))).collect();
        let signed_16: Vec<[i16; 2]> = flat.iter().map(|c| c.map(|c| snorm(c, 16))).collect();
        let octahedron: Vec<[f32; 2]> = flat.iter().map(|c| c.map(|c| c as f32)).collect();
        // A byte's step turns a normal by up to 0.4 degrees, the step of 16 bits by 0.003; few pixels stand at an edge
        // where that decides.
        for (encoding, image, most) in [
            (Signed, image(&device, F::R32G32B32A32_SFLOAT, &floats), 1e-5),
            (Unsigned, image(&device, F::R8G8B8A8_UNORM, &bytes), 1e-3),
            (Signed, image(&device, F::R8G8B8A8_SNORM, &signed), 1e-3),
            (OctahedralUnsigned, image(&device, F::R16G16_UNORM, &words_16), 1e-4),
            (OctahedralSigned, image(&device, F::R16G16_SNORM, &signed_16), 1e-4),
            (OctahedralSigned, image(&device, F::R32G32_SFLOAT, &octahedron), 1e-5),
        ] {
            let found = with(&mut stage, &setup, words, encoding, &image, back);
            let error = apart(&found, &exact);
            println!("{encoding:?} {:?} in {what}: {error:.1e}", image.format());
            assert!(error <= most, "{encoding:?} {:?} in {what}: {error:e}", image.format());
        }
    }
    // The wrong rotation is another image, so the right one is what made them the same.
    let floats: Vec<[f32; 4]> =
        normals.iter().map(|n| (turn * *n).as_vec3().extend(0.0).to_array()).collect();
    let image = image(&device, F::R32G32B32A32_SFLOAT, &floats);
    let wrong = with(&mut stage, &setup, words, Signed, &image, DMat3::IDENTITY);
    assert!(apart(&wrong, &exact) > 1e-3);
}

/// A normal without a length and one that is no number give the bits that no normal gives; one of another length or side
/// gives those of its plane.
#[test]
fn bad_normals_are_as_if_none_were_lent() {
    let device = device();
    let scene = model("bunny");
    let setup = bunny(&scene);
    for words in TECHNIQUES {
        let mut stage = setup.stage(&device, words);
        let lent = stage.gbuffer().planes().unwrap();
        let none = without(&mut stage, &setup, words);
        stage.configure_with(settings(words), |d| d.normals = Some(GBuffer::NORMALS)).unwrap();
        let good = setup.visibility(&mut stage);
        assert!(good != none, "{words}: lent normals change nothing");
        let all = |n: [f32; 4]| vec![n; lent.len()];
        // Powers of two change no digit of a normal.
        let times = |by: f32| lent.iter().map(|n| n.map(|c| by * c)).collect::<Vec<_>>();
        let cases = [
            ("zero", all([0.0; 4]), &none[..]),
            ("no number", all([f32::NAN; 4]), &none),
            ("no number in one channel", all([0.5, f32::NAN, 0.5, 0.0]), &none),
            ("infinite", all([f32::INFINITY, 0.0, 0.0, 0.0]), &none),
            ("eight times as long", times(8.0), &good),
            ("a quarter as long", times(0.25), &good),
            ("of the other side", times(-1.0), &good),
        ];
        for (what, texels, expected) in cases {
            let image = image(&device, F::R32G32B32A32_SFLOAT, &texels);
            let signed = NormalEncoding::Signed;
            let found = with(&mut stage, &setup, words, signed, &image, DMat3::IDENTITY);
            assert!(found.iter().all(|v| (0.0..=1.0).contains(v)), "{words}: {what}");
            assert!(found == expected, "{words}: {what} changes the image");
        }
    }
}

/// The triangles' own normals take the errors of the planes away that depths alone leave.
#[test]
fn the_triangles_normals_make_the_bunny_better() {
    let device = device();
    let scene = model("bunny");
    let setup = bunny(&scene);
    for (words, at_least) in
        [("technique=soft-shadow-map", 0.1), ("technique=ray-march", 0.1), ("technique=pcss", 0.05)]
    {
        let mut stage = setup.stage(&device, words);
        let (truth, _) = setup.traced(&stage, 128);
        let depths = percent(&truth, &setup.visibility(&mut stage));
        stage.configure_with(settings(words), |d| d.normals = Some(GBuffer::NORMALS)).unwrap();
        let lent = percent(&truth, &setup.visibility(&mut stage));
        println!("{words}: {depths:.2} % without normals, {lent:.2} % with");
        assert!(lent < (1.0 - at_least) * depths, "{words}: {lent} of {depths} %");
    }
}
