//! Nodes that place their mesh many times (EXT_mesh_gpu_instancing).

use super::Problem;
use super::accessor::Vectors;
use super::buffers::Buffers;
use super::json::Root;
use super::nodes::{self, Placed};
use glam::{DMat4, DQuat, DVec3};

/// The bytes that an instance has in a file at least: a rotation of four bytes. So many instances do all nodes together
/// have at most, since nodes may share accessors.
const BYTES_AN_INSTANCE: u64 = 4;

/// The bytes of a file for each instance that a mesh is beside two, since nodes share a mesh of many surfaces.
const BYTES_A_PART: u64 = 16;

/// The places of a node's mesh, in the order of its instances. Nodes of a file share a limit.
pub(super) struct Places<'a> {
    root: &'a Root,
    buffers: &'a Buffers<'a>,
    made: u64,
    parts: u64,
}

impl<'a> Places<'a> {
    pub fn new(root: &'a Root, buffers: &'a Buffers<'a>) -> Self {
        Self { root, buffers, made: 0, parts: 0 }
    }

    /// The transforms from the mesh's space to the world: one, or as many as the node has instances.
    pub fn of(&mut self, placed: &Placed) -> Result<Vec<DMat4>, Problem> {
        let node = self.root.nodes.get(placed.node);
        let extensions = node.and_then(|node| node.extensions.as_deref());
        let Some(instancing) = extensions.and_then(|e| e.instancing.as_ref()) else {
            return Ok(vec![placed.world]);
        };
        let label = || nodes::label(self.root, placed.node);
        let attributes = &instancing.attributes;
        let owner =
            |what: &'static str| move || format!("the {what} of the instances of {}", label());
        let translations = self.open::<3>(attributes.translation, false, &owner("TRANSLATION"))?;
        let rotations = self.open::<4>(attributes.rotation, true, &owner("ROTATION"))?;
        let scales = self.open::<3>(attributes.scale, false, &owner("SCALE"))?;
        let counts = [
            translations.as_ref().map(Vectors::len),
            rotations.as_ref().map(Vectors::len),
            scales.as_ref().map(Vectors::len),
        ];
        let Some(count) = counts.into_iter().flatten().next() else {
            return Err(format!(
                "{} has instances without a TRANSLATION, ROTATION or SCALE, so that their number is not known",
                label()
            ));
        };
        if let Some(other) = counts.into_iter().flatten().find(|other| *other != count) {
            return Err(format!(
                "{} has {count} and {other} instances; their attributes must be equally many",
                label()
            ));
        }
        self.made = self.made.saturating_add(count as u64);
        let most = self.buffers.held() / BYTES_AN_INSTANCE;
        if self.made > most {
            return Err(format!(
                "{}: with it the nodes have {} instances, which is more than one for {BYTES_AN_INSTANCE} bytes of file \
                 and buffers; fewer nodes must share their accessors",
                label(),
                self.made
            ));
        }
        (0..count)
            .map(|i| {
                let wide = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
                let vector = |of: &Option<Vectors<3>>, otherwise| {
                    of.as_ref().and_then(|of| of.get(i)).map_or(otherwise, wide)
                };
                let rotation = rotations.as_ref().and_then(|of| of.get(i));
                let rotation =
                    rotation.map_or(DQuat::IDENTITY, |q| DQuat::from_array(q.map(f64::from)));
                let (translation, scale) =
                    (vector(&translations, DVec3::ZERO), vector(&scales, DVec3::ONE));
                let length = rotation.length();
                let within =
                    DMat4::from_scale_rotation_translation(scale, rotation / length, translation);
                let world = placed.world * within;
                if length.is_normal() && world.is_finite() {
                    return Ok(world);
                }
                Err(format!(
                    "{}: its instance {i} has numbers that are not finite, or a rotation of 0",
                    label()
                ))
            })
            .collect()
    }

    /// Counts the instances that a node is because its mesh is in parts, one for each kind of its surfaces.
    pub fn split(&mut self, placed: &Placed, [places, parts]: [usize; 2]) -> Result<(), Problem> {
        let more = places.saturating_mul(parts.saturating_sub(2));
        self.parts = self.parts.saturating_add(more as u64);
        if self.parts <= self.buffers.held() / BYTES_A_PART {
            return Ok(());
        }
        Err(format!(
            "{}: with it the meshes' surfaces of different kinds make {} instances, which is more than one for \
             {BYTES_A_PART} bytes of file and buffers; fewer nodes must share a mesh of so many materials",
            nodes::label(self.root, placed.node),
            self.parts
        ))
    }

    fn open<const N: usize>(
        &self,
        index: Option<usize>,
        integers: bool,
        owner: &dyn Fn() -> String,
    ) -> Result<Option<Vectors<'a, N>>, Problem> {
        let open = |index| Vectors::open(self.root, self.buffers, index, integers, owner);
        index.map(open).transpose()
    }
}
