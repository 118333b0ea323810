//! Primitives made into plain indexed triangles.

use super::Problem;
use super::accessor::{Indices, Vectors};
use super::buffers::Buffers;
use super::json::{self, Root, at};
use super::pose::{Pose, Posed, Posing, Skin};
use crate::error::quoted;
use crate::scene::Mesh;
use glam::DVec3;
use std::fmt;
use std::rc::Rc;

/// The most triangles that a file's meshes may hold together, each mesh counted once: 3 GB at worst.
const MAX_TRIANGLES: usize = 1 << 25;

/// The normal of a triangle without area, which no pixel shows.
const ANY_NORMAL: DVec3 = DVec3::Y;

/// The topology that makes triangles of a primitive's corners.
#[derive(Clone, Copy, PartialEq)]
enum Topology {
    List,
    Strip,
    Fan,
}

impl Topology {
    /// The number of triangles that `corners` corners make.
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

/// The members of a mesh that its triangles depend on: meshes that differ in names and colors alone have one shape.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Shape {
    primitives: Vec<PrimitiveShape>,
    skin: Option<usize>,
}

#[derive(Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct PrimitiveShape {
    mode: u64,
    position: Option<usize>,
    normal: Option<usize>,
    indices: Option<usize>,
    double_sided: bool,
    cut_out: bool,
    posing: Posing,
}

/// Reads meshes, within limits for all of them.
///
/// Primitives may share accessors, so that no part of the file bounds what they make together. Without
/// sharing, a triangle takes a byte at least: that of its index in a strip. So that is what all are held
/// to, a triangle for each byte of the file and its buffers; real triangles take some twenty bytes, and
/// may be shared as often.
pub(super) struct Reader<'a> {
    root: &'a Root,
    buffers: &'a Buffers<'a>,
    limit: usize,
    made: usize,
    placed: Placed,
}

impl<'a> Reader<'a> {
    pub fn new(root: &'a Root, buffers: &'a Buffers<'a>) -> Self {
        Self::with_limit(root, buffers, MAX_TRIANGLES)
    }

    /// A reader that refuses what goes past `triangles` in all.
    pub fn with_limit(root: &'a Root, buffers: &'a Buffers<'a>, triangles: usize) -> Self {
        Self { root, buffers, limit: triangles, made: 0, placed: Placed::default() }
    }

    /// The shape of `meshes[index]` in a pose, which does not depend on its name.
    pub fn shape(&self, index: usize, pose: &Pose) -> Result<Shape, Problem> {
        let mesh = at(&self.root.meshes, index, "meshes", || "a node".into())?;
        let shape = |(i, primitive): (usize, &json::Primitive)| {
            let material = match primitive.material {
                Some(m) => {
                    let owner = || Label::new(mesh, index, i).to_string();
                    Some(at(&self.root.materials, m, "materials", owner)?)
                }
                None => None,
            };
            Ok(PrimitiveShape {
                mode: primitive.mode.unwrap_or(4),
                position: primitive.attributes.position,
                normal: primitive.attributes.normal,
                indices: primitive.indices,
                double_sided: material.is_some_and(|m| m.double_sided),
                cut_out: material.is_some_and(json::Material::cuts),
                posing: Posing::of(pose, primitive),
            })
        };
        let primitives: Result<_, Problem> =
            mesh.primitives.iter().enumerate().map(shape).collect();
        Ok(Shape { primitives: primitives?, skin: pose.skin })
    }

