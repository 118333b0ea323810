//! Random scenes: what proptest draws, shrinks and prints.

use antumbra::RectangleLight;
use antumbra::scene::{Instance, Mesh, Role};
use antumbra_harness::View;
use glam::{DMat3, DMat4, DQuat, DVec3, DVec4};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

/// Width and height of every image.
pub const SIDE: u32 = 24;

/// What is round the origin, one metre wide.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// One triangle with one front.
    Triangle,
    /// A square with two fronts.
    Card,
    /// A closed box.
    Box,
    /// The same with its fronts inside.
    InsideOut,
    /// Every triangle of a box twice.
    Twice,
    /// A box that lacks two of its faces: what ends in an edge is open.
    Open,
    /// A triangle without area: three points on a line, which roundings make one of some.
    Line,
    /// A triangle without area: three times one place, which no raster shows.
    Point,
}

impl Shape {
    /// Every shape; the place in it is the mesh's in [`meshes`].
    pub const ALL: [Self; 8] = [
        Self::Triangle,
        Self::Card,
        Self::Box,
        Self::InsideOut,
        Self::Twice,
        Self::Open,
        Self::Line,
        Self::Point,
    ];

    fn mesh(self) -> Mesh {
        let square = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
        let mut mesh = Mesh::default();
        match self {
            Self::Triangle => {
                mesh.positions = vec![[-0.5, -0.5, 0.0], [0.5, -0.5, 0.0], [0.0, 0.5, 0.0]];
                mesh.indices = vec![0, 1, 2];
            }
            Self::Card => {
                mesh.positions = square.map(|[x, y]| [x, y, 0.0]).into();
                mesh.indices = vec![0, 1, 2, 0, 2, 3];
                mesh.double_sided = true;
            }
            Self::Line | Self::Point => {
                mesh.positions = vec![[-0.5; 3], [0.0; 3], [0.5; 3]];
                mesh.indices = if self == Self::Line { vec![0, 1, 2] } else { vec![1; 3] };
            }
            Self::Box | Self::InsideOut | Self::Twice | Self::Open => {
                let corner = |i: u32| [0, 1, 2].map(|axis| (i >> axis & 1) as f32 - 0.5);
                mesh.positions = (0..8).map(corner).collect();
                let quads = [
                    [0, 4, 6, 2],
                    [1, 3, 7, 5],
                    [0, 1, 5, 4],
                    [2, 6, 7, 3],
                    [0, 2, 3, 1],
                    [4, 5, 7, 6],
                ];
                let faces = if self == Self::Open { 4 } else { 6 };
                let triangles = |[a, b, c, d]: [u32; 4]| [a, b, c, a, c, d];
                mesh.indices = quads[..faces].iter().copied().flat_map(triangles).collect();
                match self {
                    Self::InsideOut => mesh.indices.reverse(),
                    Self::Twice => mesh.indices.extend_from_within(..),
                    _ => {}
                }
            }
        }
        // Nothing here looks at them.
        mesh.normals = vec![[0.0, 0.0, 1.0]; mesh.positions.len()];
        mesh
    }
}

/// A mesh a shape.
pub fn meshes() -> Vec<Mesh> {
    Shape::ALL.iter().map(|shape| shape.mesh()).collect()
}

/// A shape placed in the world.
#[derive(Clone, Copy, Debug)]
pub struct Object {
    /// What is placed.
    pub shape: Shape,
    /// Where, how large and which way round: any affine transform.
    pub world_from_mesh: DMat4,
    /// Occluder or both.
    pub role: Role,
}

impl Object {
    /// The same elsewhere.
    #[must_use]
    pub fn moved(&self, by: DVec3) -> Self {
        let world_from_mesh = DMat4::from_translation(by) * self.world_from_mesh;
        Self { world_from_mesh, ..*self }
    }

