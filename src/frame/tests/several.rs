//! Several lights of one node: what each plan reuses and leaves, and which layer it names.

use super::*;
use crate::frame::Cache;
use crate::frame::make::plan_with;
use crate::lent::{LightIndex, TechniqueIndex};

/// How many passes a soft shadow map has, and how many of them run over pixels.
const ALL: usize = 8;
const PIXELS: usize = 4;

/// A node's cache and its plans, without a device.
struct Node {
    description: Description,
    cache: Cache,
}

impl Node {
    fn new(lights: u32, other_techniques: Vec<Technique>) -> Self {
        let cache = Cache::new(lights, 1 + other_techniques.len());
        let description = Description { lights, other_techniques, ..description(&[]) };
        description.check().unwrap();
        Self { description, cache }
    }

    fn plan(&mut self, frame: &Frame) -> FramePlan {
        let key = CacheKey { light: frame.light_index, technique: frame.technique_index };
        let cached = self.cache.for_plan(key);
        let plan = plan_with(&self.description, Limits::default(), frame, &cached).unwrap();
        self.cache.planned(key, &plan.reuse);
        plan
    }

    /// Whether the node accepts the plan.
    fn record(&mut self, plan: &FramePlan) -> bool {
        let agrees = self.cache.agrees(plan.cache_key(), &plan.reuse);
        if agrees {
            self.cache.recorded(plan.cache_key(), &plan.reuse);
        }
        agrees
    }

    /// Plans every frame, records them in that order, and returns how many passes each ran.
    fn all(&mut self, frames: &[Frame]) -> Vec<usize> {
        let plans: Vec<_> = frames.iter().map(|f| self.plan(f)).collect();
        for plan in &plans {
            assert!(self.record(plan), "light {} is refused", plan.light_index);
        }
        plans.iter().map(|p| p.plan.steps.len()).collect()
    }
}

/// Frames of a number of lights at a scene and a view revision.
fn frames(meshes: &[MeshInstance], lights: u32, scene: u64, view: u64) -> Vec<Frame<'_>> {
    let of = |light| Frame {
        light_index: LightIndex(light),
        revision: Some(scene),
        view_revision: Some(view),
        ..frame(meshes)
    };
    (0..lights).map(of).collect()
}

#[test]
fn barriers_name_the_lights_layer_of_the_result_and_nothing_else() {
    let meshes = meshes();
    let d = Description { lights: 3, ..description(&[]) };
    for light in 0..3 {
        let light_index = LightIndex(light);
        let border_barriers = BorderBarriers::Host;
        let plan = make(&d, &Frame { light_index, border_barriers, ..frame(&meshes) });
        assert_eq!(plan.light_index, light_index);
        let layers: Vec<_> = plan.accesses().iter().map(|a| (a.name, a.layer)).collect();
        assert_eq!(layers, [("gbuffer.depth", 0), ("visibility", light)]);
        let all: Vec<_> = plan.entry_barriers().chain(plan.exit_barriers()).collect();
        assert_eq!(all.len(), 4);
        for barrier in all {
            let range = barrier.vk().subresource_range;
            let result = barrier.image == vk::Image::null();
            let layer = if result { light } else { 0 };
            assert_eq!((range.base_array_layer, range.layer_count), (layer, 1));
        }
    }
    // A lent image is the light's own.
    let d = Description { lent_visibility: true, ..d };
    let visibility = Visibility::Lent(target());
    let plan = make(&d, &Frame { light_index: LightIndex(2), visibility, ..frame(&meshes) });
    assert_eq!(plan.accesses()[1].layer, 0);
}

