//! Scenes made in code, for tests and benches.
//!
//! ```text
//!        y = 4    ───────      the light, facing down
//!
//!        y = 2      ▒▒▒        the object, largest extent 1
//!
//!        y = 0  ───────────    the ground, 8 × 8
//! ```
//! Every scene has a node `ground` (receiver), one or more objects (occluders; see
//! [`Scene::with_occluders_as`] for the other roles) and the light `light`, in metres. The same
//! arguments give the same bits.

use super::{AreaLight, Mesh, Role, Scene};
use crate::{Error, Light, RectangleLight};
use glam::{DMat4, DQuat, DVec3};
use std::f64::consts::{PI, TAU};

/// The ground's side, in metres: wide enough for the penumbra of a light of side 3.
pub const GROUND_SIDE: f64 = 8.0;

/// The place of an object's centre, metres.
const OBJECT_CENTER: DVec3 = DVec3::new(0.0, 2.0, 0.0);

/// The light's centre.
const LIGHT_CENTER: DVec3 = DVec3::new(0.0, 4.0, 0.0);

/// A square light of the given side, in metres, at (0, 4, 0) facing straight down.
///
/// # Errors
/// [`Error::Light`] for a side that is not a number above 0.
pub fn square_light(side: f64) -> Result<RectangleLight, Error> {
    rectangle_light(side, side, 0.0)
}

/// A light at (0, 4, 0), `width` along x and `height` along z, in metres, turned about its x axis by
/// `tilt` radians from facing straight down, towards −z.
///
/// # Errors
/// [`Error::Light`] for sides that are not numbers above 0 or a tilt that is not finite.
pub fn rectangle_light(width: f64, height: f64, tilt: f64) -> Result<RectangleLight, Error> {
    // A length hides the sign, so a negative side would pass as its mirror image.
    if width < 0.0 || height < 0.0 {
        return Err(Error::Light("its width and height must be above 0".into()));
    }
    let turn = DQuat::from_rotation_x(tilt);
    RectangleLight::new(
        LIGHT_CENTER,
        turn * (DVec3::X * 0.5 * width),
        turn * (DVec3::NEG_Z * 0.5 * height),
    )
}

/// A line light of the given length at (0, 4, 0), in metres, facing straight down: along x, turned about
/// the vertical by `turn` radians, from +x towards −z.
///
/// # Errors
/// [`Error::Light`] for a length that is not a number above 0 or a turn that is not finite.
pub fn line_light(length: f64, turn: f64) -> Result<RectangleLight, Error> {
    if length < 0.0 {
        return Err(Error::Light("its length must be above 0".into()));
    }
    let half = DQuat::from_rotation_y(turn) * (DVec3::X * 0.5 * length);
    RectangleLight::line(LIGHT_CENTER, half, DVec3::NEG_Y)
}

/// A polygon light at (0, 4, 0), facing straight down: `corners` are 3 to 16 points along x and z, in metres from there,
/// whichever way they run.
///
/// # Errors
/// See [`Light::polygon`].
pub fn polygon_light(corners: &[[f64; 2]]) -> Result<Light, Error> {
    let mut placed: Vec<DVec3> =
        corners.iter().map(|&[x, z]| LIGHT_CENTER + DVec3::new(x, 0.0, z)).collect();
    let light = Light::polygon(&placed)?;
    if light.emission().y < 0.0 {
        return Ok(light);
    }
    placed.reverse();
    Light::polygon(&placed)
}

/// A square card of side 1 at y = 2, parallel to the ground, front side up, double-sided.
pub fn card(light: impl Into<Light>) -> Scene {
    let mut scene = stage(light);
    let world_from_card = DMat4::from_translation(OBJECT_CENTER);
    scene.add("card", double_sided(quad(1.0, 1.0)), world_from_card, Role::Occluder);
    scene
}

