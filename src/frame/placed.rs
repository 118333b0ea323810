//! The meshes that matter to a light.

use crate::lent::{MeshBounds, MeshInstance};
use crate::stages::depth_layers::LightBox;
use glam::DMat4;

/// Meshes that matter to a light: their indices in the frame's list, and their boxes in light space.
#[derive(Clone, Debug, Default)]
pub(super) struct Placed {
    pub places: Vec<u32>,
    pub boxes: Vec<LightBox>,
    /// The meshes' own boxes and transforms, once views are made: kept for its memory.
    pub bounds: Vec<(MeshBounds, DMat4)>,
}

impl Placed {
    pub fn clear(&mut self) {
        self.places.clear();
        self.boxes.clear();
    }

    pub fn push(&mut self, place: u32, of: LightBox) {
        self.places.push(place);
        self.boxes.push(of);
    }

    /// Keeps the meshes whose box `keep` accepts; returns how many were removed.
    pub fn retain(&mut self, keep: impl Fn(&LightBox) -> bool) -> usize {
        let mut kept = 0;
        for i in 0..self.boxes.len() {
            if keep(&self.boxes[i]) {
                if kept < i {
                    self.places[kept] = self.places[i];
                    self.boxes[kept] = self.boxes[i];
                }
                kept += 1;
            }
        }
        let gone = self.boxes.len() - kept;
        self.places.truncate(kept);
        self.boxes.truncate(kept);
        gone
    }

    /// The meshes themselves.
    pub fn meshes<'a>(
        &'a self,
        all: &'a [MeshInstance],
    ) -> impl ExactSizeIterator<Item = &'a MeshInstance> + Clone {
        self.places.iter().map(|&place| &all[place as usize])
    }

    pub fn fill_bounds(&mut self, all: &[MeshInstance]) {
        self.bounds.clear();
        let meshes = self.places.iter().map(|&place| &all[place as usize]);
        self.bounds.extend(meshes.map(|m| (m.bounds, m.world_from_mesh)));
    }
}
