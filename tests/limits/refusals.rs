//! What a host gets wrong, by table: each row is refused with a sentence that names the thing, before a plan is made.
//!
//! No device is asked: what Vulkan does not tell of a handle (format, extent, usage, layout) the host says with it.
//! What it says wrongly is the validation layer's to find: `tests/host/lies.rs`.

mod frames;
mod images;

use antumbra::Omit;
use antumbra::frame::{self, Limits};
use antumbra::graph::Scope;
use antumbra::scene::{Role, generate};
use antumbra::stages::depth_layers::{Eye, MapView};
use antumbra::techniques::{hard, soft_shadow_map};
use antumbra::{
    Description, Error, Frame, Geometry, HostImage, LightTexture, MeshBuffers, MeshInstance,
    NormalEncoding, Normals, OccluderMaps, RectangleLight, Slot, Visibility,
};
use antumbra_harness::technique;
use antumbra_tests::measure::settings;
use ash::vk::{self, Handle, ImageLayout as Layout, ImageUsageFlags as Usage};
use glam::{DMat4, DVec3};

/// What a host lends besides meshes.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Lends {
    /// Depth, mask and normals; the visibility image is the node's own.
    GBuffer,
    /// The visibility image too.
    Visibility,
    /// Occluder maps.
    Maps,
    /// What the light emits; `ray-march`.
    Texture,
}

const EXTENT: [u32; 2] = [64, 48];

const NORMALS: Normals =
    Normals { format: vk::Format::R16G16B16A16_SFLOAT, encoding: NormalEncoding::Signed };

/// A host that is wrong in nothing yet.
struct Given {
    description: Description,
    meshes: Vec<MeshInstance>,
}

fn image(number: u64, format: vk::Format, extent: [u32; 2], usage: Usage) -> HostImage {
    let handles = (vk::Image::from_raw(number), vk::ImageView::from_raw(number));
    let sampled = Scope::FRAGMENT_SAMPLED;
    HostImage::new(handles, format, extent, usage | Usage::SAMPLED, sampled, sampled)
}

fn depth() -> HostImage {
    image(1, vk::Format::D32_SFLOAT, EXTENT, Usage::DEPTH_STENCIL_ATTACHMENT)
}

fn mask() -> HostImage {
    image(2, vk::Format::R8_UNORM, EXTENT, Usage::COLOR_ATTACHMENT)
}

fn normals() -> HostImage {
    image(9, NORMALS.format, EXTENT, Usage::COLOR_ATTACHMENT)
}

fn target() -> HostImage {
    image(3, vk::Format::R32_SFLOAT, EXTENT, Usage::STORAGE)
}

fn map(number: u64) -> HostImage {
    image(number, vk::Format::D32_SFLOAT, [32; 2], Usage::DEPTH_STENCIL_ATTACHMENT)
}

fn texture() -> HostImage {
    image(6, vk::Format::R8G8B8A8_UNORM, [16, 8], Usage::TRANSFER_DST)
}

fn maps(light: &RectangleLight) -> OccluderMaps {
    let eye = Eye::Behind(0.0);
    let (min, max, near, far) = ([-1.0; 2], [1.0; 2], 0.5, 9.0);
    let view = MapView { eye, min, max, near, far, side: 32 };
    let clip_from_world = view.clip_from_light() * light.light_from_world();
    OccluderMaps { front: map(4), back: Some(map(5)), clip_from_world }
}

impl Given {
    fn new(lends: Lends, words: &str) -> Self {
        let texture = LightTexture { format: vk::Format::R8G8B8A8_UNORM, color: false };
        let words = match lends {
            Lends::Texture => format!("technique=ray-march {words}"),
            Lends::Maps => format!("map=32 {words}"),
            Lends::GBuffer | Lends::Visibility => words.into(),
        };
        let description = Description {
            technique: settings(&words),
            mask_format: Some(vk::Format::R8_UNORM),
            normals: Some(NORMALS),
            lent_visibility: lends == Lends::Visibility,
            occluder_maps: (lends == Lends::Maps).then_some(vk::Format::D32_SFLOAT),
            light_texture: (lends == Lends::Texture).then_some(texture),
            ..Description::new(EXTENT)
        };
        let buffers =
            MeshBuffers::indexed(vk::Buffer::from_raw(7), 12, vk::Buffer::from_raw(8), 36);
        let mesh = |bounds, y, role| {
            let at = DMat4::from_translation(DVec3::Y * y);
            MeshInstance::new(Geometry::Buffers(buffers), at, bounds, role)
        };
        let ground = mesh([[-4.0, 0.0, -4.0], [4.0, 0.0, 4.0]], 0.0, Role::Both);
        Self { description, meshes: vec![ground, mesh([[-0.5; 3], [0.5; 3]], 1.5, Role::Both)] }
    }