/// A box of 0.4 × 1 × 0.4 standing on the ground.
pub fn tall_box(light: impl Into<Light>) -> Scene {
    let mut scene = stage(light);
    let size = DVec3::new(0.4, 1.0, 0.4);
    let world_from_box = DMat4::from_translation(DVec3::Y * 0.5 * size.y);
    scene.add("box", cuboid(size), world_from_box, Role::Occluder);
    scene
}

/// Three double-sided square cards of side 0.6 at y = 1.5, 2 and 2.5, each hiding part of the next,
/// 1 × 1 × 0.8 together: what is in front decides little, what lies behind it much.
pub fn stacked_cards(light: impl Into<Light>) -> Scene {
    let mut scene = stage(light);
    for (i, step) in [-1.0, 0.0, 1.0].into_iter().enumerate() {
        let center = OBJECT_CENTER + DVec3::new(0.2, 0.5, -0.1) * step;
        scene.add(
            &format!("card {i}"),
            double_sided(quad(0.6, 0.6)),
            DMat4::from_translation(center),
            Role::Occluder,
        );
    }
    scene
}

/// `count` boxes side by side, each 1 long, 0.005 thick and as wide as the gap to the next, 1 × 1
/// together round (0, 2, 0): thin occluders, and many rims of the light at once. At least one box.
pub fn slats(light: impl Into<Light>, count: u32) -> Scene {
    let mut scene = stage(light);
    let count = count.max(1);
    // `count` slats and the gaps between them, all as wide, make 1.
    let width = 1.0 / f64::from(2 * count - 1);
    let mut mesh = Mesh::default();
    for i in 0..count {
        let x = -0.5 + width * (2.0 * f64::from(i) + 0.5);
        append(&mut mesh, &cuboid(DVec3::new(width, 0.005, 1.0)), DVec3::X * x);
    }
    scene.add("slats", mesh, DMat4::from_translation(OBJECT_CENTER), Role::Occluder);
    scene
}

/// `leaves` double-sided diamonds of two triangles, each about 0.08 × 0.04, turned and strewn at
/// random in a ball, 1 across together, round (0, 2, 0): noise to every method that assumes
/// surfaces. Each `seed` is a plant of its own; a few hundred leaves make a dense one.
pub fn foliage(light: impl Into<Light>, leaves: u32, seed: u32) -> Scene {
    let light = light.into();
    let mut mesh = double_sided(Mesh::default());
    for leaf in 0..leaves {
        let random = |k: u32| unit_hash(seed, leaf, k);
        // The cube root spreads them evenly over the ball's volume.
        let center = on_sphere(random(0), random(1)) * 0.46 * random(2).cbrt();
        let normal = on_sphere(random(3), random(4));
        let (a, b) = normal.any_orthonormal_pair();
        let (sin, cos) = (TAU * random(5)).sin_cos();
        let long = (a * cos + b * sin) * 0.04;
        let short = normal.cross(long) * 0.5;
        append(&mut mesh, &diamond(long, short, normal), center);
    }
    let mut plant = Scene::default();
    plant.add("foliage", mesh, DMat4::IDENTITY, Role::Occluder);
    // A plant without a leaf has no extent to scale, and is no error: the ground is then all lit.
    normalized(&plant, light).unwrap_or_else(|_| stage(light))
}

/// A box of side 0.5 resting on the ground at x = −0.5, and a sphere of radius 0.25 touching it at
/// x = 0.5: occluders at no distance from what they shadow.
pub fn contact(light: impl Into<Light>) -> Scene {
    let mut scene = stage(light);
    let world_from_box = DMat4::from_translation(DVec3::new(-0.5, 0.25, 0.0));
    scene.add("box", cuboid(DVec3::splat(0.5)), world_from_box, Role::Occluder);
    let world_from_sphere = DMat4::from_translation(DVec3::new(0.5, 0.25, 0.0));
    scene.add("sphere", uv_sphere(0.25, 48, 24), world_from_sphere, Role::Occluder);
    scene
}