#[test]
fn every_bad_number_of_lights_or_techniques_is_one_sentence() {
    let meshes = meshes();
    let d =
        Description { lights: 4, other_techniques: vec![Technique::default()], ..description(&[]) };
    let f = frame(&meshes);
    let refuse = |d: &Description, frame: Frame| {
        plan(d, Limits::default(), &frame).map(|p| ran(&p)).unwrap_err().to_string()
    };
    let sentence = refuse(&d, Frame { light_index: LightIndex(4), ..f });
    assert!(sentence.contains("light 4 does not exist; the description has 4"), "{sentence}");
    let sentence = refuse(&d, Frame { technique_index: TechniqueIndex(2), ..f });
    assert!(sentence.contains("technique 2 does not exist; the description has 2"), "{sentence}");
    for lights in [0, 65] {
        let sentence = Description { lights, ..d.clone() }.check().unwrap_err().to_string();
        assert!(sentence.contains(&format!("1 to 64 lights, not for {lights}")), "{sentence}");
    }
    let other_techniques = vec![Technique::default(); 16];
    let sentence = Description { other_techniques, ..d.clone() }.check().unwrap_err().to_string();
    assert!(sentence.contains("16 other techniques are more than the 15"), "{sentence}");
    // Each of the techniques is held against the rest of the description, and against its frames.
    let many = "many-lights".parse().unwrap();
    let d = Description { other_techniques: vec![many], ..d };
    let maps = Description { occluder_maps: Some(vk::Format::D32_SFLOAT), ..d.clone() };
    assert!(maps.check().unwrap_err().to_string().contains("many-lights"));
    let small = crate::techniques::hard::Settings { map: 4097, views: 4 }.into();
    let small = Description { other_techniques: vec![small], ..d.clone() };
    assert!(small.check().unwrap_err().to_string().contains("0 to 4096"));
    let line = generate::line_light(1.0, 0.3).unwrap();
    let sentence = refuse(&d, Frame { light: line.into(), ..f });
    assert!(sentence.contains("soft-shadow-map takes no lines"), "{sentence}");
    make(&d, &Frame { light: line.into(), technique_index: TechniqueIndex(1), ..f });
}

#[test]
fn a_frame_has_the_passes_of_the_technique_that_it_chooses() {
    let meshes = meshes();
    let d = description(&[]);
    let mut others = Technique::all();
    others.retain(|technique| *technique != Technique::default());
    let several = Description { other_techniques: others.clone(), ..d.clone() };
    for (index, technique) in others.into_iter().enumerate() {
        let technique_index = TechniqueIndex(1 + index as u32);
        let mut chosen = make(&several, &Frame { technique_index, ..frame(&meshes) });
        let alone = make(&Description { technique, ..d.clone() }, &frame(&meshes));
        assert_eq!(chosen.technique_index, technique_index);
        chosen.technique_index = TechniqueIndex(0);
        assert_eq!(chosen, alone);
    }
}

/// Plans that are all made before the first is recorded are accepted in the order in which they were made.
#[test]
fn all_lights_may_be_planned_before_the_first_is_recorded() {
    let meshes = meshes();
    let mut node = Node::new(3, Vec::new());
    assert_eq!(node.all(&frames(&meshes, 3, 1, 1)), [ALL; 3]);
    assert_eq!(node.all(&frames(&meshes, 3, 1, 1)), [0; 3], "idle");
    // The camera moves: the one set of maps is drawn by each light in turn.
    assert_eq!(node.all(&frames(&meshes, 3, 1, 2)), [ALL; 3]);
    assert_eq!(node.all(&frames(&meshes, 3, 1, 3)), [ALL; 3]);
    // One light moves; the others have their pixels.
    let mut next = frames(&meshes, 3, 1, 3);
    next[1].revision = Some(2);
    assert_eq!(node.all(&next), [0, ALL, 0]);
    // And its maps stay, while it alone draws them.
    next[1].view_revision = Some(4);
    assert_eq!(node.all(&next), [0, PIXELS, 0]);
}

#[test]
fn maps_are_kept_for_a_light_that_has_a_technique_to_itself() {
    let meshes = meshes();
    let hard = "hard".parse().unwrap();
    let mut node = Node::new(2, vec![hard]);
    let both = |view| {
        let mut both = frames(&meshes, 2, 1, view);
        both[1].technique_index = TechniqueIndex(1);
        both
    };
    assert_eq!(node.all(&both(1)), [ALL, 3]);
    assert_eq!(node.all(&both(2)), [PIXELS, 2]);
    // Another technique makes other pixels of the same revisions.
    assert_eq!(node.all(&frames(&meshes, 2, 1, 2)), [0, ALL]);
}

