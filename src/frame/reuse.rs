//! Which passes a frame leaves out because their results are still valid.
//!
//! ```text
//!   light, meshes ──► passes ──► maps ──┐  kept while the host gives one scene revision
//!                                       ├──► passes ──► visibility
//!   camera, G-buffer ───────────────────┘  kept too while it gives one view revision
//! ```
//! The graph itself shows which passes those are: a pass depends on the camera where it reads or writes anything that
//! does. An image in which every pixel is lit already stays as it is whatever the revisions are.

use super::triangles::TreeKey;
use crate::graph::{Graph, Owner, Pass, ResourceId, Until, Why, Work};
use crate::lent::Visibility;
use ash::vk;

/// The host's revision numbers; `None` where the host gives none and anything may have changed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Revisions {
    /// The revision of light and meshes.
    pub scene: Option<u64>,
    /// The revision of camera and G-buffer.
    pub view: Option<u64>,
    /// The camera, where the maps' views follow it.
    pub camera: Option<CameraBits>,
}

/// A camera's matrix to world space, by column, as the bits of its numbers.
pub(crate) type CameraBits = [u64; 16];

/// A set of the kinds of pass of one description's graphs, a bit each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Kinds(u64);

impl Kinds {
    /// The kinds of the passes at these places; `None` where one of them is the 65th or a later kind.
    fn of(graph: &Graph, places: impl Iterator<Item = usize>) -> Option<Self> {
        let mut bits = places.map(|place| 1u64.checked_shl(graph.kind_of(place) as u32));
        bits.try_fold(0, |all, bit| Some(all | bit?)).map(Self)
    }

    fn is_empty(self) -> bool {
        self.0 == 0
    }
}

/// Maps in the cache: the scene revision they show, and the passes that made them, since a later frame may need more
/// maps than this one did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Maps {
    pub scene: u64,
    /// The camera, where their views follow it.
    pub camera: Option<CameraBits>,
    pub kinds: Kinds,
}

/// What the cache holds for one light and technique.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Cached {
    /// The maps.
    pub maps: Option<Maps>,
    /// Scene and view revision of the light's visibility image.
    pub pixels: Option<(u64, u64)>,
    /// Whether every pixel of that image is lit.
    pub lit: bool,
    /// The hierarchy of triangles.
    pub tree: Option<TreeKey>,
}

/// What a plan reuses from the cache, and what it leaves there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Reuse {
    /// The maps that the plan reads and does not draw.
    pub uses_maps: Option<Maps>,
    /// The scene and view revision of the visibility image that the plan leaves as it is.
    pub uses_pixels: Option<(u64, u64)>,
    /// Whether the plan leaves the visibility image as it is because every pixel is lit already.
    pub uses_lit: bool,
    /// The passes whose maps the plan draws for later frames; the maps show the frame's scene revision.
    pub makes_maps: Option<Kinds>,
    /// The list of triangles whose tree the plan uses, and whether it uses their places too.
    pub uses_tree: Option<(TreeKey, bool)>,
    /// The hierarchy that the plan makes, or fits to where the meshes are.
    pub makes_tree: Option<TreeKey>,
    /// Whether the plan makes every pixel lit.
    makes_lit: bool,
    revisions: Revisions,
}

impl Reuse {
    /// Whether the cache still holds what the plan reuses.
    pub fn agrees(&self, cached: &Cached) -> bool {
        (self.uses_maps.is_none() || self.uses_maps == cached.maps)
            && (self.uses_pixels.is_none() || self.uses_pixels == cached.pixels)
            && (!self.uses_lit || cached.lit)
            && self.uses_tree.is_none_or(|(key, places)| {
                cached.tree.is_some_and(|tree| tree.list == key.list && (!places || tree == key))
            })
    }

    /// Whether the plan leaves out the maps' passes; all passes; all passes because every pixel is lit; those that build
    /// the hierarchy; those that fit it to where the meshes are.
    pub fn uses(&self) -> [bool; 5] {
        let places = self.uses_tree.is_some_and(|(_, places)| places);
        let (maps, pixels) = (self.uses_maps.is_some(), self.uses_pixels.is_some());
        [maps, pixels, self.uses_lit, self.uses_tree.is_some(), places]
    }

    /// What the cache holds once the plan has run.
    pub fn cached_after(&self, cached: &Cached) -> Cached {
        Cached {
            maps: match (self.makes_maps, self.revisions.scene) {
                (Some(kinds), Some(scene)) => {
                    Some(Maps { scene, camera: self.revisions.camera, kinds })
                }
                (Some(_), None) => None,
                (None, _) => cached.maps,
            },
            pixels: self.revisions.scene.zip(self.revisions.view),
            lit: self.makes_lit || self.uses_lit,
            tree: self.makes_tree.or(cached.tree),
        }
    }
}