/// Five spheres of radius 0.2, 0.6 apart along x, centred at y = 0.2 (on the ground), 0.7, 1.2, 1.7
/// and 2.2 in mixed order: every sharpness of penumbra in one image.
pub fn spheres(light: impl Into<Light>) -> Scene {
    let mut scene = stage(light);
    let heights = [1.2, 0.2, 2.2, 0.7, 1.7];
    for (i, y) in (0_u32..).zip(heights) {
        let center = DVec3::new((f64::from(i) - 2.0) * 0.6, y, 0.0);
        scene.add(
            &format!("sphere {i}"),
            uv_sphere(0.2, 48, 24),
            DMat4::from_translation(center),
            Role::Occluder,
        );
    }
    scene
}

/// Takes what blocks light in `object` (a loaded bunny, say), scales it to a largest extent of 1,
/// centres it at (0, 2, 0), makes it an occluder, and puts the ground and the light to it. Its own
/// receivers, lights and camera are left behind.
///
/// # Errors
/// [`Error::Scene`] where nothing in `object` blocks light, or what does has no extent.
pub fn normalized(object: &Scene, light: impl Into<Light>) -> Result<Scene, Error> {
    let bounds = object
        .bounds(|i| i.role.blocks())
        .ok_or_else(|| Error::Scene("nothing in the scene blocks light".into()))?;
    let extent = bounds.size().max_element();
    if !(extent.is_normal() && extent > 0.0) {
        return Err(Error::Scene(format!(
            "what blocks light in the scene is {extent} m across, which cannot be scaled to 1 m"
        )));
    }
    let place = DMat4::from_translation(OBJECT_CENTER)
        * DMat4::from_scale(DVec3::splat(extent.recip()))
        * DMat4::from_translation(-bounds.center());
    let mut scene = stage(light);
    for instance in object.instances.iter().filter(|i| i.role.blocks()) {
        scene.add(
            &instance.name,
            object.meshes[instance.mesh].clone(),
            place * instance.world_from_mesh,
            Role::Occluder,
        );
    }
    Ok(scene)
}

impl Scene {
    /// The scene with `role` for every instance whose role is `Occluder`: with `Both` they receive shadows too, their
    /// own included.
    pub fn with_occluders_as(mut self, role: Role) -> Self {
        for instance in self.instances.iter_mut().filter(|i| i.role == Role::Occluder) {
            instance.role = role;
        }
        self
    }
}

/// The ground and the light alone: all of it is lit.
pub fn stage(light: impl Into<Light>) -> Scene {
    let mut scene = Scene::default();
    scene.add("ground", ground(GROUND_SIDE), DMat4::IDENTITY, Role::Receiver);
    scene.lights.push(AreaLight {
        name: "light".into(),
        light: light.into(),
        color: [1.0; 3],
        intensity: 1.0,
    });
    scene
}

/// A square of the given side in the plane y = 0, round the origin, facing +y.
pub fn ground(side: f64) -> Mesh {
    quad(side, side)
}

/// A rectangle in the plane y = 0, `width` along x and `depth` along z, round the origin, facing +y.
pub fn quad(width: f64, depth: f64) -> Mesh {
    let (x, z) = (0.5 * width, 0.5 * depth);
    let corners = [(-x, -z), (-x, z), (x, z), (x, -z)];
    let mut mesh = Mesh::default();
    face(&mut mesh, corners.map(|(x, z)| DVec3::new(x, 0.0, z)), DVec3::Y);
    mesh
}

