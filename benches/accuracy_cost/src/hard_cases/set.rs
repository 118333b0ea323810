//! What a hard case is made of: blocks, floors, a light and the pixels that look on, in f64.

use antumbra::RectangleLight;
use antumbra::scene::{Mesh, Role, Scene, generate};
use antumbra_harness::View;
use glam::{DMat4, DVec3};

/// The shape of something that blocks light.
#[derive(Clone, Debug)]
pub enum Shape {
    /// A double-sided rectangle in the plane y = 0, width along x and depth along z, m.
    Card([f64; 2]),
    /// A closed box of this size, m.
    Box(DVec3),
    /// Any mesh that blocks what another shape does, or nothing.
    Like(Mesh, Option<Box<Shape>>),
}

impl Shape {
    fn mesh(&self) -> Mesh {
        match self {
            Self::Card([width, depth]) => {
                Mesh { double_sided: true, ..generate::quad(*width, *depth) }
            }
            Self::Box(size) => generate::cuboid(*size),
            Self::Like(mesh, _) => mesh.clone(),
        }
    }

    /// What it blocks with its outline moved out by this much, m; in, where it is negative.
    fn grown(&self, by: f64) -> Option<Self> {
        match self {
            Self::Card(sides) => {
                let sides = sides.map(|side| side + 2.0 * by);
                (sides[0] > 0.0 && sides[1] > 0.0).then_some(Self::Card(sides))
            }
            Self::Box(size) => {
                let size = size + 2.0 * by;
                (size.min_element() > 0.0).then_some(Self::Box(size))
            }
            Self::Like(_, shape) => shape.as_ref()?.grown(by),
        }
    }

    /// Whether it is flat, in its plane y = 0.
    pub fn is_flat(&self) -> bool {
        match self {
            Self::Card(_) => true,
            Self::Box(_) => false,
            Self::Like(_, shape) => shape.as_ref().is_none_or(|shape| shape.is_flat()),
        }
    }
}

/// A shape at its place.
#[derive(Clone, Debug)]
pub struct Block {
    pub shape: Shape,
    /// Shape to world; rigid.
    pub at: DMat4,
    pub role: Role,
}

impl Block {
    /// Whether it is flat and lies as lights do that face down.
    pub fn faces_light(&self) -> bool {
        self.shape.is_flat() && self.at.transform_vector3(DVec3::Y).abs() == DVec3::Y
    }

    /// How far its furthest corner is from a light's plane, m.
    pub fn furthest(&self, light_from_world: &DMat4) -> f64 {
        let mesh = self.shape.mesh();
        let corners = mesh.positions.iter().map(|p| DVec3::from_array(p.map(f64::from)));
        let to_light = *light_from_world * self.at;
        corners.map(|p| to_light.transform_point3(p).z).fold(f64::NEG_INFINITY, f64::max)
    }
}

/// A plane of receivers: a square round its own origin, facing its +y.
#[derive(Clone, Copy, Debug)]
pub struct Floor {
    /// Floor to world; rigid.
    pub at: DMat4,
    /// Width and depth, m.
    pub size: [f64; 2],
    /// Receiver, or both.
    pub role: Role,
    /// How many rectangles it is drawn as along a side: rasters are coarse where triangles are huge.
    pub tiles: u32,
}

impl Floor {
    fn mesh(&self) -> Mesh {
        tiled(self.size, self.tiles)
    }
}

/// A rectangle in the plane y = 0, of n × n rectangles of two triangles each, facing +y.
pub fn tiled([width, depth]: [f64; 2], n: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let at = |i: u32, size: f64| ((f64::from(i) / f64::from(n) - 0.5) * size) as f32;
    for (j, i) in (0..=n).flat_map(|j| (0..=n).map(move |i| (j, i))) {
        mesh.positions.push([at(i, width), 0.0, at(j, depth)]);
        mesh.normals.push([0.0, 1.0, 0.0]);
    }
    for (j, i) in (0..n).flat_map(|j| (0..n).map(move |i| (j, i))) {
        let a = j * (n + 1) + i;
        let (b, c, d) = (a + 1, a + n + 1, a + n + 2);
        mesh.indices.extend([a, c, b, b, c, d]);
    }
    mesh
}

