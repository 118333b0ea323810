//! The meshes of a scene: each of the file's that is placed, in a pose and in parts.

use super::buffers::Buffers;
use super::document::Document;
use super::emissive::Emission;
use super::json::{Root, at};
use super::triangles::{Reader, Shape};
use super::{MAX_COORDINATE, Problem, nodes, pose};
use crate::scene::{Bounds, Instance, Mesh};
use glam::{DMat4, DVec3};
use std::collections::BTreeMap;
use std::ops::Range;
use std::rc::Rc;

/// The file's meshes, each read when a node first places it, and those that look the same once.
pub(super) struct Meshes<'a> {
    root: &'a Root,
    document: &'a Document<'a>,
    pub reader: Reader<'a>,
    /// The meshes of the scene.
    pub read: Vec<Mesh>,
    /// What each of the scene's meshes shines with.
    pub emissions: Vec<Option<Emission>>,
    /// The box around each of the scene's meshes, in mesh space.
    pub boxes: Vec<Bounds>,
    /// The way from the origin of each of the scene's meshes to where it was in the file.
    pub origins: Vec<DVec3>,
    /// For each mesh of the file, the range of the scene's meshes that hold its triangles.
    of_index: Vec<Option<Range<usize>>>,
    of_shape: BTreeMap<Shape, Range<usize>>,
    buffers: &'a Buffers<'a>,
    /// The transforms of all nodes to the world, where there are skins.
    worlds: &'a [DMat4],
    skins: BTreeMap<usize, Rc<pose::Skin>>,
}

impl<'a> Meshes<'a> {
    pub fn new(
        (root, document): (&'a Root, &'a Document<'a>),
        buffers: &'a Buffers<'a>,
        reader: Reader<'a>,
        worlds: &'a [DMat4],
    ) -> Self {
        Self {
            root,
            document,
            reader,
            read: Vec::new(),
            emissions: Vec::new(),
            boxes: Vec::new(),
            origins: Vec::new(),
            of_index: vec![None; root.meshes.len()],
            of_shape: BTreeMap::new(),
            buffers,
            worlds,
            skins: BTreeMap::new(),
        }
    }

    /// The range of the scene's meshes that hold the triangles of `meshes[index]` as `node` poses them, and where a skin
    /// has placed them.
    pub fn find(
        &mut self,
        index: usize,
        node: usize,
    ) -> Result<(Range<usize>, Option<DVec3>), Problem> {
        let owner = || nodes::label(self.root, node);
        at(&self.root.meshes, index, "meshes", owner)?;
        let pose = pose::Pose::of(self.root, node, index)?;
        let skin = match pose.skin {
            Some(skin) => Some(self.skin(skin, node)?),
            None => None,
        };
        let origin = skin.as_ref().map(|skin| skin.origin);
        if let Some(known) = self.of_index[index].as_ref().filter(|_| pose.is_at_rest()) {
            return Ok((known.clone(), None));
        }
        let shape = self.reader.shape(index, &pose)?;
        let found = match self.of_shape.get(&shape) {
            Some(known) => known.clone(),
            None => {
                let first = self.read.len();
                for (mut mesh, emission) in self.reader.read(index, &shape, skin.as_ref())? {
                    self.origins.push(mesh.move_to_origin());
                    let [min, max] = mesh.bounds().map(|c| DVec3::from_array(c.map(f64::from)));
                    self.boxes.push(Bounds { min, max });
                    self.read.push(mesh);
                    self.emissions.push(emission);
                }
                self.of_shape.insert(shape, first..self.read.len());
                first..self.read.len()
            }
        };
        if pose.is_at_rest() {
            self.of_index[index] = Some(found.clone());
        }
        Ok((found, origin))
    }

    /// `skins[index]`, which a node refers to; each is read once.
    fn skin(&mut self, index: usize, node: usize) -> Result<Rc<pose::Skin>, Problem> {
        if let Some(known) = self.skins.get(&index) {
            return Ok(Rc::clone(known));
        }
        let owner = || nodes::label(self.root, node);
        let read = (self.root, self.document);
        let skin = pose::Skin::read(read, self.buffers, self.worlds, index, &owner)?;
        let skin = Rc::new(skin);
        self.skins.insert(index, Rc::clone(&skin));
        Ok(skin)
    }

    /// A box around the instances that `keep` accepts, in the world: around their meshes' boxes, for a
    /// file may place a large mesh a million times.
    pub fn around(
        &self,
        instances: &[Instance],
        keep: impl Fn(&Instance) -> bool,
    ) -> Option<Bounds> {
        let kept = instances.iter().filter(|i| keep(i));
        let corners = kept.flat_map(|i| {
            self.boxes[i.mesh].corners().map(|c| i.world_from_mesh.transform_point3(c))
        });
        corners.fold(None, |bounds, p| {
            let b = bounds.unwrap_or(Bounds { min: p, max: p });
            Some(Bounds { min: b.min.min(p), max: b.max.max(p) })
        })
    }
}

pub(super) fn within_reach(world_from_mesh: &DMat4, bounds: &Bounds) -> Result<(), Problem> {
    let reaches = |c: DVec3| world_from_mesh.transform_point3(c).abs().max_element();
    // `max` passes NaN over, so each corner is compared by itself.
    if bounds.corners().into_iter().all(|c| reaches(c) <= MAX_COORDINATE) {
        Ok(())
    } else {
        Err(format!("its mesh reaches further than {MAX_COORDINATE:e} m from the origin"))
    }
}
