//! Bounding spheres of a frame's meshes, computed once for all of its lights, and the faults found on the way.

use crate::RectangleLight;
use crate::lent::{Geometry, MeshBounds, MeshInstance};
use ash::vk;
use glam::{DVec3, DVec4};

/// How many spheres are tested at once.
const BATCH: usize = 64;

/// The relative error that a sphere's coordinates may have: more than single precision rounds by.
const SLACK: f32 = 1e-6;

/// Spheres around the meshes' boxes, in world space, and the first mesh with each kind of fault.
///
/// Most meshes are out of most lights' reach. Single precision and an array for each coordinate let a light reject
/// such a mesh in about a nanosecond.
#[derive(Clone, Debug, Default)]
pub(crate) struct Boxes {
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
    radius: Vec<f32>,
    /// How many meshes block light and have triangles.
    pub blockers: usize,
    /// The first mesh whose transform or bounds are not finite.
    pub not_finite: Option<usize>,
    /// The first mesh whose transform or buffers are invalid, and why.
    pub unsound: Option<(usize, &'static str)>,
    /// The first mesh that blocks and does not receive.
    pub occluder_alone: Option<usize>,
    /// The first mesh that the host draws.
    pub host_drawn: Option<usize>,
    /// The first mesh that the host draws and that blocks light.
    pub host_drawn_blocker: Option<usize>,
}

impl Boxes {
    /// Computes the spheres of a frame's meshes and finds the faulty ones.
    pub fn place(&mut self, meshes: &[MeshInstance]) {
        let Self { x, y, z, radius, .. } = self;
        for of in [&mut *x, y, z, radius] {
            of.clear();
            of.reserve(meshes.len());
        }
        (self.not_finite, self.host_drawn, self.host_drawn_blocker) = (None, None, None);
        (self.blockers, self.unsound, self.occluder_alone) = (0, None, None);
        for (index, mesh) in meshes.iter().enumerate() {
            let blocks = mesh.role.blocks();
            if let Geometry::HostDrawn(_) = mesh.geometry {
                self.host_drawn.get_or_insert(index);
                if blocks {
                    self.host_drawn_blocker.get_or_insert(index);
                }
            }
            if self.unsound.is_none() {
                self.unsound = problem(mesh).map(|problem| (index, problem));
            }
            let there = has_triangles(mesh);
            self.blockers += usize::from(there && blocks);
            if there && blocks && !mesh.role.receives() {
                self.occluder_alone.get_or_insert(index);
            }
            let [center, half] = around(mesh);
            // Every number of the mesh enters one of these, so one that is not finite shows. Finite numbers may
            // overflow on the way; `is_finite` then looks at the mesh itself.
            let sound =
                center.is_finite() && half.is_finite() && mesh.world_from_mesh.row(3).is_finite();
            if !(sound || is_finite(mesh)) {
                self.not_finite.get_or_insert(index);
            }
            let center = center.as_vec3();
            let rounding = SLACK * (center.x.abs() + center.y.abs() + center.z.abs());
            self.x.push(center.x);
            self.y.push(center.y);
            self.z.push(center.z);
            // A mesh without triangles is near no light.
            let reach = half.length() as f32 * (1.0 + SLACK) + rounding;
            self.radius.push(if there { reach } else { f32::NEG_INFINITY });
        }
    }

    /// Writes the indices of the meshes that are at least partly in front of a light and within `reach`, in metres from
    /// its centre, into `places`.
    pub fn near(&self, light: &RectangleLight, reach: Option<f64>, places: &mut Vec<u32>) {
        places.clear();
        let center = light.center().as_vec3();
        let normal = light.emission().as_vec3();
        let rounding = SLACK * (center.x.abs() + center.y.abs() + center.z.abs());
        let reach = reach.map_or(f32::INFINITY, |r| r as f32 * (1.0 + SLACK)) + rounding;
        let mut kept = [false; BATCH];
        for start in (0..self.x.len()).step_by(BATCH) {
            let end = (start + BATCH).min(self.x.len());
            let (x, y) = (&self.x[start..end], &self.y[start..end]);
            let (z, radius) = (&self.z[start..end], &self.radius[start..end]);
            for ((((kept, x), y), z), radius) in kept.iter_mut().zip(x).zip(y).zip(z).zip(radius) {
                let [x, y, z] = [x - center.x, y - center.y, z - center.z];
                let before = normal.x * x + normal.y * y + normal.z * z;
                let slack = SLACK * (x.abs() + y.abs() + z.abs()) + rounding;
                let most = reach + radius;
                // Where a number overflows, every comparison is false and the mesh is kept.
                let behind = before + slack + radius < 0.0;
                let beyond = x * x + y * y + z * z > most * most || most < 0.0;
                *kept = !(behind | beyond);
            }
            let found = kept[..end - start].iter().enumerate().filter(|(_, kept)| **kept);
            places.extend(found.map(|(place, _)| (start + place) as u32));
        }
    }
}

/// The [`Boxes`] of the last list of meshes, which all lights that share the list use again.
#[derive(Clone, Debug, Default)]
pub(crate) struct MeshBoxes {
    boxes: Boxes,
    near: Vec<u32>,
    /// The list's address and length.
    list: Option<(usize, usize)>,
}

impl MeshBoxes {
    /// Forgets the list: another one may lie at its address in the next frame.
    pub fn forget(&mut self) {
        self.list = None;
    }