/// Leaves out the passes whose results the cache still holds. `lit`: the frame makes every pixel lit.
pub(super) fn apply(
    graph: &mut Graph,
    camera: &CameraDependence,
    lit: bool,
    (visibility, tree): (&Visibility, Option<TreeKey>),
    revisions: Revisions,
    cached: &Cached,
) -> Reuse {
    let mut reuse = Reuse { revisions, makes_lit: lit, ..Reuse::default() };
    // A lent image may be another one each frame, and an image in no layout holds nothing.
    let before = match visibility {
        Visibility::Own { before, .. } if before.layout != vk::ImageLayout::UNDEFINED => {
            Some(before)
        }
        _ => None,
    };
    // This comes first because it needs no revision; but only the node itself may have written the image.
    if lit && cached.lit && before.is_some_and(|b| !b.writes()) {
        graph.leave_out(|_| true, "every pixel is lit already");
        reuse.uses_lit = true;
        return reuse;
    }
    let all = revisions.scene.zip(revisions.view);
    let all = all.filter(|all| before.is_some() && cached.pixels == Some(*all));
    if let Some((scene, view)) = all {
        let why = Why::from("scene revision ").and(scene).and(" and view revision ").and(view);
        graph.leave_out(|_| true, why.and(" are drawn already"));
        reuse.uses_pixels = all;
        reuse.makes_lit = false;
        return reuse;
    }
    if let Some(tree) = tree {
        reuse_tree(graph, camera, tree, cached, &mut reuse);
    }
    let in_light_space = |place: usize| !camera.passes[place] && camera.until[place].is_none();
    let passes = graph.passes().iter().enumerate();
    let needed = passes.filter(|(place, p)| in_light_space(*place) && p.need.is_yes());
    // Without a set of their passes, maps could not be compared later: they are then drawn each frame.
    let kinds = Kinds::of(graph, needed.map(|(place, _)| place));
    let Some(kinds) = kinds.filter(|kinds| !kinds.is_empty()) else { return reuse };
    for &id in &camera.maps {
        graph.keep(id);
    }
    let maps = revisions.scene.map(|scene| Maps { scene, camera: revisions.camera, kinds });
    match maps.filter(|maps| cached.maps == Some(*maps)) {
        Some(Maps { scene, .. }) => {
            let why = Why::from("the maps of scene revision ").and(scene).and(" are kept");
            graph.leave_out(in_light_space, why);
            reuse.uses_maps = maps;
        }
        None => reuse.makes_maps = Some(kinds),
    }
    reuse
}

/// Leaves out the passes of the hierarchy whose results the cache still holds.
fn reuse_tree(
    graph: &mut Graph,
    camera: &CameraDependence,
    tree: TreeKey,
    cached: &Cached,
    reuse: &mut Reuse,
) {
    let kept = cached.tree.filter(|kept| kept.list == tree.list);
    let places = tree.moved.is_some() && kept == Some(tree);
    reuse.uses_tree = kept.map(|_| (tree, places));
    let until = &camera.until;
    if kept.is_some() {
        let why = "the same triangles block as before";
        graph.leave_out(|place| until[place] == Some(Until::Listed), why);
    }
    if places {
        let why = "no mesh that blocks has moved";
        graph.leave_out(|place| until[place] == Some(Until::Moved), why);
    }
    let needed = |p: &Pass| graph.until(p).is_some() && p.need.is_yes();
    reuse.makes_tree = graph.passes().iter().any(needed).then_some(tree);
}

/// Which passes and resources of a graph depend on the camera, and which on the blocking meshes alone.
#[derive(Clone, Debug, Default)]
pub(super) struct CameraDependence {
    /// For each pass, whether it reads or writes anything that depends on the camera.
    passes: Vec<bool>,
    /// For each pass, how long its results are valid where they depend on the blocking meshes alone.
    until: Vec<Option<Until>>,
    /// The transient resources that passes in light space write and passes that depend on the camera read.
    maps: Vec<ResourceId>,
}

