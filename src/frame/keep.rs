//! What stays valid from frame to frame: the rows that only light and meshes go into need not run again.
//!
//! ```text
//!   light, meshes ──► rows ──► maps ──┐  kept while the host gives one revision
//!                                     ├──► rows ──► visibility
//!   camera, G-buffer ─────────────────┘  kept too while it gives one view revision
//! ```
//! Which rows those are follows from the graph: what a row reads or writes ties it to the camera, or does not.

use crate::graph::{Graph, Need, Owner, ResourceId};

/// The numbers that a host gives the state of things; none where it does not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Revisions {
    /// Of light and meshes.
    pub scene: Option<u64>,
    /// Of camera and G-buffer.
    pub view: Option<u64>,
}

/// What recorded frames have left in a node.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Kept {
    /// The scene revision of the maps.
    pub maps: Option<u64>,
    /// Scene and view revision of the visibility image.
    pub pixels: Option<(u64, u64)>,
}

/// What a plan counts on, and what it leaves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Keeping {
    /// The revision of the maps that it uses without making them.
    pub uses_maps: Option<u64>,
    /// The revisions of the pixels that it leaves as they are.
    pub uses_pixels: Option<(u64, u64)>,
    /// What is kept behind it, by what was kept before.
    makes_maps: bool,
    revisions: Revisions,
}

impl Keeping {
    /// Whether what it counts on is what is kept.
    pub fn agrees(&self, kept: &Kept) -> bool {
        (self.uses_maps.is_none() || self.uses_maps == kept.maps)
            && (self.uses_pixels.is_none() || self.uses_pixels == kept.pixels)
    }

    /// What is kept behind it.
    pub fn behind(&self, kept: &Kept) -> Kept {
        Kept {
            maps: if self.makes_maps { self.revisions.scene } else { kept.maps },
            pixels: self.revisions.scene.zip(self.revisions.view),
        }
    }
}

/// Takes out of a frame's rows those that would make again what is kept. `pixels` are what the camera sees; `owned`
/// says whether the visibility image is the node's, so that it is this frame's as well.
pub(super) fn apply(
    graph: &mut Graph,
    pixels: &[ResourceId],
    owned: bool,
    revisions: Revisions,
    kept: &Kept,
) -> Keeping {
    let seen = ties_to_camera(graph, pixels);
    let mut keeping = Keeping { revisions, ..Keeping::default() };
    let all = revisions.scene.zip(revisions.view).filter(|all| owned && kept.pixels == Some(*all));
    if let Some((scene, view)) = all {
        let why = format!("scene revision {scene} and view revision {view} are drawn already");
        graph.leave_out(|_| true, &why);
        keeping.uses_pixels = all;
        return keeping;
    }
    let maps = revisions.scene.filter(|scene| kept.maps == Some(*scene));
    let in_light_space = |row: usize| !seen[row];
    let runs = |graph: &Graph| {
        let rows = graph.passes().iter().enumerate();
        let mut needed =
            rows.filter(|(row, p)| in_light_space(*row) && matches!(p.need, Need::Yes(_)));
        needed.next().is_some()
    };
    if !runs(graph) {
        return keeping;
    }
    for id in crossing(graph, &seen) {
        graph.keep(id);
    }
    match maps {
        Some(scene) => {
            graph
                .leave_out(in_light_space, &format!("the maps of scene revision {scene} are kept"));
            keeping.uses_maps = maps;
        }
        None => keeping.makes_maps = true,
    }
    keeping
}

/// Whether each row reads or writes anything that depends on the camera.
fn ties_to_camera(graph: &Graph, pixels: &[ResourceId]) -> Vec<bool> {
    let mut resources: Vec<bool> = (0..graph.resources().len())
        .map(|i| graph.resources()[i].owner.is_result() || pixels.contains(&graph.id(i)))
        .collect();
    let mut rows = vec![false; graph.passes().len()];
    loop {
        let before = resources.clone();
        for (row, pass) in rows.iter_mut().zip(graph.passes()) {
            *row |= pass.uses.iter().any(|u| resources[u.resource.index()]);
            if *row {
                pass.writes().for_each(|id| resources[id.index()] = true);
            }
        }
        // What is written anew after pixels have looked at it is not there when they look again.
        let mut looked_at = vec![false; resources.len()];
        for (row, pass) in rows.iter().zip(graph.passes()) {
            if *row {
                pass.reads().for_each(|id| looked_at[id.index()] = true);
            } else {
                pass.writes().for_each(|id| resources[id.index()] |= looked_at[id.index()]);
            }
        }
        if resources == before {
            return rows;
        }
    }
}

/// What rows of light space write and others read.
fn crossing(graph: &Graph, seen: &[bool]) -> Vec<ResourceId> {
    let of = |tied: bool| graph.passes().iter().zip(seen).filter(move |(_, s)| **s == tied);
    let read: Vec<_> = of(true).flat_map(|(p, _)| p.reads()).collect();
    let mut ids: Vec<_> = of(false)
        .flat_map(|(p, _)| p.writes())
        .filter(|id| read.contains(id) && graph.resource(*id).owner == Owner::Transient)
        .collect();
    ids.sort_unstable();
    ids.dedup();
    ids
}

#[cfg(test)]
mod tests {
    use super::super::{Description, full_graph};
    use super::*;
    use crate::{Settings, Technique};

    /// The kinds of row that run again while light and meshes stay: those of pixels alone.
    #[test]
    fn only_pixels_are_looked_at_again() {
        let again = |words: &str, technique| {
            let mut settings = Settings { technique, ..Settings::default() };
            for word in words.split_whitespace() {
                let (key, value) = word.split_once('=').unwrap();
                settings.set(key, value).unwrap();
            }
            let graph = full_graph(&Description { settings, ..Description::new([64, 64]) });
            let depth = (0..graph.resources().len())
                .map(|i| graph.id(i))
                .find(|id| graph.resource(*id).name == "gbuffer.depth")
                .unwrap();
            let seen = ties_to_camera(&graph, &[depth]);
            let mut names: Vec<_> = graph
                .passes()
                .iter()
                .zip(&seen)
                .filter(|(p, tied)| **tied && p.name != "visibility.lit")
                .map(|(p, _)| p.name)
                .collect();
            names.dedup();
            names
        };
        use Technique as T;
        for (words, technique) in [
            ("", T::SoftShadowMap),
            ("receivers=map", T::SoftShadowMap),
            ("receivers=map accumulate=blend", T::SoftShadowMap),
            ("", T::LinearLight),
            ("", T::Hard),
            ("", T::Pcss),
            ("", T::BackProjection),
            ("", T::OcclusionTextures),
        ] {
            let names = again(words, technique);
            assert_eq!(names.len(), 1, "{words}: {names:?}");
        }
        // Each point's map is drawn where the one before was.
        let many = again("samples=2", T::ManyLights);
        assert!(many.contains(&"baseline.point_depth"), "{many:?}");
        let rays = again("", T::RayMarch);
        assert!(!rays.contains(&"ray_march.columns") && rays.len() == 5, "{rays:?}");
    }
}