/// How the pixels look at the floors.
#[derive(Clone, Copy, Debug)]
pub enum Pixels {
    /// Along the normal of a frame's y, over |x|, |z| ≤ `half` of it, from `top` above to as much beneath.
    Above {
        /// Frame to world; rigid.
        at: DMat4,
        /// Half the width of what is seen, m.
        half: f64,
        /// How high the eye's plane is, m.
        top: f64,
    },
    Camera(antumbra::scene::Camera),
}

/// A whole scene, before it is scaled and moved.
#[derive(Clone, Debug)]
pub struct Set {
    pub light: RectangleLight,
    pub blocks: Vec<Block>,
    pub floors: Vec<Floor>,
    pub pixels: Pixels,
}

/// Where a whole scene goes: first scaled, then moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// The factor on all lengths.
    pub scale: f64,
    /// The way, m.
    pub offset: DVec3,
    /// Whether vertices hold the scale, and not their meshes' transforms.
    pub baked: bool,
}

impl Place {
    /// Where it was.
    pub const HERE: Self = Self { scale: 1.0, offset: DVec3::ZERO, baked: false };

    /// This place without the way.
    pub fn unmoved(self) -> Self {
        Self { offset: DVec3::ZERO, ..self }
    }

    fn matrix(self) -> DMat4 {
        DMat4::from_translation(self.offset) * DMat4::from_scale(DVec3::splat(self.scale))
    }

    fn put(self, mut mesh: Mesh, at: DMat4) -> (Mesh, DMat4) {
        if !self.baked {
            return (mesh, self.matrix() * at);
        }
        for position in &mut mesh.positions {
            *position = position.map(|x| (f64::from(x) * self.scale) as f32);
        }
        let unscaled = DMat4::from_scale(DVec3::splat(1.0 / self.scale));
        (mesh, self.matrix() * at * unscaled)
    }
}

impl Set {
    /// The scene at its place.
    pub fn scene(&self, place: Place) -> Result<Scene, antumbra::Error> {
        let mut scene = Scene::default();
        for (index, floor) in self.floors.iter().enumerate() {
            let (mesh, at) = place.put(floor.mesh(), floor.at);
            scene.add(&format!("floor {index}"), mesh, at, floor.role);
        }
        for (index, block) in self.blocks.iter().enumerate() {
            let (mesh, at) = place.put(block.shape.mesh(), block.at);
            scene.add(&format!("block {index}"), mesh, at, block.role);
        }
        scene.lights = generate::stage(placed(&self.light, place)?).lights;
        Ok(scene)
    }

    /// What blocks for sure, where it stands before anything is scaled or moved: floors that block, and what
    /// the blocks are like, with outlines moved out by `grow(block)`, m.
    pub fn blockers(&self, grow: impl Fn(&Block) -> f64) -> Scene {
        let mut scene = Scene::default();
        for floor in self.floors.iter().filter(|floor| floor.role.blocks()) {
            scene.add("floor", floor.mesh(), floor.at, floor.role);
        }
        for block in &self.blocks {
            if let Some(shape) = block.shape.grown(grow(block)) {
                scene.add("block", shape.mesh(), block.at, block.role);
            }
        }
        scene
    }

    /// How the pixels look at it there.
    pub fn view(&self, place: Place, extent: [u32; 2]) -> View {
        let there = match self.pixels {
            Pixels::Above { at, half, top } => {
                let seen = View::map_of_ground(half, top).clip_from_world;
                View { clip_from_world: seen * at.inverse() }
            }
            Pixels::Camera(camera) => View::of(&camera, extent),
        };
        View { clip_from_world: there.clip_from_world * place.matrix().inverse() }
    }
}

fn placed(light: &RectangleLight, place: Place) -> Result<RectangleLight, antumbra::Error> {
    let (frame, [a, b]) = (light.world_from_light(), light.half_extents());
    let put = place.matrix();
    let center = put.transform_point3(light.center());
    let axis = |axis: DVec3, half: f64| put.transform_vector3(axis) * half;
    let u = axis(frame.x_axis.truncate(), a);
    if light.is_line() {
        return RectangleLight::line(center, u, light.emission());
    }
    // Light leaves along half_v × half_u.
    RectangleLight::new(center, u, axis(frame.y_axis.truncate(), -b))
}
