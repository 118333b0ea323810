//! The blocking triangles of a scene, and a bounding volume hierarchy over them.
//!
//! The hierarchy's boxes are f32 and padded beyond their rounding; the triangles are f64. Both are
//! relative to the scene's centre, so a scene far from the world's origin loses nothing.

use crate::scene::{Instance, Scene};
use crate::{Error, Light, Shape};
use glam::{DVec2, DVec3};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::leaf_collapser::collapse;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

/// The relative error of one rounding to f32.
pub(super) const F32_ROUNDING: f64 = 1.0 / (1 << 24) as f64;

/// The error of a receiver's position, in roundings of the largest coordinate: a vertex
/// transform in f32 is three products and three sums, its interpolation over a triangle two more.
const POSITION_ROUNDINGS: f64 = 8.0;

/// Offset over position error. A normal that leans 75° from the geometric one (interpolated
/// normals do, on coarse meshes) still moves the point off its surface by a quarter.
const OFFSET_PER_ERROR: f64 = 4.0;

/// Padding of the boxes, in roundings of the scene's extent: the ray's origin, its direction and
/// the slab test take three, for rays up to five times as long as the scene.
pub(super) const PAD_ROUNDINGS: f64 = 16.0;

/// The largest coordinate, in metres, for which the areas of the hierarchy's f32 boxes do not overflow.
const LARGEST_COORDINATE: f64 = 1e18;

/// The blocking triangles of a scene, each in the form that its user wants.
pub(super) struct Blockers<T> {
    /// World space; everything below is relative to it.
    pub(super) origin: DVec3,
    /// The largest coordinate of any instance or light, relative to `origin`.
    pub(super) extent: f64,
    pub(super) triangles: Vec<T>,
    pub(super) tree: Option<Bvh2>,
}

impl Blockers<[DVec3; 3]> {
    /// Builds the hierarchy over triangles that block whole.
    ///
    /// # Errors
    /// See [`Self::new`]; [`Error::Scene`] too where an opacity map cuts a blocking mesh out.
    pub(super) fn whole(scene: &Scene) -> Result<Self, Error> {
        let cuts = |i: &&Instance| {
            let mesh = scene.meshes.get(i.mesh);
            i.role.blocks() && mesh.is_some_and(|mesh| mesh.opacity_map.is_some())
        };
        if let Some(instance) = scene.instances.iter().find(cuts) {
            return Err(Error::Scene(format!(
                "{}: a texture says where it stops light, which no closed form looks up; trace it by Tracer",
                instance.name
            )));
        }
        Self::new(scene, |corners, _| corners)
    }
}

impl<T> Blockers<T> {
    /// Builds the hierarchy over the instances that block light ([`crate::scene::Role::blocks`]).
    ///
    /// `form` makes a triangle of its corners, relative to the origin, and of what says where it stops light. Triangles
    /// without an area are left out.
    ///
    /// # Errors
    /// [`Error::Scene`] where an instance names a mesh or vertex that does not exist, or puts a
    /// vertex at a position that is not finite (or beyond 10¹⁸ m).
    pub(super) fn new(
        scene: &Scene,
        form: impl Fn([DVec3; 3], Option<Cut>) -> T,
    ) -> Result<Self, Error> {
        let (mut low, mut high) = (DVec3::MAX, DVec3::MIN);
        let mut include = |point: DVec3| (low, high) = (low.min(point), high.max(point));
        let mut corners = Vec::new();
        for instance in &scene.instances {
            let world = triangle_corners(scene, instance)?;
            world.iter().flat_map(|(corners, _)| corners).for_each(|&corner| include(corner));
            if instance.role.blocks() {
                corners.extend(world);
            }
        }
        for light in &scene.lights {
            light_corners(&light.light).into_iter().for_each(&mut include);
        }
        let (origin, extent) = if low.cmple(high).all() {
            ((low + high) / 2.0, ((high - low) / 2.0).max_element())
        } else {
            (DVec3::ZERO, 0.0)
        };
        corners.iter_mut().flat_map(|(c, _)| c).for_each(|corner| *corner -= origin);
        corners.retain(|([a, b, c], _)| (b - a).cross(c - a) != DVec3::ZERO);
        let pad = PAD_ROUNDINGS * F32_ROUNDING * extent;
        let boxes: Vec<Aabb> = corners.iter().map(|(corners, _)| bounds(corners, pad)).collect();
        let triangles = corners.into_iter().map(|(corners, cut)| form(corners, cut)).collect();
        Ok(Self { origin, extent, triangles, tree: build(&boxes) })
    }

    /// Calls `visit` with each triangle whose box meets the region.
    pub(super) fn for_each_in<const N: usize>(
        &self,
        region: &Region<N>,
        mut visit: impl FnMut(&T),
    ) {
        let Self { triangles, tree: Some(tree), .. } = self else { return };
        let mut stack = vec![0];
        while let Some(node) = stack.pop() {
            let node = &tree.nodes[node as usize];
            if region.misses(node.aabb()) {
                continue;
            }
            let first = node.first_index;
            if node.is_leaf() {
                let leaves = &tree.primitive_indices[first as usize..][..node.prim_count as usize];
                leaves.iter().for_each(|&i| visit(&triangles[i as usize]));
            } else {
                stack.extend([first, first + 1]);
            }
        }
    }

    /// The distance that a receiver is moved off its surface along its normal, in metres, where its position
    /// may be off by `position_error` beyond what f32 arithmetic on scene-sized coordinates
    /// explains; about 2 µm a metre of the scene's extent without.
    ///
    /// It is derived: four times the sum of that error and of the error that f32 gives a position
    /// whose coordinates are as large as the scene's.
    pub(super) fn offset(&self, light: DVec3, position: DVec3, position_error: f64) -> f64 {
        let largest = |world: DVec3| (world - self.origin).abs().max_element();
        let reach = self.extent.max(largest(position)).max(largest(light));
        OFFSET_PER_ERROR * (POSITION_ROUNDINGS * F32_ROUNDING * reach + position_error)
    }
}

