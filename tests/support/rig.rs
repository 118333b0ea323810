//! One stage that evaluates random scenes: a node of several settings, its lights a batch of images in one submit.

use crate::random::{Case, Lamp, Object, SIDE, Shape, meshes};
use antumbra::Omit;
use antumbra::knob::{Knob, Values};
use antumbra::scene::{Role, Scene};
use antumbra::techniques::linear_light::Across;
use antumbra::{LightIndex, TechniqueIndex};
use antumbra::{MeshInstance, Technique};
use antumbra_harness::{GBufferPainter, HeadlessDevice, SceneBuffers, Stage, View};
use glam::DMat4;

/// Images a submit.
const BATCH: u32 = 16;

/// One image to be made of the painted pixels.
#[derive(Clone, Debug)]
pub struct Shot {
    /// Which of the rig's settings, 0 and up.
    pub settings: usize,
    /// The light.
    pub lamp: Lamp,
    /// What blocks or receives.
    pub meshes: Vec<MeshInstance>,
    /// How the pixels look at it; [`Rig::look`] has painted their depths.
    pub world_from_ndc: DMat4,
}

impl Shot {
    /// All of it somewhere else, its pixels too.
    #[must_use]
    pub fn under(&self, change: &DMat4) -> Self {
        let place =
            |m: &MeshInstance| MeshInstance { world_from_mesh: *change * m.world_from_mesh, ..*m };
        Self {
            settings: self.settings,
            lamp: self.lamp.under(change),
            meshes: self.meshes.iter().map(place).collect(),
            world_from_ndc: *change * self.world_from_ndc,
        }
    }

    /// The same under another lamp.
    #[must_use]
    pub fn under_lamp(&self, lamp: Lamp) -> Self {
        Self { lamp, ..self.clone() }
    }

    /// The same as other settings see it.
    #[must_use]
    pub fn with_settings(&self, settings: usize) -> Self {
        Self { settings, ..self.clone() }
    }

    /// The same with one mesh more.
    #[must_use]
    pub fn and(&self, mesh: MeshInstance) -> Self {
        let mut more = self.clone();
        more.meshes.push(mesh);
        more
    }
}

/// A node, its pixels, and the meshes that random scenes are made of.
pub struct Rig {
    stage: Stage,
    painter: GBufferPainter,
    /// Meshes alone: instances come with each case.
    scene: Scene,
    buffers: SceneBuffers,
    /// A mesh a shape, at the origin.
    shapes: Vec<MeshInstance>,
    settings: Vec<Technique>,
}

impl Rig {
    /// A node of up to eight settings, that leaves out what `omit` lets it.
    ///
    /// # Panics
    /// If the device refuses.
    pub fn new(device: &HeadlessDevice, settings: &[Technique], omit: Omit) -> Self {
        let mut scene = Scene { meshes: meshes(), ..Scene::default() };
        let buffers = SceneBuffers::new(device, &scene).unwrap();
        let identity = DMat4::IDENTITY;
        let unit =
            |&shape| Object { shape, world_from_mesh: identity, role: Role::Both }.instance();
        scene.instances = Shape::ALL.iter().map(unit).collect();
        let shapes = buffers.instances(&scene);
        let view = View { clip_from_world: identity };
        let mut stage =
            Stage::new(device, &scene, &view, [SIDE; 2], settings[0], |_| false).unwrap();
        let made = stage.configure_with(settings[0], |description| {
            description.other_techniques = settings[1..].to_vec();
            description.lights = BATCH;
            description.omit = omit;
        });
        made.unwrap_or_else(|e| panic!("{e}: {settings:?}"));
        let painter = GBufferPainter::new(device).unwrap();
        Self { stage, painter, scene, buffers, shapes, settings: settings.into() }
    }

    /// The settings, in their order.
    pub fn settings(&self) -> &[Technique] {
        &self.settings
    }

    /// Paints what a case's pixels see.
    ///
    /// # Panics
    /// If the device refuses.
    pub fn look(&mut self, case: &Case) {
        self.scene.instances = case.instances();
        let keep = |i: &antumbra::scene::Instance| i.role != Role::Occluder;
        let Self { stage, painter, scene, buffers, .. } = self;
        painter.paint(stage.gbuffer(), scene, buffers, &case.view(), keep).unwrap();
    }

    /// An object as the node takes it.
    pub fn mesh(&self, object: &Object) -> MeshInstance {
        let place = Shape::ALL.iter().position(|s| *s == object.shape).unwrap_or(0);
        let Object { world_from_mesh, role, .. } = *object;
        MeshInstance { world_from_mesh, role, ..self.shapes[place] }
    }

