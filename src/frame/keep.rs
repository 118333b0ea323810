//! What stays valid from frame to frame: the rows that only light and meshes go into need not run again.
//!
//! ```text
//!   light, meshes ──► rows ──► maps ──┐  kept while the host gives one revision
//!                                     ├──► rows ──► visibility
//!   camera, G-buffer ─────────────────┘  kept too while it gives one view revision
//! ```
//! Which rows those are follows from the graph: what a row reads or writes ties it to the camera, or does not.
//! And where every pixel is lit, and was so before, no number is needed to leave the image as it is.

use crate::graph::{Graph, Owner, ResourceId, Why};
use crate::lent::Visibility;
use ash::vk;

/// The row that makes every pixel lit.
const LIT: &str = "visibility.lit";

/// The numbers that a host gives the state of things; none where it does not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Revisions {
    /// Of light and meshes.
    pub scene: Option<u64>,
    /// Of camera and G-buffer.
    pub view: Option<u64>,
}

/// Maps that are kept: of which scene revision, and by which rows they were made, since a frame may need fewer of them
/// than the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Maps {
    pub scene: u64,
    /// A bit a kind of row.
    pub rows: u64,
}

/// What recorded frames have left to a frame: of its light, by its settings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Kept {
    /// The maps.
    pub maps: Option<Maps>,
    /// Scene and view revision of the visibility image.
    pub pixels: Option<(u64, u64)>,
    /// Every pixel of it is lit.
    pub lit: bool,
}

/// What a plan counts on, and what it leaves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Keeping {
    /// The maps that it uses without making them.
    pub uses_maps: Option<Maps>,
    /// The revisions of the pixels that it leaves as they are.
    pub uses_pixels: Option<(u64, u64)>,
    /// It leaves the pixels as they are because every one is lit.
    pub uses_lit: bool,
    /// The rows of the maps that it makes, for others to use; their revision is that of the frame.
    pub makes_maps: Option<u64>,
    /// It makes every pixel lit.
    makes_lit: bool,
    revisions: Revisions,
}

impl Keeping {
    /// Whether what it counts on is what is kept.
    pub fn agrees(&self, kept: &Kept) -> bool {
        (self.uses_maps.is_none() || self.uses_maps == kept.maps)
            && (self.uses_pixels.is_none() || self.uses_pixels == kept.pixels)
            && (!self.uses_lit || kept.lit)
    }

    /// What it leaves out: the maps' rows, all rows, all rows because everything is lit.
    pub fn uses(&self) -> [bool; 3] {
        [self.uses_maps.is_some(), self.uses_pixels.is_some(), self.uses_lit]
    }

    /// What is kept behind it.
    pub fn behind(&self, kept: &Kept) -> Kept {
        Kept {
            maps: match (self.makes_maps, self.revisions.scene) {
                (Some(rows), Some(scene)) => Some(Maps { scene, rows }),
                (Some(_), None) => None,
                (None, _) => kept.maps,
            },
            pixels: self.revisions.scene.zip(self.revisions.view),
            lit: self.makes_lit || self.uses_lit,
        }
    }
}

/// Takes out of a frame's rows those that would make again what is kept.
pub(super) fn apply(
    graph: &mut Graph,
    ties: &Ties,
    visibility: &Visibility,
    revisions: Revisions,
    kept: &Kept,
) -> Keeping {
    let lit = graph.passes().iter().any(|p| p.name == LIT && p.need.is_yes());
    let mut keeping = Keeping { revisions, makes_lit: lit, ..Keeping::default() };
    // An image of the host's may be another one each frame, and one in no layout holds nothing.
    let before = match visibility {
        Visibility::Own { before, .. } if before.layout != vk::ImageLayout::UNDEFINED => {
            Some(before)
        }
        _ => None,
    };
    // First, because it holds whatever the numbers say; but only of what the node itself has written.
    if lit && kept.lit && before.is_some_and(|b| !b.writes()) {
        graph.leave_out(|_| true, "every pixel is lit already");
        keeping.uses_lit = true;
        return keeping;
    }
    let all = revisions.scene.zip(revisions.view);
    let all = all.filter(|all| before.is_some() && kept.pixels == Some(*all));
    if let Some((scene, view)) = all {
        let why = Why::from("scene revision ").and(scene).and(" and view revision ").and(view);
        graph.leave_out(|_| true, why.and(" are drawn already"));
        keeping.uses_pixels = all;
        keeping.makes_lit = false;
        return keeping;
    }
    let in_light_space = |row: usize| !ties.rows[row];
    let passes = graph.passes().iter().enumerate();
    let needed = passes.filter(|(row, p)| in_light_space(*row) && p.need.is_yes());
    // Beyond 64 kinds two share a bit; no technique has half as many.
    let rows = needed.fold(0, |bits, (row, _)| bits | 1u64 << (graph.kind_of(row) % 64));
    if rows == 0 {
        return keeping;
    }
    for &id in &ties.crossing {
        graph.keep(id);
    }
    let maps = revisions.scene.map(|scene| Maps { scene, rows });
    match maps.filter(|maps| kept.maps == Some(*maps)) {
        Some(Maps { scene, .. }) => {
            let why = Why::from("the maps of scene revision ").and(scene).and(" are kept");
            graph.leave_out(in_light_space, why);
            keeping.uses_maps = maps;
        }
        None => keeping.makes_maps = Some(rows),
    }
    keeping
}