#[test]
fn maps_of_one_light_are_never_anothers() {
    let meshes = meshes();
    let mut node = Node::new(2, Vec::new());
    let [a, b] = frames(&meshes, 2, 1, 1).try_into().unwrap();
    let moved = |f| Frame { view_revision: Some(2), ..f };
    assert_eq!(node.all(&[a]), [ALL]);
    assert_eq!(node.all(&[moved(b)]), [ALL], "the same number, of another light");
    assert_eq!(node.all(&[moved(a)]), [ALL]);
    let counts_on_maps = node.plan(&a);
    assert_eq!(
        ran(&counts_on_maps),
        [
            "gbuffer.constants",
            "visibility.tiles_start",
            "visibility.tiles",
            "soft_shadow_map.gather_pixels"
        ]
    );
    // Another light draws over them first.
    let drawn = node.plan(&b);
    assert!(node.record(&drawn));
    assert!(!node.record(&counts_on_maps), "stale");
    let again = node.plan(&a);
    assert_eq!(again.plan.steps.len(), ALL);
    // While that is not recorded, the other light does not reuse its maps either.
    assert_eq!(node.plan(&moved(b)).plan.steps.len(), ALL);
    assert_eq!(node.all(&[b]), [0]);
    assert_eq!(node.plan(&Frame { view_revision: Some(3), ..a }).plan.steps.len(), ALL);
    assert_eq!(node.plan(&moved(b)).plan.steps.len(), ALL);
    let idle = frames(&[], 2, 1, 1);
    node.all(&idle[..1]);
    assert_eq!(
        node.all(&[moved(b)]),
        [PIXELS],
        "the dropped plans of the other light are forgotten"
    );
}

#[test]
fn lit_pixels_stay_lit_whatever_the_revisions_are() {
    let shadowed = meshes();
    for lights in [1, 2] {
        let mut node = Node::new(lights, vec![Technique::default()]);
        let light_index = lights - 1;
        let lit = Frame { light_index: LightIndex(light_index), ..frame(&[]) };
        assert_eq!(node.all(&[lit]), [1]);
        let again = node.plan(&lit);
        assert!(again.plan.steps.is_empty());
        assert!(again.plan.reasons().any(|(_, why)| why == "every pixel is lit already".into()));
        // Other revisions and another technique leave every pixel lit as well.
        let other = Frame {
            technique_index: TechniqueIndex(1),
            revision: Some(3),
            view_revision: Some(4),
            ..lit
        };
        assert_eq!(node.all(&[other]), [0]);
        assert_eq!(node.all(&[lit, other]), [0, 0]);
        // After the host discards or writes the image, nothing can be reused.
        for before in [Scope::UNUSED, Scope::COMPUTE_WRITTEN] {
            let visibility = Visibility::Own { before, after: Scope::FRAGMENT_SAMPLED };
            assert_eq!(node.all(&[Frame { visibility, ..lit }]), [1]);
        }
        // A shadow in between, and the plan from before it is stale.
        assert_eq!(node.all(&[Frame { meshes: &shadowed, ..lit }]), [ALL]);
        assert!(!node.record(&again));
        assert_eq!(node.all(&[lit, lit]), [1, 1]);
        assert!(node.record(&again), "lit again");
    }
    // A lent image may be another one each frame.
    let mut node = Node::new(1, Vec::new());
    node.description.lent_visibility = true;
    let visibility = Visibility::Lent(target());
    assert_eq!(node.all(&[Frame { visibility, ..frame(&[]) }]), [1]);
    assert_eq!(node.all(&[Frame { visibility, ..frame(&[]) }]), [1]);
}

/// After an idle frame of lit pixels, the node still knows that every pixel is lit.
#[test]
fn idle_pixels_stay_lit_too() {
    let mut node = Node::new(1, Vec::new());
    let [idle] = frames(&[], 1, 1, 1).try_into().unwrap();
    assert_eq!(node.all(&[idle]), [1]);
    assert_eq!(node.all(&[idle]), [0]);
    assert_eq!(node.all(&[frame(&[])]), [0]);
    let forgotten = Visibility::Own { before: Scope::UNUSED, after: Scope::FRAGMENT_SAMPLED };
    assert_eq!(node.all(&[idle]), [0]);
    assert_eq!(node.all(&[Frame { visibility: forgotten, ..idle }]), [1], "nothing is left of it");
}

#[test]
fn of_16_lights_12_that_reach_nothing_cost_what_4_cost() {
    let shadowed = meshes();
    let mut node = Node::new(16, Vec::new());
    let meshes = |light| if light % 4 == 0 { &shadowed[..] } else { &[] };
    let frames = || {
        let of = |light| Frame { light_index: LightIndex(light), ..frame(meshes(light)) };
        (0..16).map(of).collect::<Vec<_>>()
    };
    assert_eq!(node.all(&frames()).iter().sum::<usize>(), 4 * ALL + 12);
    assert_eq!(node.all(&frames()).iter().sum::<usize>(), 4 * ALL);
}