    /// Plans a frame that `wrong` has changed.
    fn plan(&self, lends: Lends, wrong: impl Fn(&mut Frame)) -> Result<(), Error> {
        let light = generate::square_light(0.5)?;
        let own = Frame::new(Slot(0), light, DMat4::IDENTITY, &self.meshes, depth());
        let mut frame = Frame {
            background: Some(0.0),
            mask: Some(mask()),
            normals: Some(normals()),
            visibility: match lends {
                Lends::Visibility => Visibility::Lent(target()),
                _ => own.visibility,
            },
            occluder_maps: (lends == Lends::Maps).then(|| maps(&light)),
            light_texture: (lends == Lends::Texture).then(texture),
            ..own
        };
        wrong(&mut frame);
        self.description.check()?;
        frame::plan(&self.description, Limits::default(), &frame).map(drop)
    }
}

/// Which part of what a host gives is wrong, and how.
enum Wrong {
    Described(fn(&mut Description)),
    Drawn(fn(&mut MeshInstance)),
    Framed(fn(&mut Frame)),
}
use Wrong::{Described, Drawn, Framed};

/// What is wrong; who lends what, with which settings; what the sentence says.
type Row = (&'static str, Lends, &'static str, Wrong, Says);

/// The sentence's key words.
type Says = &'static [&'static str];

fn described(what: &'static str, wrong: fn(&mut Description), says: Says) -> Row {
    (what, Lends::GBuffer, "", Described(wrong), says)
}

fn drawn(what: &'static str, wrong: fn(&mut MeshInstance), says: Says) -> Row {
    (what, Lends::GBuffer, "", Drawn(wrong), says)
}

fn framed(what: &'static str, wrong: fn(&mut Frame), says: Says) -> Row {
    (what, Lends::GBuffer, "", Framed(wrong), says)
}

/// Holds every row against its sentence, and shows them.
fn refuses(rows: Vec<Row>) {
    let count = rows.len();
    for (what, lends, words, wrong, says) in rows {
        let mut given = Given::new(lends, words);
        given.plan(lends, |_| {}).unwrap_or_else(|e| panic!("{what}: before anything is: {e}"));
        let refused = match wrong {
            Described(wrong) => {
                wrong(&mut given.description);
                given.plan(lends, |_| {})
            }
            Drawn(wrong) => {
                wrong(&mut given.meshes[1]);
                given.plan(lends, |_| {})
            }
            Framed(wrong) => given.plan(lends, wrong),
        };
        let sentence = refused.map(|()| what).expect_err("a refusal").to_string();
        println!("{what}: {sentence}");
        let missing: Vec<_> = says.iter().filter(|word| !sentence.contains(**word)).collect();
        assert!(missing.is_empty(), "{what}: \"{sentence}\" says nothing of {missing:?}");
        assert!(!sentence.contains('\n') && sentence.len() < 300, "{what}: {sentence}");
    }
    println!("{count} refusals");
}

