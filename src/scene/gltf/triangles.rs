//! Primitives made into plain indexed triangles.

use super::Problem;
use super::accessor::{Indices, Vectors};
use super::attributes::Attributes;
use super::buffers::Buffers;
use super::document::Document;
use super::emissive::Emission;
use super::json::{self, Root, at};
use super::placing::Placing;
use super::pose::{Pose, Posed, Posing, Skin};
use super::source::{Coordinates, Label, Placed, Source, Topology};
use super::surfaces::{Cover, Look, Surface, Surfaces};
use crate::scene::Mesh;
use std::rc::Rc;

/// The most triangles that a file's meshes may hold together, each mesh counted once: 3 GB at worst.
const MAX_TRIANGLES: usize = 1 << 25;

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
    cover: Cover,
    /// Where its opacity map lies, and the accessor of its texture coordinates.
    placing: Option<Box<(Placing, Option<usize>)>>,
    emission: Option<Box<Emission>>,
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
    /// How much light materials stop.
    pub surfaces: Surfaces<'a>,
}

impl<'a> Reader<'a> {
    /// A reader that reads what shines where it is to be lights.
    pub fn new(
        root: &'a Root,
        buffers: &'a Buffers<'a>,
        document: &'a Document<'a>,
        emissive: bool,
    ) -> Self {
        Self::with_limit(root, buffers, (document, emissive), MAX_TRIANGLES)
    }

    /// A reader that refuses what goes past `triangles` in all.
    pub fn with_limit(
        root: &'a Root,
        buffers: &'a Buffers<'a>,
        (document, emissive): (&'a Document<'a>, bool),
        triangles: usize,
    ) -> Self {
        let surfaces = Surfaces::new(document, buffers, emissive);
        Self { root, buffers, limit: triangles, made: 0, placed: Placed::default(), surfaces }
    }

    /// The shape of `meshes[index]` in a pose, which does not depend on its name.
    pub fn shape(&mut self, index: usize, pose: &Pose) -> Result<Shape, Problem> {
        let mesh = at(&self.root.meshes, index, "meshes", || "a node".into())?;
        let shape = |(i, primitive): (usize, &json::Primitive)| {
            let label = Label::new(mesh, index, i);
            let attributes = &primitive.attributes;
            let look = match primitive.material {
                Some(material) => self.look(material, attributes, &label)?,
                None => Look::default(),
            };
            let placing = |of: Placing| Box::new((of, attributes.coordinates(of.set)));
            Ok(PrimitiveShape {
                mode: primitive.mode.unwrap_or(4),
                position: attributes.position,
                normal: attributes.normal,
                indices: primitive.indices,
                double_sided: look.double_sided,
                cover: look.surface.cover,
                placing: look.surface.placing.map(placing),
                emission: look.emission.map(Box::new),
                posing: Posing::of(pose, primitive),
            })
        };
        let primitives: Result<_, Problem> =
            mesh.primitives.iter().enumerate().map(shape).collect();
        Ok(Shape { primitives: primitives?, skin: pose.skin })
    }

    /// The look of a primitive that has `materials[material]`.
    fn look(
        &mut self,
        material: usize,
        attributes: &Attributes,
        label: &Label,
    ) -> Result<Look, Problem> {
        let look = self.surfaces.of(material, || label.to_string())?;
        let color = attributes.color.and_then(|color| self.root.accessors.get(color));
        if !(look.fades && color.is_some_and(|color| color.kind == "VEC4")) {
            return Ok(look);
        }
        let notes = &mut self.surfaces.notes;
        notes.tell(format!("{label} has an alpha in its COLOR_0, which is passed over"));
        let is_whole = look.surface == Surface::WHOLE;
        let surface = if is_whole { Surface::UNKNOWN } else { look.surface };
        Ok(Look { surface, ..look })
    }

    /// The triangles of `meshes[index]`, which looks like this: what is single-sided, then what is
    /// double-sided, and of each what stops all light, then what stops less; with what each shines with.
    /// `skin` is that of its pose.
    pub fn read(
        &mut self,
        index: usize,
        shape: &Shape,
        skin: Option<&Rc<Skin>>,
    ) -> Result<Vec<(Mesh, Option<Emission>)>, Problem> {
        let mesh = at(&self.root.meshes, index, "meshes", || "a node".into())?;
        let mut sources = Vec::new();
        for (i, primitive) in shape.primitives.iter().enumerate() {
            sources.extend(self.open(primitive, skin, Label::new(mesh, index, i))?);
        }
        sources.sort_by_key(Source::kind);
        let mut parts = Vec::new();
        for alike in sources.chunk_by(|a, b| a.kind() == b.kind()) {
            let Some((double_sided, cover, emission)) = alike.first().map(Source::kind) else {
                continue;
            };
            let opacity_map = match cover {
                Cover::Map(map) => Some(map),
                Cover::Whole | Cover::Unknown => None,
            };
            let mut mesh = Mesh {
                double_sided,
                cut_out: cover != Cover::Whole,
                opacity_map,
                ..Mesh::default()
            };
            mesh.indices.reserve_exact(alike.iter().map(|source| 3 * source.triangles).sum());
            let vertices = alike.iter().map(Source::most_vertices).sum();
            mesh.positions.reserve_exact(vertices);
            mesh.normals.reserve_exact(vertices);
            mesh.texture_coordinates.reserve_exact(opacity_map.map_or(0, |_| vertices));
            for source in alike {
                source.append_to(&mut mesh, &mut self.placed)?;
            }
            // Where primitives use a part of what they share.
            if mesh.positions.len() < vertices / 2 {
                mesh.positions.shrink_to_fit();
                mesh.normals.shrink_to_fit();
                mesh.texture_coordinates.shrink_to_fit();
            }
            if !mesh.indices.is_empty() {
                parts.push((mesh, emission));
            }
        }
        Ok(parts)
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
        let mut source = Source {
            double_sided: shape.double_sided,
            cover: shape.cover,
            emission: shape.emission.clone(),
            topology,
            triangles,
            positions,
            normals,
            posed,
            indices,
            coordinates: None,
            label,
        };
        if let Some((placing, accessor)) = shape.placing.as_deref() {
            match self.coordinates(*accessor, *placing, &source) {
                Ok(coordinates) => source.coordinates = Some(Box::new(coordinates)),
                Err(problem) => {
                    self.surfaces.notes.tell(format!(
                        "{label}: {problem}, so that where its texture cuts it is not known; it counts whole"
                    ));
                    source.cover = Cover::Unknown;
                }
            }
        }
        Ok(Some(source))
    }

    /// Where an opacity map lies on a primitive, each of whose corners has a place in it.
    fn coordinates(
        &self,
        accessor: Option<usize>,
        placing: Placing,
        of: &Source<'a>,
    ) -> Result<Coordinates<'a>, Problem> {
        let name = || format!("TEXCOORD_{}", placing.set);
        let accessor = accessor.ok_or_else(|| format!("it has no {}", name()))?;
        let vectors = Vectors::open(self.root, self.buffers, accessor, true, &name)?;
        let coordinates = Coordinates { vectors, placing };
        for corner in 0..of.corners() {
            let place = of.vertex_of(corner).map(|vertex| coordinates.get(vertex));
            if place.is_some_and(|place| !place.iter().all(|at| at.is_finite())) {
                return Err(format!("its {} has no finite number for corner {corner}", name()));
            }
        }
        Ok(coordinates)
    }
}
