use super::*;
use crate::effects::*;
use crate::frame::{Description, Frame};
use crate::graph::Scope;
use crate::lent::Slot;
use crate::lent::{Geometry, HostImage, MeshBuffers, MeshInstance};
use crate::scene::{Role, generate};
use crate::{RectangleLight, Technique};
use ash::vk::{self, Handle};
use glam::{DMat4, DVec3, DVec4};

const GROUND: [[f32; 3]; 2] = [[-4.0, 0.0, -4.0], [4.0, 0.0, 4.0]];
pub(super) const CUBE: [[f32; 3]; 2] = [[-0.5; 3], [0.5; 3]];
const CARD: [[f32; 3]; 2] = [[-0.5, 0.0, -0.5], [0.5, 0.0, 0.5]];

pub(super) fn mesh(bounds: [[f32; 3]; 2], at: DVec3, role: Role, triangles: u32) -> MeshInstance {
    MeshInstance {
        geometry: Geometry::Buffers(MeshBuffers {
            positions: vk::Buffer::from_raw(3),
            positions_offset: 0,
            positions_stride: 12,
            indices: None,
            count: 3 * triangles,
        }),
        world_from_mesh: DMat4::from_translation(at),
        bounds,
        role,
        double_sided: false,
        cut_out: false,
        opacity: None,
    }
}

pub(super) fn ground() -> MeshInstance {
    mesh(GROUND, DVec3::ZERO, Role::Receiver, 2)
}

pub(super) fn over(bounds: [[f32; 3]; 2], y: f64) -> Vec<MeshInstance> {
    vec![ground(), mesh(bounds, DVec3::Y * y, Role::Occluder, 12)]
}

/// A camera straight above, with the ground's 8 m over 512 pixels.
pub(super) fn frame(light: RectangleLight, meshes: &[MeshInstance]) -> Frame<'_> {
    let depth = HostImage {
        image: vk::Image::from_raw(1),
        view: vk::ImageView::from_raw(2),
        format: vk::Format::D32_SFLOAT,
        extent: [512; 2],
        usage: vk::ImageUsageFlags::SAMPLED,
        before: Scope::FRAGMENT_SAMPLED,
        after: Scope::FRAGMENT_SAMPLED,
    };
    let world_from_ndc = DMat4::from_cols_array_2d(&[
        [4.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 4.0, 0.0],
        [0.0, 8.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 1.0],
    ]);
    Frame { background: Some(0.0), ..Frame::new(Slot(0), light, world_from_ndc, meshes, depth) }
}

pub(super) fn square(side: f64) -> RectangleLight {
    generate::square_light(side).unwrap()
}

pub(super) fn description() -> Description {
    Description::new([512; 2])
}

fn see(light: RectangleLight, meshes: &[MeshInstance]) -> Option<Situation> {
    crate::frame::situation(&description(), &frame(light, meshes)).unwrap()
}

pub(super) fn auto(max_error: Option<f64>, max_ms: Option<f64>) -> Auto {
    Auto::new(Budget { max_error, max_ms }, Costs::default())
}

fn choose(auto: &mut Auto, light: RectangleLight, meshes: &[MeshInstance]) -> Choice {
    auto.choose(&description(), &frame(light, meshes)).unwrap()
}