    /// The triangles of `meshes[index]`, which looks like this: what is single-sided, then what is
    /// double-sided, either of which may be missing.
    /// `skin` is that of its pose.
    pub fn read(
        &mut self,
        index: usize,
        shape: &Shape,
        skin: Option<&Rc<Skin>>,
    ) -> Result<Vec<Mesh>, Problem> {
        let mesh = at(&self.root.meshes, index, "meshes", || "a node".into())?;
        let mut sources = Vec::new();
        for (i, primitive) in shape.primitives.iter().enumerate() {
            sources.extend(self.open(primitive, skin, Label::new(mesh, index, i))?);
        }
        let mut sides = Vec::new();
        for double_sided in [false, true] {
            let side = || sources.iter().filter(|s| s.double_sided == double_sided);
            let mut mesh = Mesh {
                double_sided,
                cut_out: side().any(|source| source.cut_out),
                ..Mesh::default()
            };
            mesh.indices.reserve_exact(side().map(|source| 3 * source.triangles).sum());
            let vertices = side().map(Source::most_vertices).sum();
            mesh.positions.reserve_exact(vertices);
            mesh.normals.reserve_exact(vertices);
            for source in side() {
                source.append_to(&mut mesh, &mut self.placed)?;
            }
            // Where primitives use a part of what they share.
            if mesh.positions.len() < vertices / 2 {
                mesh.positions.shrink_to_fit();
                mesh.normals.shrink_to_fit();
            }
            if !mesh.indices.is_empty() {
                sides.push(mesh);
            }
        }
        Ok(sides)
    }

    /// Opens a primitive's accessors; `None` where it draws no triangles.
    fn open(
        &mut self,
        shape: &PrimitiveShape,
        skin: Option<&Rc<Skin>>,
        label: Label<'a>,
    ) -> Result<Option<Source<'a>>, Problem> {
        let topology = match shape.mode {
            // Points and lines.
            0..=3 => return Ok(None),
            4 => Topology::List,
            5 => Topology::Strip,
            6 => Topology::Fan,
            mode => return Err(format!("{label}: its mode is {mode}; glTF has 0 to 6")),
        };
        // Without positions there is nothing to draw (glTF 2.0 §3.7.2.1).
        let Some(position) = shape.position else { return Ok(None) };
        let owner = |what: &'static str| move || format!("the {what} of {label}");
        let integers = self.root.is_quantized();
        let open =
            |index, what| Vectors::open(self.root, self.buffers, index, integers, &owner(what));
        let positions = open(position, "POSITION")?;
        let normals = shape.normal.map(|n| open(n, "NORMAL")).transpose()?;
        if let Some(normals) = normals.as_ref().filter(|n| n.len() != positions.len()) {
            return Err(format!(
                "{label} has {} normals for {} positions; it must have as many",
                normals.len(),
                positions.len()
            ));
        }
        let indices = match shape.indices {
            Some(i) => Some(Indices::open(self.root, self.buffers, i, &owner("indices"))?),
            None => None,
        };
        let corners = indices.as_ref().map_or(positions.len(), Indices::len);
        let triangles = topology.triangles(corners).map_err(|e| format!("{label}: {e}"))?;
        let read = (self.root, self.buffers);
        let posed = Posed::open(read, &shape.posing, skin, positions.len(), &label)?;
        // What a target adds is read for each corner.
        let work = triangles.saturating_mul(1 + posed.morphs.len());
        self.made = self.made.saturating_add(work);
        if self.made > self.limit {
            return Err(format!(
                "{label}: its triangles exceed the number that a scene may hold, {}",
                self.limit
            ));
        }
        let bytes = self.buffers.held();
        if self.made as u64 > bytes {
            return Err(format!(
                "{label}: with it the meshes have {} triangles from {bytes} bytes of file and buffers, \
                 which is more than one a byte; fewer primitives must share their accessors",
                self.made
            ));
        }
        Ok(Some(Source {
            double_sided: shape.double_sided,
            cut_out: shape.cut_out,
            topology,
            triangles,
            positions,
            normals,
            posed,
            indices,
            label,
        }))
    }
}

/// A primitive as a sentence names it: `mesh "bunny", primitive 2`, the latter where there are several.
#[derive(Clone, Copy)]
struct Label<'a> {
    mesh: &'a json::Mesh,
    index: usize,
    primitive: usize,
}

impl<'a> Label<'a> {
    fn new(mesh: &'a json::Mesh, index: usize, primitive: usize) -> Self {
        Self { mesh, index, primitive }
    }
}

impl fmt::Display for Label<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.mesh.name.as_deref() {
            Some(name) if !name.is_empty() => write!(f, "mesh {}", quoted(name)),
            _ => write!(f, "mesh {}", self.index),
        }?;
        match self.mesh.primitives.len() {
            1 => Ok(()),
            _ => write!(f, ", primitive {}", self.primitive),
        }
    }
}