/// A box of the given size round the origin: 12 triangles, four vertices a face.
pub fn cuboid(size: DVec3) -> Mesh {
    let half = 0.5 * size;
    let mut mesh = Mesh::default();
    // Each face by its normal and an edge direction; the other edge completes a right-handed frame.
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    for i in 0..3 {
        for normal in [axes[i], -axes[i]] {
            let u = axes[(i + 1) % 3];
            let v = normal.cross(u);
            let corner = |a: f64, b: f64| half * (normal + u * a + v * b);
            let corners =
                [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
            face(&mut mesh, corners, normal);
        }
    }
    mesh
}

/// A sphere round the origin with smooth normals: `segments` (at least 3) round the y axis, `rings`
/// (at least 2) from pole to pole, 2 · segments · (rings − 1) triangles.
pub fn uv_sphere(radius: f64, segments: u32, rings: u32) -> Mesh {
    let (segments, rings) = (segments.max(3), rings.max(2));
    let mut mesh = Mesh::default();
    for ring in 0..=rings {
        let (sin_theta, cos_theta) = (PI * f64::from(ring) / f64::from(rings)).sin_cos();
        for segment in 0..=segments {
            // The last column repeats the first one's angle, so that the seam closes to the bit.
            let phi = TAU * f64::from(segment % segments) / f64::from(segments);
            let normal = DVec3::new(sin_theta * phi.cos(), cos_theta, sin_theta * phi.sin());
            mesh.positions.push((normal * radius).as_vec3().to_array());
            mesh.normals.push(normal.as_vec3().to_array());
        }
    }
    for ring in 0..rings {
        for segment in 0..segments {
            let a = ring * (segments + 1) + segment;
            let b = a + segments + 1;
            // At the poles one triangle of each cell has no area.
            if ring > 0 {
                mesh.indices.extend([a, a + 1, b + 1]);
            }
            if ring + 1 < rings {
                mesh.indices.extend([a, b + 1, b]);
            }
        }
    }
    mesh
}

/// A flat diamond round the origin.
fn diamond(long: DVec3, short: DVec3, normal: DVec3) -> Mesh {
    let mut mesh = Mesh::default();
    face(&mut mesh, [-long, -short, long, short], normal);
    mesh
}

/// Adds four vertices, counter-clockwise seen from the front, and two triangles.
fn face(mesh: &mut Mesh, corners: [DVec3; 4], normal: DVec3) {
    let first = vertex_count(mesh);
    mesh.positions.extend(corners.map(|c| c.as_vec3().to_array()));
    mesh.normals.extend([normal.as_vec3().to_array(); 4]);
    mesh.indices.extend([0, 1, 2, 0, 2, 3].map(|i| first + i));
}

/// Adds a copy of `part`, moved.
fn append(mesh: &mut Mesh, part: &Mesh, offset: DVec3) {
    let first = vertex_count(mesh);
    let moved = |p: &[f32; 3]| (DVec3::from_array(p.map(f64::from)) + offset).as_vec3().to_array();
    mesh.positions.extend(part.positions.iter().map(moved));
    mesh.normals.extend(&part.normals);
    mesh.indices.extend(part.indices.iter().map(|i| first + i));
}

fn vertex_count(mesh: &Mesh) -> u32 {
    // Meshes made here are small; a count past u32 would not fit in memory.
    mesh.positions.len() as u32
}

fn double_sided(mesh: Mesh) -> Mesh {
    Mesh { double_sided: true, ..mesh }
}

/// A direction, evenly spread where `a` and `b` are evenly spread in [0, 1).
fn on_sphere(a: f64, b: f64) -> DVec3 {
    let z = 1.0 - 2.0 * a;
    let (sin, cos) = (TAU * b).sin_cos();
    DVec3::new(cos, sin, 0.0) * (1.0 - z * z).max(0.0).sqrt() + DVec3::Z * z
}

/// A number in [0, 1) that three integers settle: PCG-3D's first output (Jarzynski and Olano 2020,
/// "Hash Functions for GPU Rendering", listing 5).
fn unit_hash(x: u32, y: u32, z: u32) -> f64 {
    let mut v = [x, y, z].map(|c| c.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    let mix = |v: &mut [u32; 3]| {
        v[0] = v[0].wrapping_add(v[1].wrapping_mul(v[2]));
        v[1] = v[1].wrapping_add(v[2].wrapping_mul(v[0]));
        v[2] = v[2].wrapping_add(v[0].wrapping_mul(v[1]));
    };
    mix(&mut v);
    v = v.map(|c| c ^ c >> 16);
    mix(&mut v);
    f64::from(v[0]) / (f64::from(u32::MAX) + 1.0)
}
