//! Mistakes that hosts make, one a test: each is refused by a sentence, doubted in `FramePlan::doubts` and `explain`,
//! told by the validation layer, or documented where nothing can be known.
//!
//! 1 to 13 are refused, 14 to 17 the validation layer's, and 18 to 26 are those that give a wrong image and no error.

// A test says what went wrong by panicking. One calls for a device's handles.
#![allow(missing_docs, unsafe_code, clippy::unwrap_used, clippy::panic)]

#[path = "mistakes/border.rs"]
mod border;
#[path = "mistakes/layer.rs"]
mod layer;
#[path = "mistakes/silent.rs"]
mod silent;

use antumbra::LightIndex;
use antumbra::frame::{self, Doubt, Limits};
use antumbra::scene::Role;
use antumbra::{
    Description, Error, Frame, FramePlan, Geometry, HostImage, MeshBuffers, MeshInstance,
    RectangleLight, Scope, Slot, Technique,
};
use antumbra_tests::example::root;
use ash::vk::{self, Handle, ImageUsageFlags as Usage};
use glam::{DMat4, DVec3, DVec4};

const EXTENT: [u32; 2] = [64, 48];
const EYE: DVec3 = DVec3::new(3.5, 3.5, 5.0);

/// A host that makes no mistake: a cube above a ground, under a light, before a camera of reversed depth without a far
/// plane.
struct Host {
    description: Description,
    light: RectangleLight,
    meshes: Vec<MeshInstance>,
    /// `projection * view`, y down.
    clip_from_world: DMat4,
}

impl Host {
    fn new() -> Self {
        let buffers =
            MeshBuffers::indexed(vk::Buffer::from_raw(7), 12, vk::Buffer::from_raw(8), 36);
        let mesh = |bounds, y| {
            let at = DMat4::from_translation(DVec3::Y * y);
            MeshInstance::new(Geometry::Buffers(buffers), at, bounds, Role::Both)
        };
        let back = EYE.normalize();
        let right = DVec3::Y.cross(back).normalize();
        let axes = [right, back.cross(right), back].map(|axis| axis.extend(0.0));
        let world_from_view = DMat4::from_cols(axes[0], axes[1], axes[2], EYE.extend(1.0));
        let clip_from_view = DMat4::from_cols(
            DVec4::X * 1.2,
            DVec4::Y * -1.6,
            DVec4::new(0.0, 0.0, 0.0, -1.0),
            DVec4::new(0.0, 0.0, 0.1, 0.0),
        );
        Self {
            description: Description::new(EXTENT),
            light: RectangleLight::facing([0.0, 3.0, 0.0], DVec3::NEG_Y, DVec3::X, [0.5; 2])
                .unwrap(),
            meshes: vec![
                mesh([[-4.0, 0.0, -4.0], [4.0, 0.0, 4.0]], 0.0),
                mesh([[-0.5; 3], [0.5; 3]], 1.5),
            ],
            clip_from_world: clip_from_view * world_from_view.inverse(),
        }
    }

    /// Plans a frame that `wrong` has changed.
    fn plan_with(&self, wrong: impl FnOnce(&mut Frame)) -> Result<FramePlan, Error> {
        let mut frame =
            Frame::new(Slot(0), self.light, self.clip_from_world.inverse(), &self.meshes, depth());
        wrong(&mut frame);
        self.description.check()?;
        frame::plan(&self.description, Limits::default(), &frame)
    }

    fn plan(&self) -> FramePlan {
        self.plan_with(|_| {}).unwrap()
    }

    /// The sentence that refuses it.
    fn refused(&self, wrong: impl FnOnce(&mut Frame)) -> String {
        let sentence = self.plan_with(wrong).unwrap_err().to_string();
        println!("{sentence}");
        sentence
    }
}

/// A G-buffer's depth.
fn depth() -> HostImage {
    let handles = (vk::Image::from_raw(1), vk::ImageView::from_raw(1));
    let usage = Usage::DEPTH_STENCIL_ATTACHMENT | Usage::SAMPLED;
    let after = Scope::FRAGMENT_SAMPLED;
    HostImage::new(handles, vk::Format::D32_SFLOAT, EXTENT, usage, Scope::DEPTH_DRAWN, after)
}

#[track_caller]
fn says(text: &str, words: &[&str]) {
    let missing: Vec<_> = words.iter().filter(|word| !text.contains(**word)).collect();
    assert!(missing.is_empty(), "\"{text}\" says nothing of {missing:?}");
}