/// The region of space inside all of a few planes.
pub(super) struct Region<const N: usize> {
    /// The common point of the planes, relative to the blockers' origin.
    pub(super) apex: DVec3,
    /// The planes, each as its inward normal and its distance from the apex.
    pub(super) planes: [(DVec3, f64); N],
}

impl<const N: usize> Region<N> {
    /// Whether the box is beyond one of the planes. Boxes are padded by far more than f64 rounds.
    fn misses(&self, bounds: &Aabb) -> bool {
        let (low, high) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let (center, half) = ((low + high) / 2.0 - self.apex, (high - low) / 2.0);
        let nearest = |&(normal, distance): &(DVec3, f64)| {
            normal.dot(center) + normal.abs().dot(half) + distance
        };
        self.planes.iter().any(|plane| nearest(plane) < 0.0)
    }
}

/// The corners of a box around a light, flat where the light is; none of a sun, which is nowhere.
fn light_corners(light: &Light) -> Vec<DVec3> {
    let thickness = match light.shape() {
        Shape::Sun { .. } => return Vec::new(),
        Shape::Sphere { radius } | Shape::Capsule { radius, .. } => radius,
        _ => 0.0,
    };
    let frame = light.rectangle().world_from_light();
    let [width, height] = light.rectangle().half_extents();
    let corner = |signs: [f64; 3]| {
        let from_center = DVec3::from_array(signs) * DVec3::new(width, height, thickness);
        light.center() + frame.transform_vector3(from_center)
    };
    let ends = [-1.0, 1.0];
    let signs = ends.into_iter().flat_map(|x| ends.into_iter().map(move |y| (x, y)));
    signs.flat_map(|(x, y)| ends.map(|z| corner([x, y, z]))).collect()
}

fn bounds([a, b, c]: &[DVec3; 3], pad: f64) -> Aabb {
    let (low, high) = (a.min(*b).min(*c) - pad, a.max(*b).max(*c) + pad);
    Aabb::new(low.as_vec3a(), high.as_vec3a())
}

/// Which opacity map says where a triangle stops light, and the places of its corners in the map.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cut {
    pub(super) map: usize,
    pub(super) places: [DVec2; 3],
}

/// A triangle's corners in world space, and what cuts it out.
type Placed = ([DVec3; 3], Option<Cut>);

/// An instance's triangles.
fn triangle_corners(scene: &Scene, instance: &Instance) -> Result<Vec<Placed>, Error> {
    let refuse = |problem: String| Error::Scene(format!("{}: {problem}", instance.name));
    let mesh = scene.meshes.get(instance.mesh).ok_or_else(|| {
        refuse(format!("mesh {} does not exist (there are {})", instance.mesh, scene.meshes.len()))
    })?;
    let corner = |&index: &u32| {
        let position = mesh.positions.get(index as usize).ok_or_else(|| {
            refuse(format!("index {index} is past its {} positions", mesh.positions.len()))
        })?;
        let mesh_space = DVec3::from_array(position.map(f64::from));
        let world = instance.world_from_mesh.transform_point3(mesh_space);
        // The largest element alone would pass over a NaN beside it.
        if world.is_finite() && world.abs().max_element() <= LARGEST_COORDINATE {
            Ok(world)
        } else {
            Err(refuse(format!(
                "vertex {index} must be within {LARGEST_COORDINATE:e} m (it is at {world})"
            )))
        }
    };
    if let Some(map) = mesh.opacity_map.filter(|&map| map >= scene.opacity_maps.len()) {
        let count = scene.opacity_maps.len();
        return Err(refuse(format!("opacity map {map} does not exist (there are {count})")));
    }
    let place = |&index: &u32| {
        let place = mesh.texture_coordinates.get(index as usize).ok_or_else(|| {
            let count = mesh.texture_coordinates.len();
            refuse(format!("index {index} is past its {count} texture coordinates"))
        })?;
        Ok::<_, Error>(DVec2::from_array(place.map(f64::from)))
    };
    let triangle = |corners: &[u32]| {
        let [a, b, c] = [0, 1, 2].map(|i| &corners[i]);
        let cut = match mesh.opacity_map {
            Some(map) => Some(Cut { map, places: [place(a)?, place(b)?, place(c)?] }),
            None => None,
        };
        Ok(([corner(a)?, corner(b)?, corner(c)?], cut))
    };
    mesh.indices.chunks_exact(3).map(triangle).collect()
}

/// A hierarchy over the boxes: obvhs's medium preset, without the validation that its own
/// `build_bvh2` runs (and panics in) where debug assertions are on.
fn build(boxes: &[Aabb]) -> Option<Bvh2> {
    if boxes.is_empty() {
        return None;
    }
    let mut tree = PlocBuilder::with_capacity(boxes.len()).build(
        PlocSearchDistance::Medium,
        boxes,
        (0..boxes.len() as u32).collect(),
        SortPrecision::U64,
        3,
    );
    let mut reinsertion = ReinsertionOptimizer::default();
    reinsertion.run(&mut tree, 0.05, None);
    collapse(&mut tree, 8, 3.0);
    reinsertion.run(&mut tree, 0.1, None);
    // Reinsertion can deepen the tree, and its traversal stack overwrites what does not fit.
    tree.max_depth = tree.max_depth.max(tree.depth(0) + 2);
    Some(tree)
}