impl CameraDependence {
    /// Follows the G-buffer's images, `pixels`, through the passes.
    pub fn find(&mut self, graph: &Graph, pixels: impl Iterator<Item = ResourceId>) {
        let resources = (0..graph.resources().len()).map(|i| graph.id(i));
        let mut depends: Vec<bool> =
            resources.map(|id| graph.resource(id).owner.is_result()).collect();
        pixels.for_each(|id| depends[id.index()] = true);
        self.until.clear();
        self.until.extend(graph.passes().iter().map(|pass| graph.until(pass)));
        // What constants a frame has is not in the graph, and its camera may be among them; to write them costs nothing.
        let of_frame =
            |pass: &Pass| matches!(pass.work, Work::Constants { .. } | Work::FrameNumber);
        self.passes.clear();
        self.passes.extend(graph.passes().iter().map(of_frame));
        loop {
            let before = depends.clone();
            for (pass_depends, pass) in self.passes.iter_mut().zip(graph.passes()) {
                *pass_depends |= pass.uses.iter().any(|u| depends[u.resource.index()]);
                if *pass_depends {
                    pass.writes().for_each(|id| depends[id.index()] = true);
                }
            }
            // A map that is drawn over after a pass of the camera has read it is gone in the next frame: its passes
            // have to run again, and so count as dependent.
            let mut read = vec![false; depends.len()];
            for (pass_depends, pass) in self.passes.iter().zip(graph.passes()) {
                if *pass_depends {
                    pass.reads().for_each(|id| read[id.index()] = true);
                } else {
                    pass.writes().for_each(|id| depends[id.index()] |= read[id.index()]);
                }
            }
            if depends == before {
                break;
            }
        }
        self.find_maps(graph);
    }

    fn find_maps(&mut self, graph: &Graph) {
        let passes = &self.passes;
        let which =
            |depends: bool| graph.passes().iter().zip(passes).filter(move |(_, d)| **d == depends);
        let read: Vec<_> = which(true).flat_map(|(p, _)| p.reads()).collect();
        self.maps.clear();
        self.maps.extend(
            which(false)
                .flat_map(|(p, _)| p.writes())
                .filter(|id| read.contains(id) && graph.resource(*id).owner == Owner::Transient),
        );
        self.maps.sort_unstable();
        self.maps.dedup();
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Description, full_graph};
    use super::*;
    use crate::graph::{Need, Push};
    use crate::shaders;
    use smallvec::smallvec;

    /// The passes that run in place of a technique's own where the frame does not need it.
    const STAND_INS: [&str; 2] = ["visibility.lit", "hard.visibility"];
    /// The pass that writes the numbers that the passes over pixels read.
    const CONSTANTS: &str = "gbuffer.constants";

    /// While light and meshes stay, only the passes over pixels run again.
    #[test]
    fn only_passes_over_pixels_run_again() {
        let again = |words: &str| {
            let technique = words.parse().unwrap();
            let graph = full_graph(&Description { technique, ..Description::new([64, 64]) });
            let of_camera = (0..graph.resources().len())
                .map(|i| graph.id(i))
                .filter(|id| graph.resource(*id).name.starts_with("gbuffer."));
            let mut camera = CameraDependence::default();
            camera.find(&graph, of_camera);
            let mut constants = false;
            let mut names: Vec<_> = graph
                .passes()
                .iter()
                .zip(&camera.passes)
                .filter(|(p, depends)| **depends && !STAND_INS.contains(&p.name))
                .inspect(|(p, _)| constants |= p.name == CONSTANTS)
                .filter(|(p, _)| p.name != CONSTANTS)
                .map(|(p, _)| p.name)
                .collect();
            names.dedup();
            assert!(constants, "{words}: the constants depend on the camera");
            names
        };
        for words in [
            "soft-shadow-map views=1",
            "soft-shadow-map receivers=map",
            "soft-shadow-map receivers=map accumulate=blend",
            "linear-light",
            "hard views=1",
            "pcss views=1",
            "back-projection views=1",
            "occlusion-textures views=1",
        ] {
            let names = again(words);
            if words.starts_with("hard") {
                assert!(names.is_empty(), "{names:?}");
                continue;
            }
            // Sorting the tiles first takes two more passes.
            let tiles = names.iter().filter(|n| n.starts_with("visibility.tiles")).count();
            assert_eq!(names.len() - tiles, 1, "{words}: {names:?}");
        }
        // Each point's map is drawn where the one before was.
        let many = again("many-lights samples=2");
        assert!(many.contains(&"many_lights.point_depth"), "{many:?}");
        // Beside its five passes over the pixels, the list that they share holds the light's outline.
        let rays = again("ray-march views=1");
        assert!(!rays.contains(&"ray_march.columns") && rays.len() == 6, "{rays:?}");
    }

    #[test]
    fn a_65th_kind_is_in_no_set() {
        let mut graph = Graph::new();
        let need = graph.need(&Need::Yes("test".into()));
        const LONGEST: &str = "kind.kind.kind.kind.kind.kind.kind.kind.kind.kind.kind.kind.kind.";
        for name in (1..=65).map(|length| &LONGEST[..length]) {
            graph.push(Pass::compute(name, shaders::LIT, [1; 3], Push::NONE, smallvec![], &need));
        }
        assert_eq!(Kinds::of(&graph, [0, 63].into_iter()), Some(Kinds(1 | 1 << 63)));
        assert_eq!(Kinds::of(&graph, [0, 64].into_iter()), None);
        assert!(Kinds::of(&graph, std::iter::empty()).is_some_and(Kinds::is_empty));
    }
}
