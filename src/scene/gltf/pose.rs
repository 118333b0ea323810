//! Meshes as they are posed: morph targets, then a skin of joints (glTF 2.0 §3.7.2.2, §3.7.3).

use super::Problem;
use super::accessor::Vectors;
use super::buffers::Buffers;
use super::document::{Document, item};
use super::json::{Primitive, Root, Target, at};
use super::nodes;
use glam::{DMat3, DMat4, DVec3};
use std::fmt;
use std::rc::Rc;

/// How a node poses its mesh: what besides the mesh its triangles depend on.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Pose {
    /// How far each morph target goes, as the bits of an f32; trailing ones of 0 are left out.
    weights: Vec<u32>,
    /// The skin's index.
    pub skin: Option<usize>,
}

impl Pose {
    /// The pose of the mesh that a node places.
    pub fn of(root: &Root, node: usize, mesh: usize) -> Result<Self, Problem> {
        let own = root.nodes.get(node).and_then(|node| node.weights.as_deref());
        let weights = own.or_else(|| Some(root.meshes.get(mesh)?.weights.as_slice()));
        let weights = weights.unwrap_or_default();
        if weights.iter().any(|w| !(*w as f32).is_finite()) {
            return Err(format!(
                "{}: the weights of its morph targets must be finite numbers",
                nodes::label(root, node)
            ));
        }
        let used = weights.iter().rposition(|w| *w != 0.0).map_or(0, |last| last + 1);
        let weights = weights.iter().take(used).map(|w| (*w as f32).to_bits()).collect();
        Ok(Self { weights, skin: root.nodes.get(node).and_then(|node| node.skin) })
    }

    /// Whether the mesh stands as its vertices say.
    pub fn is_at_rest(&self) -> bool {
        self.weights.is_empty() && self.skin.is_none()
    }
}

/// The part of a pose that a primitive's triangles depend on.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Posing {
    /// The morph targets that add something, each with how far it goes, as the bits of an f32.
    targets: Vec<(Target, u32)>,
    /// The accessors of joints and of weights, four of each a vertex, where there is a skin.
    influences: Vec<[usize; 2]>,
}

impl Posing {
    pub fn of(pose: &Pose, primitive: &Primitive) -> Self {
        let pairs = primitive.targets.iter().copied().zip(pose.weights.iter().copied());
        let targets = pairs.filter(|(_, weight)| f32::from_bits(*weight) != 0.0).collect();
        let of = &primitive.attributes;
        let sets = [of.joints_0.zip(of.weights_0), of.joints_1.zip(of.weights_1)];
        let sets = sets.into_iter().flatten().filter(|_| pose.skin.is_some());
        Self { targets, influences: sets.map(|(joints, weights)| [joints, weights]).collect() }
    }
}

/// The joints of a skin as they stand.
pub(super) struct Skin {
    /// The matrices from the mesh's space to the world, less the origin, joint by joint.
    joints: Vec<DMat4>,
    /// Where the first joint stands: positions are 32-bit floats around it.
    pub origin: DVec3,
}

impl Skin {
    /// `skins[index]`, where nodes stand as `worlds` says.
    pub fn read(
        (root, document): (&Root, &Document),
        buffers: &Buffers,
        worlds: &[DMat4],
        index: usize,
        owner: &dyn Fn() -> String,
    ) -> Result<Self, Problem> {
        let skin: gltf::json::Skin = item(&document.skins, index, "skins", owner)?;
        let name = || format!("skins[{index}]");
        let bind = match skin.inverse_bind_matrices {
            Some(accessor) => {
                let what = || format!("the inverseBindMatrices of {}", name());
                Some(Vectors::<16>::open(root, buffers, accessor.value(), false, &what)?)
            }
            None => None,
        };
        let mut joints = Vec::with_capacity(skin.joints.len());
        for (nth, joint) in skin.joints.iter().enumerate() {
            let world = at(worlds, joint.value(), "nodes", name)?;
            let bind = match bind.as_ref().map(|bind| bind.get(nth)) {
                None => DMat4::IDENTITY,
                Some(Some(bind)) => DMat4::from_cols_array(&bind.map(f64::from)),
                Some(None) => {
                    return Err(format!(
                        "{} has {} joints and fewer inverseBindMatrices",
                        name(),
                        skin.joints.len()
                    ));
                }
            };
            let matrix = *world * bind;
            if !matrix.is_finite() {
                return Err(format!("{}: the matrix of its joint {nth} is not finite", name()));
            }
            joints.push(matrix);
        }
        let first = skin.joints.first().and_then(|joint| worlds.get(joint.value()));
        let Some(origin) = first.map(|world| world.w_axis.truncate()) else {
            return Err(format!("{} has no joints", name()));
        };
        for matrix in &mut joints {
            matrix.w_axis -= origin.extend(0.0);
        }
        Ok(Self { joints, origin })
    }
}