    /// The least and the largest corner of its box as a light sees it, in light space.
    pub fn seen_by(&self, light: &RectangleLight) -> [DVec3; 2] {
        let light_from_mesh = light.light_from_world() * self.world_from_mesh;
        let corner = |i: u32| DVec3::from_array([0, 1, 2].map(|a| f64::from(i >> a & 1) - 0.5));
        let corners = (0..8).map(|i| light_from_mesh.transform_point3(corner(i)));
        let none = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        corners.fold(none, |[least, most], p| [least.min(p), most.max(p)])
    }

    /// As a scene has it.
    pub fn instance(&self) -> Instance {
        let mesh = Shape::ALL.iter().position(|s| *s == self.shape).unwrap_or(0);
        Instance {
            name: String::new(),
            mesh,
            world_from_mesh: self.world_from_mesh,
            role: self.role,
        }
    }
}

/// A light by its numbers.
#[derive(Clone, Copy, Debug)]
pub struct Lamp {
    /// Its centre.
    pub center: DVec3,
    /// Its half-axes; a line has no second one, and then `half_v` is a unit vector along its emission.
    pub half_u: DVec3,
    /// See `half_u`.
    pub half_v: DVec3,
    /// Whether it is a line.
    pub line: bool,
}

impl Lamp {
    /// # Panics
    /// Where the numbers are no light.
    pub fn light(&self) -> RectangleLight {
        let light = match self.line {
            true => RectangleLight::line(self.center, self.half_u, self.half_v),
            false => RectangleLight::new(self.center, self.half_u, self.half_v),
        };
        light.unwrap_or_else(|e| panic!("{e}: {self:?}"))
    }

    /// The same lamp somewhere else. A mirror that turns `half_u` round keeps the side that it shines to.
    #[must_use]
    pub fn under(&self, change: &DMat4) -> Self {
        let vector = |v| change.transform_vector3(v);
        let mirrored = !self.line && change.determinant() < 0.0;
        let half_u = if mirrored { -self.half_u } else { self.half_u };
        Self {
            center: change.transform_point3(self.center),
            half_u: vector(half_u),
            half_v: vector(self.half_v),
            line: self.line,
        }
    }

    /// Its halves, side by side along the first half-axis.
    pub fn halves(&self) -> [Self; 2] {
        let half_u = 0.5 * self.half_u;
        [-half_u, half_u].map(|by| Self { half_u, ..self.moved(by) })
    }

    /// The same lamp elsewhere.
    #[must_use]
    pub fn moved(&self, by: DVec3) -> Self {
        Self { center: self.center + by, ..*self }
    }

    /// The same lamp told of otherwise: its half-axes a quarter of a turn on.
    #[must_use]
    pub fn quarter_turned(&self) -> Self {
        if self.line {
            return Self { half_u: -self.half_u, ..*self };
        }
        Self { half_u: self.half_v, half_v: -self.half_u, ..*self }
    }

    /// The same lamp, its sides as long as this.
    #[must_use]
    pub fn as_small_as(&self, side: f64) -> Self {
        let half = |v: DVec3| v.normalize() * (0.5 * side);
        let half_v = if self.line { self.half_v } else { half(self.half_v) };
        Self { half_u: half(self.half_u), half_v, ..*self }
    }
}

/// A scene: planes that receive, what stands between them and a light, and how pixels look at it.
#[derive(Clone, Debug)]
pub struct Case {
    /// The light.
    pub lamp: Lamp,
    /// Receivers, that block nothing.
    pub planes: Vec<Object>,
    /// Occluders, and meshes that are both.
    pub objects: Vec<Object>,
    /// World to clip space.
    pub clip_from_world: DMat4,
}

impl Case {
    /// Everything that pixels show: all but what is only an occluder.
    pub fn instances(&self) -> Vec<Instance> {
        self.planes.iter().chain(&self.objects).map(Object::instance).collect()
    }

    /// How its pixels look at it.
    pub fn view(&self) -> View {
        View { clip_from_world: self.clip_from_world }
    }
}

