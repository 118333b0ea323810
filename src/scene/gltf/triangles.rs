//! Primitives made into plain indexed triangles.

use super::accessor::{Indices, Vectors};
use super::buffers::Buffers;
use super::json::{self, Root, at};
use super::{Problem, quoted};
use crate::scene::Mesh;
use glam::DVec3;

/// The most triangles that a file's meshes may hold together, each mesh counted once: 3 GB at worst.
/// Primitives may share accessors, so the file's size bounds nothing.
const MAX_TRIANGLES: usize = 1 << 25;

/// The normal of a triangle without area, which no pixel shows.
const ANY_NORMAL: DVec3 = DVec3::Y;

/// How a primitive's corners make triangles.
#[derive(Clone, Copy, PartialEq)]
enum Topology {
    List,
    Strip,
    Fan,
}

impl Topology {
    /// How many triangles `corners` make.
    fn triangles(self, corners: usize) -> Result<usize, Problem> {
        match self {
            Self::List if !corners.is_multiple_of(3) => {
                Err(format!("it has {corners} corners; a list of triangles has a multiple of 3"))
            }
            Self::List => Ok(corners / 3),
            Self::Strip | Self::Fan if corners < 3 => {
                Err(format!("it has {corners} corners; a strip or fan of triangles has 3 or more"))
            }
            Self::Strip | Self::Fan => Ok(corners - 2),
        }
    }

    /// The corners of triangle `t` (glTF 2.0 §3.7.2.1).
    fn corners(self, t: usize) -> [usize; 3] {
        match self {
            Self::List => [3 * t, 3 * t + 1, 3 * t + 2],
            Self::Strip => [t, t + 1 + t % 2, t + 2 - t % 2],
            Self::Fan => [t + 1, t + 2, 0],
        }
    }
}

/// Reads meshes, within one limit for all of them.
pub(super) struct Reader<'a> {
    root: &'a Root,
    buffers: &'a Buffers<'a>,
    triangles_left: usize,
}

impl<'a> Reader<'a> {
    pub fn new(root: &'a Root, buffers: &'a Buffers<'a>) -> Self {
        Self::with_limit(root, buffers, MAX_TRIANGLES)
    }

    /// A reader that refuses what goes past `triangles` in all.
    pub fn with_limit(root: &'a Root, buffers: &'a Buffers<'a>, triangles: usize) -> Self {
        Self { root, buffers, triangles_left: triangles }
    }

    /// The triangles of `meshes[index]`: what is single-sided, then what is double-sided, either of
    /// which may be missing.
    pub fn read(&mut self, index: usize) -> Result<Vec<Mesh>, Problem> {
        let mesh = at(&self.root.meshes, index, "meshes", || "a node".into())?;
        let label = match mesh.name.as_deref() {
            Some(name) if !name.is_empty() => format!("mesh {}", quoted(name)),
            _ => format!("mesh {index}"),
        };
        let mut sides = [false, true].map(|double_sided| Mesh { double_sided, ..Mesh::default() });
        for (i, primitive) in mesh.primitives.iter().enumerate() {
            let label = if mesh.primitives.len() == 1 {
                label.clone()
            } else {
                format!("{label}, primitive {i}")
            };
            self.primitive(primitive, &label, &mut sides)?;
        }
        Ok(sides.into_iter().filter(|mesh| !mesh.indices.is_empty()).collect())
    }