/// What of a graph depends on the camera.
#[derive(Clone, Debug, Default)]
pub(super) struct Ties {
    /// Whether each row reads or writes anything that does.
    rows: Vec<bool>,
    /// What the other rows write and these read.
    crossing: Vec<ResourceId>,
}

impl Ties {
    /// Follows what the camera sees, `pixels`, through the rows.
    pub fn find(&mut self, graph: &Graph, pixels: impl Iterator<Item = ResourceId>) {
        let results = (0..graph.resources().len()).map(|i| graph.id(i));
        let mut tied: Vec<bool> = results.map(|id| graph.resource(id).owner.is_result()).collect();
        pixels.for_each(|id| tied[id.index()] = true);
        self.rows.clear();
        self.rows.resize(graph.passes().len(), false);
        loop {
            let before = tied.clone();
            for (row, pass) in self.rows.iter_mut().zip(graph.passes()) {
                *row |= pass.uses.iter().any(|u| tied[u.resource.index()]);
                if *row {
                    pass.writes().for_each(|id| tied[id.index()] = true);
                }
            }
            // What is written anew after pixels have looked at it is not there when they look again.
            let mut looked_at = vec![false; tied.len()];
            for (row, pass) in self.rows.iter().zip(graph.passes()) {
                if *row {
                    pass.reads().for_each(|id| looked_at[id.index()] = true);
                } else {
                    pass.writes().for_each(|id| tied[id.index()] |= looked_at[id.index()]);
                }
            }
            if tied == before {
                break;
            }
        }
        self.find_crossing(graph);
    }

    fn find_crossing(&mut self, graph: &Graph) {
        let rows = &self.rows;
        let of = |tied: bool| graph.passes().iter().zip(rows).filter(move |(_, s)| **s == tied);
        let read: Vec<_> = of(true).flat_map(|(p, _)| p.reads()).collect();
        self.crossing.clear();
        self.crossing.extend(
            of(false)
                .flat_map(|(p, _)| p.writes())
                .filter(|id| read.contains(id) && graph.resource(*id).owner == Owner::Transient),
        );
        self.crossing.sort_unstable();
        self.crossing.dedup();
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Description, full_graph};
    use super::*;

    /// What stands for a technique where it is not needed.
    const STAND_INS: [&str; 2] = ["visibility.lit", "hard.visibility"];

    /// The kinds of row that run again while light and meshes stay: those of pixels alone.
    #[test]
    fn only_pixels_are_looked_at_again() {
        let again = |words: &str| {
            let technique = words.parse().unwrap();
            let graph = full_graph(&Description { technique, ..Description::new([64, 64]) });
            let depth = (0..graph.resources().len())
                .map(|i| graph.id(i))
                .find(|id| graph.resource(*id).name == "gbuffer.depth")
                .unwrap();
            let mut ties = Ties::default();
            ties.find(&graph, std::iter::once(depth));
            let mut names: Vec<_> = graph
                .passes()
                .iter()
                .zip(&ties.rows)
                .filter(|(p, tied)| **tied && !STAND_INS.contains(&p.name))
                .map(|(p, _)| p.name)
                .collect();
            names.dedup();
            names
        };
        for words in [
            "soft-shadow-map",
            "soft-shadow-map receivers=map",
            "soft-shadow-map receivers=map accumulate=blend",
            "linear-light",
            "hard",
            "pcss",
            "back-projection",
            "occlusion-textures",
        ] {
            let names = again(words);
            if words == "hard" {
                assert!(names.is_empty(), "{names:?}");
                continue;
            }
            // Where tiles are sorted first, that takes two rows more.
            let tiles = names.iter().filter(|n| n.starts_with("visibility.tiles")).count();
            assert_eq!(names.len() - tiles, 1, "{words}: {names:?}");
        }
        // Each point's map is drawn where the one before was.
        let many = again("many-lights samples=2");
        assert!(many.contains(&"many_lights.point_depth"), "{many:?}");
        let rays = again("ray-march");
        assert!(!rays.contains(&"ray_march.columns") && rays.len() == 5, "{rays:?}");
    }
}