/// The places of a primitive's vertices in its mesh. One table serves all primitives and is never cleared, so that a
/// primitive's time depends on its corners alone, however many vertices it shares with others.
struct Placed {
    /// The number of a vertex that was placed, or 0. Numbers rise from primitive to primitive, so that
    /// those of earlier ones are too low to be mistaken for the present one's.
    numbers: Vec<u32>,
    next: u32,
}

impl Default for Placed {
    fn default() -> Self {
        Self { numbers: Vec::new(), next: 1 }
    }
}

/// A primitive's opened accessors.
struct Source<'a> {
    double_sided: bool,
    cut_out: bool,
    topology: Topology,
    triangles: usize,
    positions: Vectors<'a, 3>,
    normals: Option<Vectors<'a, 3>>,
    posed: Posed<'a>,
    indices: Option<Indices<'a>>,
    label: Label<'a>,
}

impl Source<'_> {
    /// The number of vertices that the primitive's triangles may share; 0 with flat normals, which differ from triangle
    /// to triangle.
    fn shared(&self) -> usize {
        if self.normals.is_some() { self.positions.len() } else { 0 }
    }

    fn most_vertices(&self) -> usize {
        let corners = 3 * self.triangles;
        if self.normals.is_some() { corners.min(self.shared()) } else { corners }
    }

    fn append_to(&self, mesh: &mut Mesh, placed: &mut Placed) -> Result<(), Problem> {
        // Primitives often share one accessor of which each uses a part, so only what is used is copied.
        if placed.numbers.len() < self.shared() {
            placed.numbers.resize(self.shared(), 0);
        }
        let shared = placed.numbers.get_mut(..self.shared()).unwrap_or_default();
        // Both below 3 · MAX_TRIANGLES.
        let (first, before) = (placed.next, mesh.positions.len() as u32);
        for t in 0..self.triangles {
            let mut vertices = [0; 3];
            let mut points = [[0.0; 3]; 3];
            for (k, corner) in self.topology.corners(t).into_iter().enumerate() {
                (vertices[k], points[k]) = self.vertex(corner)?;
            }
            let flat = face_normal(points);
            for (vertex, point) in vertices.into_iter().zip(points) {
                let known = shared.get_mut(vertex as usize);
                if let Some(number) = known.as_deref().filter(|number| **number >= first) {
                    mesh.indices.push(before + (number - first));
                    continue;
                }
                if let Some(number) = known {
                    *number = placed.next;
                }
                mesh.indices.push(before + (placed.next - first));
                placed.next += 1;
                mesh.positions.push(point);
                mesh.normals.push(self.normal(vertex, flat)?);
            }
        }
        Ok(())
    }

    /// The index and the position of a corner's vertex.
    fn vertex(&self, corner: usize) -> Result<(u32, [f32; 3]), Problem> {
        let vertex = match &self.indices {
            Some(indices) => indices.get(corner),
            None => u32::try_from(corner).ok(),
        };
        let point = vertex.and_then(|v| Some((v, self.positions.get(v as usize)?)));
        let Some((vertex, point)) = point else {
            return Err(format!(
                "{}: its corner {corner} is vertex {}, and it has {} positions",
                self.label,
                vertex.unwrap_or(u32::MAX),
                self.positions.len()
            ));
        };
        let point = self.posed.position(vertex as usize, point);
        let point = point.map_err(|e| format!("{}: {e}", self.label))?;
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
    fn normal(&self, vertex: u32, flat: DVec3) -> Result<[f32; 3], Problem> {
        let given = self.normals.as_ref().and_then(|normals| normals.get(vertex as usize));
        let posed = given.map(|normal| self.posed.normal(vertex as usize, normal)).transpose();
        let posed = posed.map_err(|e| format!("{}: {e}", self.label))?;
        Ok(posed
            .and_then(|n| DVec3::from_array(n.map(f64::from)).try_normalize())
            .unwrap_or(flat)
            .as_vec3()
            .to_array())
    }
}

/// The unit normal on the side from which the corners are counter-clockwise.
fn face_normal(points: [[f32; 3]; 3]) -> DVec3 {
    let [a, b, c] = points.map(|p| DVec3::from_array(p.map(f64::from)));
    (b - a).cross(c - a).try_normalize().unwrap_or(ANY_NORMAL)
}