#[test]
fn boxes_tell_distances_penumbrae_and_pixels() {
    let s = see(square(0.4), &over(CARD, 2.0)).unwrap();
    let near = |found: f64, expected: f64| {
        assert!((found - expected).abs() < 0.01 * expected, "{found} is not {expected}");
    };
    near(s.occluder_distances[0], 2.0);
    near(s.receiver_distances[1], 4.0);
    // The ground is as far below the card as that is below the light: a penumbra as wide as the light.
    near(s.penumbra, 0.4);
    near(s.penumbra_pixels, 0.4 / (8.0 / 512.0));
    near(s.size, 1.0);
    // 12 triangles: 4 √12 edges over a metre.
    near(s.edges, 4.0 * 12f64.sqrt());
    assert!(s.sheets && !s.overlap && s.thickness == 0.0 && s.both == 0);
    // Eq. 3 for a cube of 1 m at 1.5 m from the light, over a ground at 4 m: ½ · 1 · 4 / (1.5 · 1.5).
    let s = see(square(0.4), &over(CUBE, 2.0)).unwrap();
    near(s.thickness, 0.5 * 4.0 / (1.5 * 1.5));
    assert!(!s.sheets && !s.overlap);
    // Where it stands there is no bound but 1.
    assert_eq!(see(square(0.4), &over(CUBE, 0.5)).unwrap().thickness, 1.0);
    assert_eq!(see(square(0.4), &[ground()]), None);
}

#[test]
fn perspective_pixels_grow_with_distance_and_a_camera_inside_knows_no_smallest() {
    let meshes = over(CARD, 2.0);
    // A camera this high looks straight down with a field of view of 1 rad.
    let look = |height: f64| {
        let scale = 1.0 / 0.5f64.tan();
        let clip_from_world = DMat4::from_cols_array_2d(&[
            [scale, 0.0, 0.0, 0.0],
            [0.0, 0.0, 0.0, -1.0],
            [0.0, scale, 0.0, 0.0],
            [0.0, 0.0, 0.01, height],
        ]);
        let mut frame = frame(square(0.4), &meshes);
        frame.world_from_ndc = clip_from_world.inverse();
        crate::frame::situation(&description(), &frame).unwrap().unwrap().penumbra_pixels
    };
    let far = look(40.0);
    let further = look(80.0);
    // A pixel is 2 tan(½) / 512 of the distance.
    let pixel = 2.0 * 0.5f64.tan() / 512.0 * 38.0;
    assert!((far * pixel - 0.4).abs() < 0.02, "{far}");
    assert!((far / further - 2.0).abs() < 0.1, "{far} {further}");
    // A matrix that says nothing of what is in front of the camera is no reason to leave anything out.
    let mut flat = frame(square(0.4), &meshes);
    flat.world_from_ndc.z_axis = -2.0 * flat.world_from_ndc.w_axis + DVec4::Y;
    let situation = crate::frame::situation(&description(), &flat).unwrap().unwrap();
    assert!(situation.penumbra_pixels > HARD_PIXELS);
    // With what may be shadowed behind it.
    assert_eq!(look(-1.0), f64::INFINITY);
}

#[test]
fn every_effect_has_a_rule_and_a_reason_for_both_outcomes() {
    let page = include_str!("../../docs/planner.md");
    for (i, rule) in RULES.iter().enumerate() {
        assert_eq!(rule.effect as usize, i, "{}", rule.name);
        let Rule { name, needed, bound, passes, .. } = rule;
        let row = format!("| {name} | {needed} | {bound} | {passes} |");
        assert!(page.contains(&row), "docs/planner.md lacks this row:\n{row}");
    }
    let technique = Technique::default();
    for situation in [None, see(square(0.4), &over(CUBE, 0.5)), see(square(1e-4), &over(CARD, 0.1))]
    {
        for max_error in [None, Some(0.01)] {
            let verdicts = Verdicts::judge(situation, technique.room(), max_error, false);
            for v in verdicts.all() {
                let why = verdicts.why(v.effect);
                assert!(!why.to_string().is_empty() && why.has_room(), "{why}");
                assert!((0.0..=1.0).contains(&v.bound), "{v:?}");
                if situation.is_none() {
                    assert_eq!((v.outcome, v.bound), (Outcome::LeftOut, 0.0));
                }
            }
            assert_eq!(verdicts.to_string().lines().count(), COUNT);
        }
    }
    let hard =
        Verdicts::judge(see(square(1e-4), &over(CARD, 0.1)), technique.room(), Some(0.01), false);
    assert!(!hard.needs(Effect::Penumbra) && hard.needs(Effect::Shadow));
}