/// Whether docs/embedding.md has these sentences, wherever its lines end.
#[track_caller]
fn documented(sentences: &[&str]) {
    let page = std::fs::read_to_string(root().join("docs/embedding.md")).unwrap();
    let page = page.split_whitespace().collect::<Vec<_>>().join(" ");
    says(&page, sentences);
}

#[test]
fn without_a_mistake_there_is_no_doubt() {
    let plan = Host::new().plan();
    assert_eq!(plan.doubts(), []);
    let text = plan.explain();
    assert!(!text.contains("doubt"), "{text}");
    says(
        &text,
        &[
            "camera: eye (3.50, 3.50, 5.00), looks along (-0.50, -0.50, -0.71), reversed depth, far plane infinitely \
             far, not mirrored, sees 2 of 2 receivers",
            "roles of pixels: no mask, every pixel blocks and receives",
        ],
    );
}

#[test]
fn mistake_01_a_stride_that_was_not_described() {
    let mut host = Host::new();
    let Geometry::Buffers(buffers) = &mut host.meshes[1].geometry else { unreachable!() };
    buffers.positions_stride = 24;
    says(&host.refused(|_| {}), &["stride", "24", "12"]);
}

#[test]
fn mistake_02_a_depth_image_without_sampled_usage() {
    let sentence = Host::new().refused(|f| f.depth.usage = Usage::DEPTH_STENCIL_ATTACHMENT);
    says(&sentence, &["gbuffer.depth", "without SAMPLED usage"]);
}

#[test]
fn mistake_03_a_depth_image_of_another_extent() {
    let sentence = Host::new().refused(|f| f.depth.extent = [65, 48]);
    says(&sentence, &["gbuffer.depth is 65×48", "64×48", "resize the node"]);
}

#[test]
fn mistake_04_a_depth_image_of_another_format() {
    let sentence = Host::new().refused(|f| f.depth.format = vk::Format::D16_UNORM);
    says(&sentence, &["gbuffer.depth", "D16_UNORM", "D32_SFLOAT was described"]);
}

#[test]
fn mistake_05_a_layout_that_the_image_cannot_be_in() {
    let sentence = Host::new().refused(|f| f.depth.before = Scope::COLOR_DRAWN);
    says(&sentence, &["gbuffer.depth", "COLOR_ATTACHMENT_OPTIMAL", "color attachments"]);
}

#[test]
fn mistake_06_a_null_view() {
    let sentence = Host::new().refused(|f| f.depth.view = vk::ImageView::null());
    says(&sentence, &["gbuffer.depth", "view is a null handle"]);
}

#[test]
fn mistake_07_a_slot_that_does_not_exist() {
    says(&Host::new().refused(|f| f.slot = Slot(2)), &["slot 2", "2 frames in flight"]);
}

#[test]
fn mistake_08_a_light_that_does_not_exist() {
    says(
        &Host::new().refused(|f| f.light_index = LightIndex(1)),
        &["light 1", "has 1, counted from 0"],
    );
}

#[test]
fn mistake_09_a_count_of_no_whole_triangles() {
    let mut host = Host::new();
    let Geometry::Buffers(buffers) = &mut host.meshes[1].geometry else { unreachable!() };
    buffers.count = 35;
    says(&host.refused(|_| {}), &["mesh 1", "multiple of 3"]);
}

#[test]
fn mistake_10_a_transposed_mesh() {
    let mut host = Host::new();
    host.meshes[1].world_from_mesh = host.meshes[1].world_from_mesh.transpose();
    says(&host.refused(|_| {}), &["mesh 1", "is it transposed?"]);
}

#[test]
fn mistake_11_a_technique_that_does_not_exist() {
    let sentence = "pcff".parse::<Technique>().unwrap_err().to_string();
    says(&sentence, &["pcff", "pcss", "soft-shadow-map"]);
}

#[test]
fn mistake_12_a_knob_that_does_not_exist() {
    let sentence = Technique::default().set("mapp", "64").unwrap_err().to_string();
    says(&sentence, &["mapp", "map", "tolerance"]);
}

#[test]
fn mistake_13_a_value_out_of_its_range() {
    let sentence = Technique::default().set("map", "9999").unwrap_err().to_string();
    says(&sentence, &["map", "9999", "0 to 4096"]);
}