/// Draws from a cube.
pub fn vector(size: f64) -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-size..size).prop_map(DVec3::from_array)
}

/// Any turn.
pub fn turn() -> impl Strategy<Value = DQuat> {
    vector(1.0).prop_map(|v| DQuat::from_scaled_axis(v * std::f64::consts::PI))
}

/// From 10^`low` to 10^`high`, each power as often.
pub fn magnitude(low: f64, high: f64) -> impl Strategy<Value = f64> {
    (low..high).prop_map(|power| 10f64.powf(power))
}

/// Sides from 1 mm to 10 m, up to a hundred times as long as wide, some metres up; most of them shine at what is
/// at the origin, the others anywhere. One in eight is a line.
pub fn lamp() -> impl Strategy<Value = Lamp> {
    lamp_of((-3.0, 1.0), (0.0, 2.0), 0.125)
}

/// The same of sides and aspects between powers of ten; so many of them are lines.
pub fn lamp_of(long: (f64, f64), aspect: (f64, f64), lines: f64) -> impl Strategy<Value = Lamp> {
    let place = (-1.5..1.5, 1.5..4.0, -1.5..1.5).prop_map(|(x, y, z)| DVec3::new(x, y, z));
    let aim = prop_oneof![
        7 => vector(0.7).prop_map(Some),
        1 => Just(None),
    ];
    let size = (magnitude(long.0, long.1), magnitude(aspect.0, aspect.1));
    (place, aim, turn(), size, prop::bool::weighted(lines)).prop_map(
        |(center, aim, roll, (long, aspect), line)| {
            let z = match aim {
                Some(at) => (at - center).normalize(),
                None => roll * DVec3::Z,
            };
            // Any direction across.
            let x = (roll * DVec3::X).reject_from_normalized(z);
            let x = if x.length() > 1e-3 { x.normalize() } else { z.any_orthonormal_vector() };
            // It shines along v × u.
            let y = x.cross(z);
            let half = 0.5 * long;
            let half_v = if line { z } else { -y * (half / aspect) };
            Lamp { center, half_u: x * half, half_v: if line { z } else { -half_v }, line }
        },
    )
}

/// A plane of some metres near the origin, up to 75° from level.
pub fn plane() -> impl Strategy<Value = Object> {
    (vector(1.0), vector(1.0), -1.3..1.3).prop_map(|(at, axis, lean)| {
        let at = at * DVec3::new(1.0, 0.5, 1.0);
        let level = DQuat::from_rotation_x(-std::f64::consts::FRAC_PI_2);
        let axis = DVec3::new(axis.x, 0.0, axis.z).normalize_or(DVec3::X);
        let turn = DQuat::from_axis_angle(axis, lean) * level;
        let world_from_mesh = DMat4::from_scale_rotation_translation(DVec3::splat(4.0), turn, at);
        Object { shape: Shape::Card, world_from_mesh, role: Role::Receiver }
    })
}

/// Something of 12 cm to 2 m, flattened, sheared and turned any way, that stands somewhere about the way from the
/// origin to the light: touching what is there, crossing it or behind the light now and then.
pub fn object() -> impl Strategy<Value = (f64, Object)> {
    let shape = prop::sample::select(Shape::ALL.to_vec());
    let sizes = (magnitude(-0.9, 0.3), magnitude(-1.0, 0.0), magnitude(-1.5, 0.0));
    (shape, 0.0..1.2, vector(0.7), sizes, turn(), vector(0.5), prop::bool::weighted(0.25)).prop_map(
        |(shape, t, aside, (size, flat, thin), turn, shear, both)| {
            let shear = DMat3::from_cols(
                DVec3::X,
                DVec3::new(shear.x, 1.0, 0.0),
                DVec3::new(shear.y, shear.z, 1.0),
            );
            let scale = DMat3::from_diagonal(size * DVec3::new(1.0, flat, thin));
            let linear = DMat3::from_quat(turn) * shear * scale;
            let role = if both { Role::Both } else { Role::Occluder };
            let [x, y, z] = [linear.x_axis, linear.y_axis, linear.z_axis].map(|c| c.extend(0.0));
            let world_from_mesh = DMat4::from_cols(x, y, z, aside.extend(1.0));
            (t, Object { shape, world_from_mesh, role })
        },
    )
}