/// A smaller allowed error never leaves out more effects.
#[test]
fn a_stricter_bound_leaves_out_no_more() {
    let technique: Technique = "ray-march".parse().unwrap();
    for (light, meshes) in [
        (0.4, over(CUBE, 2.0)),
        (0.01, over(CARD, 0.1)),
        (0.4, over([[-0.5, -0.01, -0.5], [0.5, 0.01, 0.5]], 2.0)),
    ] {
        let situation = see(square(light), &meshes);
        let mut last = COUNT + 1;
        for max_error in [Some(1.0), Some(0.1), Some(0.02), Some(0.001), Some(0.0), None] {
            let verdicts = Verdicts::judge(situation, technique.room(), max_error, false);
            let left_out = verdicts.all().iter().filter(|v| v.outcome == Outcome::LeftOut).count();
            assert!(left_out <= last, "{max_error:?}");
            last = left_out;
        }
    }
}

#[test]
fn a_smaller_error_takes_more_time_and_a_smaller_time_more_error() {
    let meshes = over(CUBE, 2.0);
    let mut last = 0.0;
    for e in [0.1, 0.05, 0.02, 0.01] {
        let c = choose(&mut auto(Some(e), None), square(0.4), &meshes);
        assert!(c.error.unwrap() <= e && c.problem.is_none(), "{c}");
        assert!(c.ms.unwrap() >= last, "{c}");
        last = c.ms.unwrap();
    }
    let mut last = 0.0;
    for ms in [1e4, 200.0, 100.0, 60.0] {
        let c = choose(&mut auto(None, Some(ms)), square(0.4), &meshes);
        assert!(c.ms.unwrap() <= ms && c.problem.is_none(), "{c}");
        assert!(c.error.unwrap() >= last, "{c}");
        last = c.error.unwrap();
    }
    let neither = choose(&mut auto(None, None), square(0.4), &meshes);
    let default = choose(&mut auto(Some(Budget::DEFAULT_ERROR), None), square(0.4), &meshes);
    assert_eq!(neither, default);
}

#[test]
fn a_budget_without_sense_or_hope_gets_a_sentence_and_the_nearest() {
    let meshes = over(CUBE, 2.0);
    let of = |e, t| choose(&mut auto(e, t), square(0.4), &meshes);
    let best = of(Some(1e-9), None);
    assert!(best.problem.as_ref().unwrap().contains("no error below"), "{best}");
    for e in [0.0, -1.0] {
        let c = of(Some(e), None);
        assert!(c.problem.as_ref().unwrap().contains("above 0"), "{c}");
        assert_eq!(c.technique, best.technique, "{c}");
    }
    let c = of(Some(f64::NAN), None);
    assert!(c.problem.as_ref().unwrap().contains("not a number"), "{c}");
    assert_eq!(c.technique, of(None, None).technique);
    let fastest = of(None, Some(1e-9));
    assert!(fastest.problem.as_ref().unwrap().contains("nothing takes less"), "{fastest}");
    for ms in [0.0, -3.0] {
        let c = of(None, Some(ms));
        assert!(c.problem.is_some() && c.technique == fastest.technique, "{c}");
    }
    let both = of(Some(best.error.unwrap() * 1.01), Some(fastest.ms.unwrap() * 1.01));
    assert!(both.problem.as_ref().unwrap().contains("what the time buys"), "{both}");
}

/// An occluder that goes up and down across where another choice would be better.
#[test]
fn a_choice_does_not_flap() {
    for e in [0.05, 0.03, 0.02, 0.01] {
        let mut auto = auto(Some(e), None);
        let mut changes = 0;
        for i in 0..600 {
            let y = 1.5 + 0.9 * (f64::from(i) * 0.7).sin();
            let c = choose(&mut auto, square(0.4), &over(CUBE, y));
            assert!(i == 0 || c.error.unwrap() <= e || c.problem.is_some(), "{c}");
            changes += u32::from(c.changed);
        }
        assert!(changes <= 4, "{e}: {changes} changes");
    }
}