    /// The boxes of a list of meshes, and memory for [`Boxes::near`].
    pub fn of(&mut self, meshes: &[MeshInstance]) -> (&Boxes, &mut Vec<u32>) {
        let list = Some((meshes.as_ptr() as usize, meshes.len()));
        if self.list != list {
            self.boxes.place(meshes);
            self.list = list;
        }
        (&self.boxes, &mut self.near)
    }
}

/// Whether every number of a mesh is finite.
fn is_finite(mesh: &MeshInstance) -> bool {
    let bounds = mesh.bounds.as_flattened();
    mesh.world_from_mesh.is_finite() && bounds.iter().all(|x| x.is_finite())
}

/// How far the last row of a transform may be from 0, 0, 0, 1, for the rounding of hosts.
const PROJECTIVE: f64 = 1e-6;

/// Why a mesh's transform or buffers are invalid; `None` for a valid mesh.
fn problem(mesh: &MeshInstance) -> Option<&'static str> {
    let last = mesh.world_from_mesh.row(3) - DVec4::W;
    // `Boxes::not_finite` reports numbers that are not finite; those compare false here.
    if last.abs().max_element() > PROJECTIVE {
        return Some("its transform must end in the row 0, 0, 0, 1; is it transposed?");
    }
    if has_triangles(mesh)
        && let Some(problem) = swapped(&mesh.bounds)
    {
        return Some(problem);
    }
    let Geometry::Buffers(buffers) = &mesh.geometry else { return None };
    if buffers.count == 0 {
        return None;
    }
    let no_buffer = |buffer: vk::Buffer| buffer == vk::Buffer::null();
    if no_buffer(buffers.positions) || buffers.indices.is_some_and(|(buffer, ..)| no_buffer(buffer))
    {
        return Some("its buffer of positions or of indices is a null handle");
    }
    if !buffers.count.is_multiple_of(3) {
        return Some(
            "its count of indices or vertices must be a multiple of 3: it is a list of triangles",
        );
    }
    if !buffers.positions_offset.is_multiple_of(4) {
        return Some("its positions must begin at a multiple of 4 bytes, as floats do");
    }
    let (_, offset, kind) = buffers.indices?;
    let bytes = match kind {
        vk::IndexType::UINT16 => 2,
        vk::IndexType::UINT32 => 4,
        // Needs an extension, which the host has enabled if it uses the type.
        vk::IndexType::UINT8_KHR => 1,
        _ => return Some("its indices must be of 16 or 32 bits"),
    };
    (!offset.is_multiple_of(bytes)).then_some("its indices must begin at a multiple of their size")
}

/// The problem of a box whose least corner lies above its largest. Numbers that are not finite are refused elsewhere.
fn swapped([least, largest]: &MeshBounds) -> Option<&'static str> {
    let axis = (0..3).find(|&i| least[i] > largest[i])?;
    Some(
        [
            "its bounds have min above max in x; give [least, largest] corners",
            "its bounds have min above max in y; give [least, largest] corners",
            "its bounds have min above max in z; give [least, largest] corners",
        ][axis],
    )
}

/// The centre of a mesh's bounding box in world space, and half the box's extents along the world's axes.
pub(super) fn around(mesh: &MeshInstance) -> [DVec3; 2] {
    let [low, high] = mesh.bounds.map(|p| DVec3::from_array(p.map(f64::from)));
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let m = &mesh.world_from_mesh;
    let axis = |i: usize, half: f64| (m.col(i).truncate() * half).abs();
    [m.transform_point3(middle), axis(0, half.x) + axis(1, half.y) + axis(2, half.z)]
}

/// Whether a mesh has at least one triangle, as far as is known.
pub(super) fn has_triangles(mesh: &MeshInstance) -> bool {
    match mesh.geometry {
        Geometry::Buffers(buffers) => buffers.count >= 3,
        Geometry::HostDrawn(_) => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Role;
    use glam::DMat4;

    fn cube(at: DVec3) -> MeshInstance {
        let unit = [[-0.5; 3], [0.5; 3]];
        MeshInstance::new(Geometry::HostDrawn(0), DMat4::from_translation(at), unit, Role::Both)
    }

    fn near(meshes: &[MeshInstance], reach: Option<f64>) -> Vec<u32> {
        let light = RectangleLight::new(DVec3::ZERO, DVec3::X, DVec3::Y).unwrap();
        let (mut boxes, mut places) = (Boxes::default(), vec![7]);
        boxes.place(meshes);
        boxes.near(&light, reach, &mut places);
        places
    }

    #[test]
    fn meshes_behind_or_out_of_reach_are_left_out() {
        let to = RectangleLight::new(DVec3::ZERO, DVec3::X, DVec3::Y).unwrap().emission();
        let meshes = [2.0, -2.0, 0.0, 9.0, -0.8].map(|d| cube(to * d));
        assert_eq!(near(&meshes, None), [0, 2, 3, 4]);
        assert_eq!(near(&meshes, Some(5.0)), [0, 2, 4]);
        // More than a batch.
        let many: Vec<_> = (0..200).map(|i| cube(to * f64::from(i % 10 - 3))).collect();
        assert_eq!(near(&many, None).len(), 160 - 20, "those at −3 m and −2 m lie behind");
    }

    #[test]
    fn numbers_that_single_precision_does_not_hold_are_kept() {
        let huge = MeshInstance { bounds: [[-3e38; 3], [3e38; 3]], ..cube(DVec3::ZERO) };
        let far = cube(DVec3::splat(1e300));
        assert_eq!(near(&[huge, far], None).len(), 2);
        let bad = MeshInstance { bounds: [[f32::NAN; 3]; 2], ..huge };
        let mut boxes = Boxes::default();
        boxes.place(&[huge, far, bad]);
        assert_eq!(boxes.not_finite, Some(2));
    }
}