    /// What takes an object's place without blocking anything: its box with nothing in it.
    pub fn ghost(&self, object: &Object) -> MeshInstance {
        let nothing = self.mesh(&Object { shape: Shape::Point, ..*object });
        MeshInstance { geometry: nothing.geometry, ..self.mesh(object) }
    }

    /// A case as one of the settings sees it.
    pub fn shot(&self, settings: usize, case: &Case) -> Shot {
        let objects = case.planes.iter().chain(&case.objects);
        Shot {
            settings,
            lamp: case.lamp,
            meshes: objects.map(|o| self.mesh(o)).collect(),
            world_from_ndc: case.clip_from_world.inverse(),
        }
    }

    /// The visible fractions of every shot, row by row.
    ///
    /// # Panics
    /// If a frame is refused.
    pub fn images(&mut self, shots: &[Shot]) -> Vec<Vec<f32>> {
        let mut images = Vec::with_capacity(shots.len());
        for batch in shots.chunks(BATCH as usize) {
            let plan = |(light, shot): (u32, &Shot)| {
                let planned = self.stage.plan_with(shot.lamp.light(), |frame| {
                    frame.light_index = LightIndex(light);
                    frame.technique_index = TechniqueIndex(shot.settings as u32);
                    frame.meshes = &shot.meshes;
                    frame.world_from_ndc = shot.world_from_ndc;
                });
                planned.unwrap_or_else(|e| panic!("{e}: {shot:?}"))
            };
            let plans: Vec<_> = (0..).zip(batch).map(plan).collect();
            self.stage.run_all(&plans).unwrap();
            images.extend(
                (0..)
                    .zip(batch)
                    .map(|(light, _)| self.stage.visibility_under(LightIndex(light)).unwrap()),
            );
        }
        images
    }
}

/// Random numbers for settings: SplitMix64.
#[derive(Clone, Debug)]
pub struct Random(pub u64);

impl Random {
    /// 0 to 1.
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// 0 to below `n`.
    pub fn below(&mut self, n: usize) -> usize {
        (self.unit() * n as f64) as usize
    }
}

/// Most of a knob that random settings take, where its whole range takes too long here.
const MOST: [(&str, f64); 4] =
    [("receiver_map", 40.0), ("samples", 12.0), ("lines", 2.0), ("rays", 40.0)];

/// A technique with every knob anywhere in its range, but for what costs much ([`MOST`]), and up to so many views.
///
/// # Panics
/// Where a range is none.
pub fn random_settings(plain: Technique, views: u32, random: &mut Random) -> Technique {
    loop {
        let mut technique = plain.with_map(16 + random.below(18) as u32).unwrap();
        for knob in plain.knobs().iter().filter(|k| k.key != "map") {
            let value = match knob.key {
                "views" => views.to_string(),
                _ => random_value(knob, random),
            };
            technique.set(knob.key, &value).unwrap_or_else(|e| panic!("{e}"));
        }
        // A rectangle has four edges.
        if let Technique::LinearLight(lines) = &mut technique
            && lines.across == Across::Edges
        {
            lines.lines = 4;
            lines.samples = lines.samples.min(3);
        }
        if technique.check().is_ok() {
            return technique;
        }
    }
}

fn random_value(knob: &Knob, random: &mut Random) -> String {
    let (least, mut most) = match knob.values {
        Values::Switch => return ["on", "off"][random.below(2)].into(),
        Values::Choice(names) => return names[random.below(names.len())].into(),
        Values::Whole(least, most) => (f64::from(least), f64::from(most)),
        // As the range is written: its ends are decimal.
        Values::Real(least, most) => [least, most].map(|x| x.to_string().parse().unwrap()).into(),
    };
    if let Some((_, cap)) = MOST.iter().find(|(key, _)| *key == knob.key) {
        most = most.min(*cap);
    }
    let t = random.unit();
    if matches!(knob.values, Values::Real(..)) {
        // Real numbers from 0 up: each power as often, and 0 itself.
        return if t < 0.2 {
            "0".into()
        } else {
            format!("{:e}", most * 10f64.powf(-5.0 * random.unit()))
        };
    }
    // Whole ones: each power as often.
    let value = (least + 1.0).ln() + t * ((most + 1.0).ln() - (least + 1.0).ln());
    format!("{}", (value.exp() - 1.0).round().clamp(least, most))
}

/// The technique and its knobs as a command line has them.
pub fn words(technique: &Technique) -> String {
    format!("technique={technique}")
}