#[test]
fn what_has_been_better_for_long_is_taken_and_told() {
    let alone = |side, meshes: &[MeshInstance]| {
        let mut auto = auto(Some(0.02), None);
        let choice = choose(&mut auto, square(side), meshes);
        (auto, choice)
    };
    let (_, now) = alone(1.0, &over(CARD, 2.0));
    // Something else under a smaller light, whatever the table's times are.
    let mut others =
        [0.2, 0.1, 0.03, 0.01, 0.003].map(|side| alone(side, &over(CUBE, 0.6))).into_iter();
    let (mut auto, other) = others.find(|(_, c)| c.technique != now.technique).unwrap();
    assert!(!other.changed, "the first is no change");
    let after = (0..200).find(|_| choose(&mut auto, square(1.0), &over(CARD, 2.0)).changed);
    assert!(after.is_some());
    assert_eq!(choose(&mut auto, square(1.0), &over(CARD, 2.0)).technique, now.technique);
}

#[test]
fn lights_share_the_time_by_need() {
    let alone = over(CUBE, 2.0);
    let lit = [ground()];
    let d = description();
    let frames = [
        frame(square(0.4), &alone),
        frame(square(0.05), &alone),
        frame(square(0.4), &lit),
        frame(square(1.0), &alone),
    ];
    let of = |ms| {
        let choices = auto(None, Some(ms)).choose_all(&d, &frames).unwrap();
        let total: f64 = choices.iter().filter_map(|c| c.ms).sum();
        (choices, total)
    };
    let (fastest, least) = of(1e-6);
    let problem = fastest[0].problem.as_ref().unwrap();
    assert!(problem.contains("together"), "{problem}");
    let mut last = f64::INFINITY;
    for ms in [1.1, 2.0, 6.0].map(|times| times * least) {
        let (choices, total) = of(ms);
        assert!(total <= ms, "{total} of {ms}");
        assert_eq!(
            (choices[2].error, choices[2].ms),
            (None, None),
            "nothing to shadow costs nothing"
        );
        let errors: f64 = choices.iter().filter_map(|c| c.error).sum();
        assert!(errors <= last, "more time, no more error");
        last = errors;
    }
}

#[test]
fn only_what_takes_the_hosts_meshes_maps_and_textures_is_chosen() {
    let mut meshes = over(CUBE, 2.0);
    meshes[1].geometry = Geometry::HostDrawn(7);
    for e in [0.05, 0.02, 0.005] {
        let c = choose(&mut auto(Some(e), None), square(0.4), &meshes);
        assert_ne!(c.technique.name(), "occlusion-textures", "{c}");
    }
    let texture = crate::frame::LightTexture { format: vk::Format::R8G8B8A8_UNORM, color: false };
    let d = Description { light_texture: Some(texture), ..description() };
    let meshes = over(CUBE, 2.0);
    let weighs = ["ray-march", "traced"];
    for e in [0.05, 0.02, 0.005] {
        let c = auto(Some(e), None).choose(&d, &frame(square(0.4), &meshes)).unwrap();
        assert!(weighs.contains(&c.technique.name()), "{c}");
    }
}

