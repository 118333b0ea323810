//! What the node still holds from recorded frames: pixels light by light, maps technique by technique.
//!
//! ```text
//!              technique 0   technique 1      a light has a layer of the visibility image;
//!   light 0  ┐                                a technique has maps, which show what the last
//!   light 1  ├──  maps          maps          of its lights has drawn
//!   light 2  ┘
//! ```
//! A host may plan every light before it records the first. A plan that reuses a light's maps would then be refused,
//! because the plans before it draw over them: so no plan reuses maps while another light's plan that draws them is
//! still to be recorded.

use super::reuse::{self, Cached, Reuse};
use super::triangles::TreeKey;
use crate::lent::{LightIndex, Slot, TechniqueIndex};

/// Where a frame's results lie in the cache: the light picks the layer, the technique the maps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CacheKey {
    pub light: LightIndex,
    pub technique: TechniqueIndex,
}

/// The state of a light's layer of the visibility image.
#[derive(Clone, Copy, Debug, Default)]
struct Pixels {
    /// The technique that wrote it, and the scene and view revision that it shows.
    written: Option<(TechniqueIndex, (u64, u64))>,
    /// Whether every pixel is lit.
    lit: bool,
}

/// The state of a technique's maps.
#[derive(Clone, Copy, Debug, Default)]
struct Maps {
    /// The light that drew them, and what they show.
    drawn: Option<(LightIndex, reuse::Maps)>,
    /// A bit for each light with a plan that draws them and is not recorded yet.
    planned: u64,
    /// The hierarchy of triangles, which serves all lights.
    tree: Option<TreeKey>,
    /// The hierarchy that plans which are not recorded yet make; `None` where they make several.
    planned_tree: Option<TreeKey>,
    /// A bit for each light with such a plan.
    tree_planned: u64,
    /// The light and the slot of a plan of which the first part is recorded and the second is not.
    begun: Option<(LightIndex, Slot)>,
}

/// What a node still holds from recorded frames.
#[derive(Debug)]
pub(crate) struct Cache {
    pixels: Vec<Pixels>,
    maps: Vec<Maps>,
}

impl Cache {
    /// An empty cache for a number of lights and techniques.
    pub fn new(lights: u32, techniques: usize) -> Self {
        Self {
            pixels: vec![Pixels::default(); lights as usize],
            maps: vec![Maps::default(); techniques],
        }
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.pixels.fill(Pixels::default());
        self.maps.fill(Maps::default());
    }

    /// What a frame finds when it is recorded; nothing for a light or a technique that does not exist.
    fn get(&self, key: CacheKey) -> Cached {
        let CacheKey { light, technique } = key;
        let pixels = self.pixels.get(light.0 as usize).copied().unwrap_or_default();
        let maps = self.maps.get(technique.0 as usize).copied().unwrap_or_default();
        Cached {
            maps: maps.drawn.filter(|drawn| drawn.0 == light).map(|drawn| drawn.1),
            pixels: pixels.written.filter(|by| by.0 == technique).map(|by| by.1),
            lit: pixels.lit,
            tree: maps.tree,
        }
    }

    /// What a frame may reuse when it is planned.
    pub fn for_plan(&self, key: CacheKey) -> Cached {
        let cached = self.get(key);
        let planned = self.maps.get(key.technique.0 as usize).map_or(0, |maps| maps.planned);
        let others = planned & !bit(key.light);
        let maps = cached.maps.filter(|_| others == 0);
        Cached { maps, tree: self.tree_for_plan(key), ..cached }
    }

    /// The hierarchy that a frame finds if it is recorded behind the plans that were made before it.
    fn tree_for_plan(&self, key: CacheKey) -> Option<TreeKey> {
        let maps = self.maps.get(key.technique.0 as usize)?;
        match maps.tree_planned & !bit(key.light) {
            0 => maps.tree,
            _ => maps.planned_tree.filter(|tree| tree.moved.is_some()),
        }
    }

    /// Forgets the plans that are not recorded yet: one of them was left out, and others counted on it.
    pub fn forget_planned(&mut self) {
        for maps in &mut self.maps {
            (maps.planned, maps.tree_planned, maps.planned_tree) = (0, 0, None);
        }
    }

    /// Notes that a plan was made, which will draw over a technique's maps.
    pub fn planned(&mut self, key: CacheKey, reuse: &Reuse) {
        let Some(maps) = self.maps.get_mut(key.technique.0 as usize) else { return };
        if reuse.makes_maps.is_some() {
            maps.planned |= bit(key.light);
        }
        if reuse.makes_tree.is_some() {
            let alone = maps.tree_planned & !bit(key.light) == 0;
            let same = alone || maps.planned_tree == reuse.makes_tree;
            maps.planned_tree = reuse.makes_tree.filter(|_| same);
            maps.tree_planned |= bit(key.light);
        }
    }

    /// Whether the cache still holds what a plan reuses.
    pub fn agrees(&self, key: CacheKey, reuse: &Reuse) -> bool {
        reuse.agrees(&self.get(key))
    }

    /// Notes that the first part of a plan is recorded, which draws over what it makes.
    pub fn begun(&mut self, key: CacheKey, slot: Slot, reuse: &Reuse) {
        let Some(maps) = self.maps.get_mut(key.technique.0 as usize) else { return };
        maps.begun = Some((key.light, slot));
        if reuse.makes_maps.is_some() {
            maps.drawn = None;
        }
        if reuse.makes_tree.is_some() {
            maps.tree = None;
        }
    }

    /// Whether the first part of a light's plan for a slot is the last that was recorded of the technique.
    pub fn has_begun(&self, key: CacheKey, slot: Slot) -> bool {
        let maps = self.maps.get(key.technique.0 as usize);
        maps.is_some_and(|maps| maps.begun == Some((key.light, slot)))
    }

    /// Notes that a plan is recorded, and what it leaves.
    pub fn recorded(&mut self, key: CacheKey, reuse: &Reuse) {
        let cached = reuse.cached_after(&self.get(key));
        if let Some(pixels) = self.pixels.get_mut(key.light.0 as usize) {
            let written = cached.pixels.map(|pixels| (key.technique, pixels));
            *pixels = Pixels { written, lit: cached.lit };
        }
        // The light's earlier plans that were never recorded are not waited for any longer.
        for maps in &mut self.maps {
            maps.planned &= !bit(key.light);
            maps.tree_planned &= !bit(key.light);
        }
        if let Some(maps) = self.maps.get_mut(key.technique.0 as usize) {
            maps.tree = cached.tree;
            maps.begun = None;
            if reuse.makes_maps.is_some() {
                maps.drawn = cached.maps.map(|made| (key.light, made));
            }
        }
    }
}

/// The bit of a light; a node has up to 64.
fn bit(light: LightIndex) -> u64 {
    1u64.checked_shl(light.0).unwrap_or(0)
}
