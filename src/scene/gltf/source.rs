//! A primitive's corners, read where they lie.

use super::Problem;
use super::accessor::{Indices, Vectors};
use super::emissive::Emission;
use super::json;
use super::placing::Placing;
use super::pose::Posed;
use super::surfaces::Cover;
use crate::error::quoted;
use crate::scene::Mesh;
use glam::DVec3;
use std::fmt;

/// The normal of a triangle without area, which no pixel shows.
const ANY_NORMAL: DVec3 = DVec3::Y;

/// The topology that makes triangles of a primitive's corners.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Topology {
    List,
    Strip,
    Fan,
}

impl Topology {
    /// The number of triangles that `corners` corners make.
    pub fn triangles(self, corners: usize) -> Result<usize, Problem> {
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

/// A primitive as a sentence names it: `mesh "bunny", primitive 2`, the latter where there are several.
#[derive(Clone, Copy)]
pub(super) struct Label<'a> {
    mesh: &'a json::Mesh,
    index: usize,
    primitive: usize,
}

impl<'a> Label<'a> {
    pub fn new(mesh: &'a json::Mesh, index: usize, primitive: usize) -> Self {
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
pub(super) struct Placed {
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

/// Where a texture lies on a primitive.
pub(super) struct Coordinates<'a> {
    pub vectors: Vectors<'a, 2>,
    pub placing: Placing,
}

impl Coordinates<'_> {
    /// A vertex's place in the texture; no number where it has none.
    pub fn get(&self, vertex: usize) -> [f32; 2] {
        self.vectors.get(vertex).map_or([f32::NAN; 2], |at| self.placing.place(at))
    }
}

/// A primitive's opened accessors.
pub(super) struct Source<'a> {
    pub double_sided: bool,
    pub cover: Cover,
    pub emission: Option<Box<Emission>>,
    pub topology: Topology,
    pub triangles: usize,
    pub positions: Vectors<'a, 3>,
    pub normals: Option<Vectors<'a, 3>>,
    pub posed: Posed<'a>,
    pub indices: Option<Indices<'a>>,
    /// Where its opacity map lies; `None` where it has none, or one that is the same everywhere.
    pub coordinates: Option<Box<Coordinates<'a>>>,
    pub label: Label<'a>,
}

impl Source<'_> {
    /// What primitives of one mesh of the scene have in common.
    pub fn kind(&self) -> (bool, Cover, Option<Emission>) {
        (self.double_sided, self.cover, self.emission.as_deref().copied())
    }

    pub fn corners(&self) -> usize {
        self.indices.as_ref().map_or(self.positions.len(), Indices::len)
    }

    /// The vertex of a corner, if there is such a one.
    pub fn vertex_of(&self, corner: usize) -> Option<usize> {
        let vertex = match &self.indices {
            Some(indices) => indices.get(corner)? as usize,
            None => corner,
        };
        (vertex < self.positions.len()).then_some(vertex)
    }

    /// The number of vertices that the primitive's triangles may share; 0 with flat normals, which differ from triangle
    /// to triangle.
    fn shared(&self) -> usize {
        if self.normals.is_some() { self.positions.len() } else { 0 }
    }

    pub fn most_vertices(&self) -> usize {
        let corners = 3 * self.triangles;
        if self.normals.is_some() { corners.min(self.shared()) } else { corners }
    }

    pub fn append_to(&self, mesh: &mut Mesh, placed: &mut Placed) -> Result<(), Problem> {
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
                if mesh.opacity_map.is_some() {
                    let place = self.coordinates.as_ref().map(|of| of.get(vertex as usize));
                    mesh.texture_coordinates.push(place.unwrap_or_default());
                }
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