#[test]
fn a_line_is_for_linear_light() {
    let line = RectangleLight::line(DVec3::Y * 4.0, DVec3::X * 0.5, DVec3::NEG_Y).unwrap();
    let meshes = over(CUBE, 2.0);
    let c = choose(&mut auto(Some(0.02), None), line, &meshes);
    assert_eq!(c.technique.name(), "linear-light");
    assert!(c.problem.is_none() && c.error.unwrap() <= 0.0201, "{c}");
    c.technique.check().unwrap();
    let corners = [[-0.2, -0.2], [0.2, -0.2], [0.0, 0.2]];
    let light = crate::Light::with_outline(square(0.4), &corners).unwrap();
    let polygon = Frame { light, ..frame(square(0.4), &meshes) };
    let c = auto(Some(0.05), None).choose(&description(), &polygon).unwrap();
    assert_eq!((c.technique.name(), c.problem), ("linear-light", None));
    c.technique.check().unwrap();
    // With nothing to shadow it must still be something that takes a line.
    let c = choose(&mut auto(Some(0.02), None), line, &[ground()]);
    assert_eq!((c.technique.name(), c.error), ("linear-light", None));
    let c = choose(&mut auto(Some(1e-4), None), line, &meshes);
    assert!(c.problem.unwrap().contains("no error below"));
}

#[test]
fn discs_and_points_are_for_what_takes_them() {
    let (meshes, up, down) = (over(CUBE, 2.0), DVec3::Y * 4.0, DVec3::NEG_Y);
    let disc = crate::Light::disc(up, down, 0.2).unwrap();
    let point = RectangleLight::point(up, down).unwrap().into();
    for (light, meshes) in [(disc, &meshes[..]), (point, &meshes), (disc, &[ground()])] {
        let of = Frame { light, ..frame(square(0.4), meshes) };
        let c = auto(Some(0.03), None).choose(&description(), &of).unwrap();
        assert!(c.technique.room().takes().shapes.hold(&light) && c.problem.is_none(), "{c}");
    }
}

/// Scenes as the table has them, and scenes that it has not seen.
#[test]
fn promises_are_kept_in_the_tables_own_views_and_mostly_in_others() {
    let table = Table::own();
    assert!(table.views.len() >= 36, "{} views", table.views.len());
    let mut report = Vec::new();
    for e in [0.05, 0.03, 0.02, 0.01] {
        for (kind, seen) in [("seen", true), ("unseen", false)] {
            let (mut can, mut kept) = (0, 0);
            for view in &table.views {
                let others = table.without(&view.name[0]);
                let of = if seen { table } else { &others };
                let all =
                    expected::expect(of, &Costs::default(), &view.features, PIXELS, view.triangles);
                let good = all.iter().filter(|x| x.error <= e);
                let Some(best) = good.min_by(|a, b| a.ms.total_cmp(&b.ms)) else {
                    let could = view.measured.iter().any(|m| 1.06 * m.error <= e);
                    assert!(!(seen && could), "{:?}: {e} is said not to be possible", view.name);
                    continue;
                };
                can += 1;
                kept += u32::from(view.measured[best.candidate].error <= e);
            }
            let share = f64::from(kept) / f64::from(can.max(1));
            report.push(format!("{e} {kind}: {kept} of {can}"));
            let least = if seen { 1.0 } else { 0.8 };
            assert!(share >= least, "{report:?}");
        }
    }
    println!("{report:#?}");
}

#[test]
fn what_a_texture_cuts_is_said_to_be_drawn_whole() {
    let mut meshes = over(CARD, 2.0);
    meshes[1].cut_out = true;
    let technique = Technique::default();
    let judge = |meshes: &[MeshInstance]| {
        Verdicts::judge(see(square(0.4), meshes), technique.room(), Some(0.01), false)
    };
    let drawn_whole = judge(&meshes);
    assert_eq!(drawn_whole.of(Effect::CutOuts).outcome, Outcome::NotSimulated);
    assert!(drawn_whole.to_string().contains("1 meshes are cut out by textures, and drawn whole"));
    // The host can.
    meshes[1].geometry = Geometry::HostDrawn(3);
    assert_eq!(judge(&meshes).of(Effect::CutOuts).outcome, Outcome::Simulated);
    let whole = over(CARD, 2.0);
    assert_eq!(judge(&whole).of(Effect::CutOuts).outcome, Outcome::LeftOut);
}