/// A camera that holds most of it, an orthographic one as often as not.
pub fn clip_from_world() -> impl Strategy<Value = DMat4> {
    let above = (-2.0..2.0, 2.0..6.0, -2.0..2.0).prop_map(|(x, y, z)| DVec3::new(x, y, z));
    (above, vector(0.3), any::<bool>()).prop_map(|(eye, at, orthographic)| {
        let z = (eye - at).normalize();
        let x = DVec3::Z.cross(z).normalize_or(DVec3::X);
        let y = z.cross(x);
        let world_from_view =
            DMat4::from_cols(x.extend(0.0), y.extend(0.0), z.extend(0.0), eye.extend(1.0));
        let distance = (eye - at).length();
        // Two metres to each side of the origin.
        let clip_from_view = match orthographic {
            true => DMat4::from_cols(
                DVec4::new(0.5, 0.0, 0.0, 0.0),
                DVec4::new(0.0, -0.5, 0.0, 0.0),
                DVec4::new(0.0, 0.0, 1.0 / 16.0, 0.0),
                DVec4::new(0.0, 0.0, 1.0, 1.0),
            ),
            false => DMat4::from_cols(
                DVec4::new(0.5 * distance, 0.0, 0.0, 0.0),
                DVec4::new(0.0, -0.5 * distance, 0.0, 0.0),
                DVec4::new(0.0, 0.0, 0.0, -1.0),
                DVec4::new(0.0, 0.0, 0.1, 0.0),
            ),
        };
        clip_from_view * world_from_view.inverse()
    })
}

/// All of it, with up to this many objects under any lamp.
pub fn case(objects: usize) -> impl Strategy<Value = Case> {
    case_under(lamp(), objects)
}

/// The same under one of some lamps.
pub fn case_under(
    lamp: impl Strategy<Value = Lamp>,
    objects: usize,
) -> impl Strategy<Value = Case> {
    let planes = prop::collection::vec(plane(), 1..=3);
    let objects = prop::collection::vec(object(), 1..=objects);
    (lamp, planes, objects, clip_from_world()).prop_map(
        |(lamp, planes, objects, clip_from_world)| {
            let objects = objects.into_iter().map(|(t, o)| o.moved(lamp.center * t)).collect();
            Case { lamp, planes, objects, clip_from_world }
        },
    )
}

/// How many times as many cases as usual: `ANTUMBRA_CASES`, 1 without.
///
/// # Panics
/// Where that is no number above 0.
pub fn times() -> f64 {
    let Ok(words) = std::env::var("ANTUMBRA_CASES") else { return 1.0 };
    match words.parse() {
        Ok(times) if times > 0.0 => times,
        _ => panic!(
            "ANTUMBRA_CASES is {words:?}; give how many times as many cases as usual, as 10 or 0.1"
        ),
    }
}

/// Runs a law on so many cases times [`times`], the same each time for a seed, and panics with the smallest that breaks
/// it.
///
/// # Panics
/// Where a case does.
pub fn hold<S: Strategy>(
    cases: u32,
    seed: u8,
    strategy: &S,
    law: impl Fn(S::Value) -> Result<(), TestCaseError>,
) {
    let cases = (f64::from(cases) * times()).ceil() as u32;
    let config = Config {
        cases,
        failure_persistence: None,
        // Each try of shrinking runs the device.
        max_shrink_iters: 400,
        ..Config::default()
    };
    let random = TestRng::from_seed(RngAlgorithm::ChaCha, &[seed; 32]);
    let run = TestRunner::new_with_rng(config, random).run(strategy, law);
    run.unwrap_or_else(|e| panic!("{e}"));
}
