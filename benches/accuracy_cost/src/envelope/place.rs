//! One place of a sweep: a scene, how pixels look at it, and what is true there.

use crate::Problem;
use crate::scenes;
use antumbra::RectangleLight;
use antumbra::scene::generate::GROUND_SIDE;
use antumbra::scene::{Role, Scene, generate};
use antumbra::truth::metrics::FULL_TOLERANCE;
use antumbra::truth::{Exact, PolygonLight, Receiver};
use antumbra_harness::View;
use glam::{DMat4, DVec3};

/// A sheet: no thickness, so that it comes as near as one likes to ground and light.
pub const FLAT: &str = "card";
/// Round solids before and beside each other.
pub const SOLID: &str = "five spheres";

/// What a variable does not sweep. Lengths are in sizes of the object, which is 1 m across.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// The light's side.
    pub light: f64,
    /// Where the object is on its way from the ground, 0, to the light, 1; its own height is no part of
    /// the way.
    pub height: f64,
    /// From the ground to the light.
    pub gap: f64,
    /// The side of the technique's maps in texels.
    pub map: f64,
    /// The side of the image in pixels.
    pub pixels: f64,
}

/// The middle of every sweep.
pub const CENTRE: Place = Place { light: 0.4, height: 0.5, gap: 4.0, map: 256.0, pixels: 96.0 };

/// A sphere's segments and rings: 360 triangles, which cost the exact truth a tenth of what
/// [`generate::spheres`]' do. Techniques and truth see the same triangles.
const FACES: [u32; 2] = [20, 10];

/// How object and pixels are turned about the vertical, in degrees: the card against the light's axes, or
/// its edges would lie on the borders of texels and have no error; the pixels against both, or all pixels of a
/// row would be one sample.
const TURNS: [f64; 2] = [20.0, 33.0];

/// The shadow's outline is looked for among so many pixels a side.
const COARSE: u32 = 32;

/// Where pixels are placed closer, a view that keeps less than this of the one before is tried once more.
const MUCH_CLOSER: f64 = 0.7;

/// A place that pixels can be painted of.
pub struct Ready {
    /// The ground, the object and the light.
    pub scene: Scene,
    /// Straight down on all that is shadowed.
    pub view: View,
    /// Half the view's side in metres.
    pub half: f64,
    exact: Exact,
    light: PolygonLight,
}

impl Place {
    /// Makes it.
    ///
    /// # Errors
    /// A sentence for a scene that is not known or cannot be.
    pub fn ready(&self, scene: &str) -> Result<Ready, Problem> {
        let side = 0.5 * self.light;
        let up = DVec3::Y * self.gap;
        let light = RectangleLight::new(up, DVec3::X * side, DVec3::NEG_Z * side)?;
        let mut scene = match scene {
            SOLID => {
                let mut spheres = generate::spheres(light);
                for instance in spheres.instances.iter().filter(|i| i.role.blocks()) {
                    let [segments, rings] = FACES;
                    spheres.meshes[instance.mesh] = generate::uv_sphere(0.2, segments, rings);
                }
                generate::normalized(&spheres, light)?
            }
            name => scenes::made(name, light)?,
        };
        let bounds = scene.bounds(|i| i.role.blocks()).ok_or("nothing blocks light")?;
        let way = self.gap - bounds.size().y;
        let turn = DMat4::from_rotation_y(TURNS[0].to_radians());
        let moved = DVec3::Y * (self.height * way - bounds.min.y);
        scenes::move_blocks(&mut scene, DMat4::from_translation(moved) * turn);
        let exact = Exact::new(&scene)?;
        let polygon = PolygonLight::from(&light);
        let widest = widest(&scene, self);
        let half = closer(&exact, &polygon, widest)?;
        let ground = DMat4::from_scale(DVec3::splat(2.0 * 1.5 * half / GROUND_SIDE));
        for instance in scene.instances.iter_mut().filter(|i| i.role == Role::Receiver) {
            instance.world_from_mesh = ground;
        }
        Ok(Ready { view: view(half), scene, half, exact, light: polygon })
    }
}

impl Ready {
    /// The visible fraction of the pixels' receivers; 1 where there is none.
    ///
    /// # Errors
    /// As [`Exact::visible_fractions`].
    pub fn truth(&self, receivers: &[Receiver]) -> Result<Vec<f32>, Problem> {
        seen(&self.exact, &self.light, receivers)
    }
}

/// As [`Exact::visible_fractions`], and 1 without a receiver.
fn seen(exact: &Exact, light: &PolygonLight, all: &[Receiver]) -> Result<Vec<f32>, Problem> {
    let there: Vec<Receiver> = all.iter().copied().filter(|r| r.normal != DVec3::ZERO).collect();
    let found = exact.visible_fractions(light, &there)?;
    let mut found = found.into_iter();
    let of = |r: &Receiver| match r.normal == DVec3::ZERO {
        true => 1.0,
        false => found.next().unwrap_or(1.0) as f32,
    };
    Ok(all.iter().map(of).collect())
}

fn view(half: f64) -> View {
    let turn = DMat4::from_rotation_y(TURNS[1].to_radians());
    // The ground's depth is exactly ½, from whatever height.
    View { clip_from_world: View::map_of_ground(half, half).clip_from_world * turn }
}

/// Half a view's side that holds the penumbra of every vertex, turned or not.
fn widest(scene: &Scene, place: &Place) -> f64 {
    let reach = |p: DVec3| {
        let larger = place.gap / (place.gap - p.y);
        p.x.hypot(p.z) * larger + 0.5 * 2f64.sqrt() * place.light * (larger - 1.0)
    };
    1.05 * scene.world_positions(|i| i.role.blocks()).map(reach).fold(0.0, f64::max)
}

/// Half a view's side that holds what the light's rays leave darker than the metric tells from lit: of an
/// object near the light, or under a light far larger than itself, most of the penumbra is not.
fn closer(exact: &Exact, light: &PolygonLight, widest: f64) -> Result<f64, Problem> {
    let mut half = widest;
    for _ in 0..4 {
        let pixel = 2.0 * half / f64::from(COARSE);
        let world_from_ndc = view(half).clip_from_world.inverse();
        let at = |i: u32| {
            let ndc = |i: u32| (f64::from(2 * i + 1)) / f64::from(COARSE) - 1.0;
            world_from_ndc.project_point3(DVec3::new(ndc(i % COARSE), ndc(i / COARSE), 0.5))
        };
        let receiver = |i| Receiver { position: at(i), normal: DVec3::Y };
        let receivers: Vec<Receiver> = (0..COARSE * COARSE).map(receiver).collect();
        let visible = seen(exact, light, &receivers)?;
        let dark = receivers.iter().zip(visible).filter(|(_, v)| *v < 1.0 - FULL_TOLERANCE);
        let clip = view(1.0).clip_from_world;
        let reach = |r: &Receiver| clip.transform_point3(r.position).truncate().abs().max_element();
        let needed = dark.map(|(r, _)| reach(r) + pixel).reduce(f64::max);
        let last = half;
        half = needed.map_or(half, |needed| needed.min(half));
        if needed.is_none() || half > MUCH_CLOSER * last {
            break;
        }
    }
    Ok(half)
}