#[test]
fn descriptions() {
    use Lends::{Maps, Texture};
    let d = described;
    refuses(vec![
        d("no width", |d| d.extent = [0, 48], &["0×48", "1×1 to 16384×16384"]),
        d("no height", |d| d.extent[1] = 0, &["64×0"]),
        d("an absurd extent", |d| d.extent = [u32::MAX; 2], &["4294967295", "16384"]),
        d("no frames in flight", |d| d.frames_in_flight = 0, &["frames_in_flight is 0", "1 to 8"]),
        d("absurdly many", |d| d.frames_in_flight = u32::MAX, &["4294967295", "1 to 8"]),
        d("no lights", |d| d.lights = 0, &["1 to 64 lights", "not for 0"]),
        d("absurdly many lights", |d| d.lights = u32::MAX, &["1 to 64 lights"]),
        d("depth of color", |d| d.depth_format = vk::Format::R32_SFLOAT, &["depth", "R32_SFLOAT"]),
        d("depth of stencil", |d| d.depth_format = vk::Format::S8_UINT, &["depth", "S8_UINT"]),
        d("no format", |d| d.depth_format = vk::Format::UNDEFINED, &["depth", "UNDEFINED"]),
        d(
            "a mask of whole numbers",
            |d| d.mask_format = Some(vk::Format::R8_UINT),
            &["mask's", "R8_UINT"],
        ),
        d(
            "a mask of depth",
            |d| d.mask_format = Some(vk::Format::D16_UNORM),
            &["mask's", "D16_UNORM"],
        ),
        d(
            "normals of whole numbers",
            |d| d.normals = Some(Normals { format: vk::Format::R8G8B8A8_SINT, ..NORMALS }),
            &["normals' format R8G8B8A8_SINT", "floats"],
        ),
        d(
            "normals of two channels",
            |d| d.normals = Some(Normals { format: vk::Format::R16G16_SFLOAT, ..NORMALS }),
            &["R16G16_SFLOAT has fewer channels", "Signed", "the others three"],
        ),
        d(
            "an octahedron of one channel",
            |d| {
                let encoding = NormalEncoding::OctahedralUnsigned;
                d.normals = Some(Normals { format: vk::Format::R8_UNORM, encoding });
            },
            &["R8_UNORM has fewer channels", "OctahedralUnsigned", "read two"],
        ),
        d(
            "signed normals without a sign",
            |d| d.normals = Some(Normals { format: vk::Format::R8G8B8A8_UNORM, ..NORMALS }),
            &["R8G8B8A8_UNORM holds nothing below 0", "Signed", "say Unsigned"],
        ),
        d("a mask of nothing", |d| d.mask_format = Some(vk::Format::UNDEFINED), &["mask's"]),
        d("a stride under a position", |d| d.position_strides = vec![12, 8], &["8 bytes", "12"]),
        d(
            "a stride of no floats",
            |d| d.position_strides = vec![14],
            &["14 bytes", "multiples of 4"],
        ),
        d("an absurd stride", |d| d.position_strides = vec![4096], &["4096", "2048"]),
        d(
            "an error of more than all",
            |d| d.omit = Omit::Below(1.5),
            &["omit is Below(1.5)", "0 to 1"],
        ),
        d("an error that is no number", |d| d.omit = Omit::Below(f64::NAN), &["omit", "NaN"]),
        d(
            "too many techniques",
            |d| d.other_techniques = vec![d.technique; 16],
            &["16 other techniques", "15"],
        ),
        d(
            "no map",
            |d| d.technique = hard::Settings { map: 4097, ..Default::default() }.into(),
            &["setting map", "0 to 4096"],
        ),
        d(
            "an absurd map",
            |d| d.technique = hard::Settings { map: 1 << 20, ..Default::default() }.into(),
            &["setting map", "0 to 4096"],
        ),
        d(
            "a bad knob",
            |d| {
                let tolerance = f32::NAN;
                d.technique = soft_shadow_map::Settings { tolerance, ..Default::default() }.into();
            },
            &["tolerance", "NaN"],
        ),
        d(
            "a bad knob of the others",
            |d| d.other_techniques.push(hard::Settings { map: 4097, ..Default::default() }.into()),
            &["setting map", "4097"],
        ),
        d(
            "more rays than a list of pixels holds",
            |d| (d.technique, d.extent) = (technique("ray-march"), [16384; 2]),
            &["ray-march", "16384×16384", "128 MiB"],
        ),
        d(
            "maps that hold no depth",
            |d| d.occluder_maps = Some(vk::Format::R32_SFLOAT),
            &["occluder maps'", "R32_SFLOAT"],
        ),
        (
            "maps from one point for many",
            Maps,
            "",
            Described(|d| d.technique = technique("many-lights")),
            &["many-lights", "lend meshes"],
        ),
        (
            "maps from one point for a line",
            Maps,
            "",
            Described(|d| d.technique = technique("linear-light")),
            &["linear-light", "lend meshes"],
        ),
        (
            "two faces for many slices",
            Maps,
            "",
            Described(|d| d.technique = technique("occlusion-textures")),
            &["occlusion-textures", "lend meshes"],
        ),
        (
            "a texture that nobody weighs",
            Texture,
            "",
            Described(|d| d.technique = technique("pcss")),
            &["pcss", "choose ray-march"],
        ),
        d("an audit of few", |d| d.audit = 15, &["audit of 15 pixels", "16 to 65,536"]),
        d("an audit of all", |d| d.audit = 65_537, &["audit of 65537 pixels", "16 to 65,536"]),
        (
            "an audit without triangles",
            Maps,
            "",
            Described(|d| d.audit = 64),
            &["an audit traces triangles", "set audit to 0"],
        ),
        (
            "an audit of a texture",
            Texture,
            "",
            Described(|d| d.audit = 64),
            &["the light has a texture", "set audit to 0"],
        ),
        (
            "a texture of whole numbers",
            Texture,
            "",
            Described(|d| d.light_texture.as_mut().unwrap().format = vk::Format::R32G32_UINT),
            &["light texture's", "R32G32_UINT"],
        ),
    ]);
}

#[test]
fn lights() {
    let (o, x, y) = (DVec3::ZERO, DVec3::X, DVec3::Y);
    for (what, refused, says) in [
        ("a centre of NaN", RectangleLight::new(DVec3::NAN, x, y), "finite"),
        ("an axis without end", RectangleLight::new(o, x * f64::INFINITY, y), "finite"),
        ("no width", RectangleLight::new(o, o, y), "above 0"),
        ("no height", RectangleLight::new(o, x, o), "above 0"),
        ("a parallelogram", RectangleLight::new(o, x, x + y), "perpendicular"),
        ("a line of no length", RectangleLight::line(o, o, y), "longer than 0"),
        ("a line that shines along itself", RectangleLight::line(o, x, x), "across"),
        ("a sun of no size", RectangleLight::sun(-y, 0.0, o, 1.0), "angular size"),
        ("a sun of no place", RectangleLight::sun(-y, 0.01, o, f64::NAN), "finite"),
        ("a sun of no direction", RectangleLight::sun(o, 0.01, o, 1.0), "go somewhere"),
    ] {
        let sentence = refused.expect_err(what).to_string();
        println!("{what}: {sentence}");
        assert!(
            sentence.starts_with("the light cannot be used") && sentence.contains(says),
            "{sentence}"
        );
    }
}