/// A primitive's vertices as they are posed.
#[derive(Default)]
pub(super) struct Posed<'a> {
    /// How far each morph target goes, and what it adds to positions and normals.
    pub morphs: Vec<(f32, [Option<Vectors<'a, 3>>; 2])>,
    pub skin: Option<Rc<Skin>>,
    /// Up to two sets of four joints of each vertex, and their weights.
    pub influences: Vec<[Vectors<'a, 4>; 2]>,
}

impl<'a> Posed<'a> {
    /// Opens what poses a primitive of `vertices` vertices, which errors name by `label`.
    pub fn open(
        (root, buffers): (&'a Root, &'a Buffers<'a>),
        posing: &Posing,
        skin: Option<&Rc<Skin>>,
        vertices: usize,
        label: &dyn fmt::Display,
    ) -> Result<Self, Problem> {
        let owner = |what: &'static str| move || format!("the {what} of {label}");
        let added = |index: Option<usize>, what| {
            let open =
                |index| Vectors::open(root, buffers, index, root.is_quantized(), &owner(what));
            index.map(open).transpose()
        };
        let mut posed = Self { skin: skin.cloned(), ..Self::default() };
        for (target, weight) in &posing.targets {
            let of = [
                added(target.position, "morph target's POSITION")?,
                added(target.normal, "morph target's NORMAL")?,
            ];
            if of.iter().flatten().any(|of: &Vectors<3>| of.len() != vertices) {
                return Err(format!(
                    "{label} has a morph target for another number of vertices than its {vertices}"
                ));
            }
            posed.morphs.push((f32::from_bits(*weight), of));
        }
        for [joints, weights] in &posing.influences {
            let open = |index, what| Vectors::open(root, buffers, index, true, &owner(what));
            posed.influences.push([open(*joints, "JOINTS")?, open(*weights, "WEIGHTS")?]);
        }
        if posed.skin.is_some() && posed.influences.is_empty() {
            return Err(format!("{label} has a skin, and neither JOINTS_0 nor WEIGHTS_0 for it"));
        }
        Ok(posed)
    }

    /// A vertex's position.
    pub fn position(&self, vertex: usize, rest: [f32; 3]) -> Result<[f32; 3], Problem> {
        let morphed = self.morphed(vertex, rest, 0);
        let Some(skin) = &self.skin else { return Ok(morphed.as_vec3().to_array()) };
        Ok(self.blended(vertex, skin)?.transform_point3(morphed).as_vec3().to_array())
    }

    /// A vertex's normal, of any length.
    pub fn normal(&self, vertex: usize, rest: [f32; 3]) -> Result<[f32; 3], Problem> {
        let morphed = self.morphed(vertex, rest, 1);
        let Some(skin) = &self.skin else { return Ok(morphed.as_vec3().to_array()) };
        // The cofactors: the inverse's transpose, whatever the size.
        let m = DMat3::from_mat4(self.blended(vertex, skin)?);
        let cofactors = DMat3::from_cols(
            m.y_axis.cross(m.z_axis),
            m.z_axis.cross(m.x_axis),
            m.x_axis.cross(m.y_axis),
        );
        let sign = m.determinant().signum();
        let normal = (sign * (cofactors * morphed)).try_normalize().unwrap_or(DVec3::ZERO);
        Ok(normal.as_vec3().to_array())
    }

    fn morphed(&self, vertex: usize, rest: [f32; 3], which: usize) -> DVec3 {
        let wide = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
        self.morphs.iter().fold(wide(rest), |sum, (weight, added)| {
            let added = added.get(which).and_then(Option::as_ref).and_then(|of| of.get(vertex));
            sum + f64::from(*weight) * added.map_or(DVec3::ZERO, wide)
        })
    }

    /// The mean of the joints' matrices by the vertex's weights, which are made to add up to 1.
    fn blended(&self, vertex: usize, skin: &Skin) -> Result<DMat4, Problem> {
        let (mut sum, mut total) = (DMat4::ZERO, 0.0);
        let mut first = None;
        for [joints, weights] in &self.influences {
            let both = joints.get(vertex).zip(weights.get(vertex));
            let Some((joints, weights)) = both else {
                return Err(format!("its vertex {vertex} has no joints or no weights"));
            };
            for (joint, weight) in joints.into_iter().zip(weights) {
                if !(weight >= 0.0 && weight.is_finite()) {
                    return Err(format!(
                        "its vertex {vertex} has a weight of {weight}; weights are 0 or more"
                    ));
                }
                let whole = joint >= 0.0 && joint.fract() == 0.0;
                let Some(matrix) = skin.joints.get(joint as usize).filter(|_| whole) else {
                    return Err(format!(
                        "its vertex {vertex} hangs on joint {joint}, and the skin has {}",
                        skin.joints.len()
                    ));
                };
                first.get_or_insert(*matrix);
                sum += f64::from(weight) * *matrix;
                total += f64::from(weight);
            }
        }
        // Without any weight, a vertex hangs on its first joint.
        if total > 0.0 { Ok(sum * (1.0 / total)) } else { Ok(first.unwrap_or(DMat4::IDENTITY)) }
    }
}