    fn primitive(
        &mut self,
        primitive: &json::Primitive,
        label: &str,
        sides: &mut [Mesh; 2],
    ) -> Result<(), Problem> {
        let topology = match primitive.mode.unwrap_or(4) {
            // Points and lines.
            0..=3 => return Ok(()),
            4 => Topology::List,
            5 => Topology::Strip,
            6 => Topology::Fan,
            mode => return Err(format!("{label}: its mode is {mode}; glTF has 0 to 6")),
        };
        // Without positions there is nothing to draw (glTF 2.0 §3.7.2.1).
        let Some(position) = primitive.attributes.position else { return Ok(()) };
        let (double_sided, cut_out) = match primitive.material {
            Some(m) => {
                let material = at(&self.root.materials, m, "materials", || label.into())?;
                (material.double_sided, material.cuts())
            }
            None => (false, false),
        };
        let owner = |what: &'static str| move || format!("the {what} of {label}");
        let positions = Vectors::open(self.root, self.buffers, position, &owner("POSITION"))?;
        let normals = match primitive.attributes.normal {
            Some(n) => Some(Vectors::open(self.root, self.buffers, n, &owner("NORMAL"))?),
            None => None,
        };
        if let Some(normals) = normals.as_ref().filter(|n| n.len() != positions.len()) {
            return Err(format!(
                "{label} has {} normals for {} positions; it must have as many",
                normals.len(),
                positions.len()
            ));
        }
        let indices = match primitive.indices {
            Some(i) => Some(Indices::open(self.root, self.buffers, i, &owner("indices"))?),
            None => None,
        };
        let corners = indices.as_ref().map_or(positions.len(), Indices::len);
        let triangles = topology.triangles(corners).map_err(|e| format!("{label}: {e}"))?;
        self.triangles_left = self.triangles_left.checked_sub(triangles).ok_or_else(|| {
            format!(
                "{label}: its triangles exceed the number that a scene may hold, {MAX_TRIANGLES}"
            )
        })?;
        let [single, double] = sides;
        let mesh = if double_sided { double } else { single };
        mesh.cut_out |= cut_out;
        Source { topology, positions, normals, indices, label }.append_to(mesh, triangles)
    }
}

/// A primitive's opened accessors.
struct Source<'a> {
    topology: Topology,
    positions: Vectors<'a>,
    normals: Option<Vectors<'a>>,
    indices: Option<Indices<'a>>,
    label: &'a str,
}

impl Source<'_> {
    fn append_to(&self, mesh: &mut Mesh, triangles: usize) -> Result<(), Problem> {
        mesh.indices.reserve(3 * triangles);
        // Where each vertex went. Primitives often share one accessor of which each uses a part, so
        // only what is used is copied.
        let shared = if self.normals.is_some() { self.positions.len() } else { 0 };
        let mut placed: Vec<Option<u32>> = vec![None; shared];
        for t in 0..triangles {
            let mut vertices = [0; 3];
            let mut points = [[0.0; 3]; 3];
            for (k, corner) in self.topology.corners(t).into_iter().enumerate() {
                (vertices[k], points[k]) = self.vertex(corner)?;
            }
            let flat = face_normal(points);
            for (vertex, point) in vertices.into_iter().zip(points) {
                // Flat normals differ from triangle to triangle, so nothing is shared then.
                let slot = placed.get_mut(vertex as usize);
                if let Some(Some(index)) = slot {
                    mesh.indices.push(*index);
                    continue;
                }
                // Below 3 · MAX_TRIANGLES.
                let index = mesh.positions.len() as u32;
                if let Some(slot) = slot {
                    *slot = Some(index);
                }
                mesh.positions.push(point);
                mesh.normals.push(self.normal(vertex, flat));
                mesh.indices.push(index);
            }
        }
        Ok(())
    }

    /// Which vertex a corner is, and where.
    fn vertex(&self, corner: usize) -> Result<(u32, [f32; 3]), Problem> {
        let vertex = match &self.indices {
            Some(indices) => indices.get(corner),
            None => u32::try_from(corner).ok(),
        };
        let point = vertex.and_then(|v| Some((v, self.positions.get(v)?)));
        let Some((vertex, point)) = point else {
            return Err(format!(
                "{}: its corner {corner} is vertex {}, and it has {} positions",
                self.label,
                vertex.unwrap_or(u32::MAX),
                self.positions.len()
            ));
        };
        if point.iter().all(|c| c.is_finite()) {
            Ok((vertex, point))
        } else {
            Err(format!(
                "{}: its position {vertex} is {point:?}; positions must be finite numbers",
                self.label
            ))
        }
    }

    /// The vertex's unit normal; its triangle's where the file has none, or one without direction.
    fn normal(&self, vertex: u32, flat: DVec3) -> [f32; 3] {
        let given = self.normals.as_ref().and_then(|normals| normals.get(vertex));
        given
            .and_then(|n| DVec3::from_array(n.map(f64::from)).try_normalize())
            .unwrap_or(flat)
            .as_vec3()
            .to_array()
    }
}

/// The unit normal on the side from which the corners are counter-clockwise.
fn face_normal(points: [[f32; 3]; 3]) -> DVec3 {
    let [a, b, c] = points.map(|p| DVec3::from_array(p.map(f64::from)));
    (b - a).cross(c - a).try_normalize().unwrap_or(ANY_NORMAL)
}
