//! What is measured together: the same pixels, the same truth, in turns.

use crate::Problem;
use crate::scenes::{self, SceneSpec, Source};
use antumbra::Technique;
use antumbra::scene::{Camera, Instance, Role, Scene, generate};
use antumbra_harness::{GBuffer, HeadlessDevice, Stage as Pixels, View};
use glam::{DMat4, DVec3};

/// The study of error against time.
pub const MATRIX: &str = "matrix";

/// Where a group's scene comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum Stage {
    /// A scene under one of its lights, by a camera.
    Seen(SceneSpec, String),
    /// A made scene or model under a square light of this side, its object moved from its place by
    /// this much; pixels are a grid on the ground over |x|, |z| ≤ `half`.
    Moved {
        /// As [`scenes::made`] has it.
        model: &'static str,
        /// The light's side in metres.
        light: f64,
        /// From where the object stands.
        by: DVec3,
        /// Half the grid's side in metres.
        half: f64,
        /// How far to the side the occluder map's window reaches beyond what holds the object where
        /// it stands.
        reach: f64,
    },
    /// A sphere of about so many triangles in the bunny's place.
    Sphere(u32),
    /// One of [`crate::places::ALL`] under one of its lights, by a camera that walks through it.
    Walk { scene: &'static str, light: String, frames: usize },
}

/// What a group's images are compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Against {
    Traced,
    /// The closed form of the one card there is: no noise.
    Card,
}

/// One row to be.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    pub technique: &'static str,
    /// The curve it is a point of.
    pub curve: String,
    /// The settings as words.
    pub words: String,
    /// Where it is on the axis that is swept.
    pub x: f64,
    /// What the light is scaled by before the technique gets it; 1 but where it is wrong on purpose.
    pub light_scale: f64,
    /// Whether it stands for its technique in the picture strip.
    pub shown: bool,
}

impl Entry {
    /// A point of a curve under the light as it is, and not in the picture strip.
    pub fn new(technique: &'static str, curve: &str, words: String, x: f64) -> Self {
        Self { technique, curve: curve.into(), words, x, light_scale: 1.0, shown: false }
    }
}

/// Rows that are measured together.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// The study that the rows belong to.
    pub study: &'static str,
    pub scene: String,
    pub light: String,
    pub stage: Stage,
    /// Width and height of the images.
    pub extent: [u32; 2],
    pub against: Against,
    /// Where the group is on the axis that is swept, where the entries are not.
    pub at: Option<f64>,
    pub entries: Vec<Entry>,
}

/// A scene ready to be measured.
pub struct Ready {
    /// The scene; its first light is used.
    pub scene: Scene,
    /// The pixels' view of the scene.
    pub view: View,
    /// The occluder map's tangents, where they are not fitted.
    pub window: Option<[[f64; 2]; 2]>,
    /// Whether pixels see what only occludes.
    pub occluders_seen: bool,
    /// Whether the node is lent the normals of triangles, as `render` lends them.
    pub normals: bool,
}

impl Ready {
    /// Whether pixels see an instance.
    pub fn keeps(&self, instance: &Instance) -> bool {
        self.occluders_seen || instance.role != Role::Occluder
    }

    /// A stage of these settings at so many pixels.
    pub fn stage(
        &self,
        device: &HeadlessDevice,
        extent: [u32; 2],
        settings: Technique,
    ) -> Result<Pixels, Problem> {
        let keep = |i: &Instance| self.keeps(i);
        let mut stage = Pixels::new(device, &self.scene, &self.view, extent, settings, keep)?;
        if self.normals {
            stage.configure_with(settings, |d| d.normals = Some(GBuffer::NORMALS))?;
        }
        Ok(stage)
    }
}

impl Group {
    /// A group of a scene under one of its lights, by its camera; only the card's truth is exact in every view.
    pub fn seen(
        study: &'static str,
        spec: &SceneSpec,
        light: &str,
        extent: [u32; 2],
        entries: Vec<Entry>,
    ) -> Self {
        let exact = spec.source == Source::Made("card");
        Self {
            study,
            scene: spec.name.clone(),
            light: light.into(),
            stage: Stage::Seen(spec.clone(), light.into()),
            extent,
            against: if exact { Against::Card } else { Against::Traced },
            at: None,
            entries,
        }
    }

    /// The name under which it is stored: what it measures, and nothing that only orders it.
    pub fn key(&self) -> String {
        let at = self.at.map_or_else(String::new, |at| format!(", {at}"));
        format!("{}: {}, {} light{at}", self.study, self.scene, self.light)
    }

    /// Loads or makes the scene and the view.
    pub fn ready(&self) -> Result<Ready, Problem> {
        match &self.stage {
            Stage::Seen(spec, light) => {
                let scene = spec.load(light)?;
                let [width, height] = self.extent.map(f64::from);
                let camera =
                    scene.camera.unwrap_or_else(|| Camera::framing(&scene, width / height));
                let view = View::of(&camera, self.extent);
                // The others' errors are compared with those of earlier reports, and of the table of `auto`.
                let normals = spec.is_whole();
                Ok(Ready { scene, view, window: None, occluders_seen: true, normals })
            }
            Stage::Moved { model, light, by, half, reach } => {
                let mut scene = scenes::made(model, scenes::square(*light)?)?;
                scenes::move_blocks(&mut scene, DMat4::from_translation(*by));
                let window = Some(window(&scene, *reach));
                Ok(Ready {
                    scene,
                    view: ground(*half),
                    window,
                    occluders_seen: false,
                    normals: false,
                })
            }
            Stage::Walk { scene: name, light, .. } => {
                let spec = SceneSpec { name: (*name).into(), source: Source::Place(name) };
                Group::seen(self.study, &spec, light, self.extent, Vec::new()).ready()
            }
            Stage::Sphere(rows) => {
                let mut object = Scene::default();
                let mesh = generate::uv_sphere(0.5, rows + 1, *rows);
                object.add("sphere", mesh, DMat4::IDENTITY, Role::Occluder);
                let scene = generate::normalized(&object, scenes::square(0.4)?)?;
                let view = ground(2.2);
                Ok(Ready { scene, view, window: None, occluders_seen: false, normals: false })
            }
        }
    }
}

/// A regular grid on the ground, seen from 8 m above it.
///
/// It is turned by 20°: the edge of an aligned card's shadow would else pass every pixel of a row at
/// one distance, so that the mean over the row were one sample, and none of it inside the penumbra
/// of a small light.
fn ground(half: f64) -> View {
    let turn = DMat4::from_rotation_y(20f64.to_radians());
    View { clip_from_world: View::map_of_ground(half, 8.0).clip_from_world * turn }
}

/// The tangents that just hold a disc of diameter √2 · 1.05 at the object's top, as in the table that
/// tests/accuracy.rs holds. The node's own fit would put the aligned card's edges on texel borders,
/// where its error is 0, which no object in a scene of many has.
fn window(scene: &Scene, reach: f64) -> [[f64; 2]; 2] {
    let top = scene.bounds(|i| i.role.blocks()).map_or(0.0, |b| b.max.y);
    let tan = (0.5 * 2f64.sqrt() * 1.05 + reach) / (4.0 - top).max(0.1);
    [[-tan; 2], [tan; 2]]
}
