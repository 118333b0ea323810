//! A scene under a light, seen by a grid of pixels: the node's visible fraction beside the truth.

use crate::example::root;
use antumbra::scene::{Role, Scene, from_gltf, generate};
use antumbra::truth::{
    ErrorSummary, Exact, ExactLine, PolygonLight, Receiver, Sampling, Traced, Tracer,
    visible_fraction_of_quad,
};
use antumbra::{RectangleLight, Technique};
use antumbra_harness::{HeadlessDevice, Stage, View, technique_of};
use glam::DVec3;
use std::collections::HashMap;
use std::fmt::{self, Write};
use std::hash::{DefaultHasher, Hasher};
use std::sync::{Arc, LazyLock, Mutex, OnceLock, PoisonError};

/// Settings from the words of a command line: `"map=64 sides=one"`, or with a technique first:
/// `"technique=pcss taps=32"`.
///
/// # Panics
/// If a setting is refused.
pub fn settings(words: &str) -> Technique {
    technique_of(words).unwrap_or_else(|e| panic!("{words}: {e}"))
}

/// The card's corners in the world.
fn card_corners(scene: &Scene) -> [DVec3; 4] {
    let corners: Vec<DVec3> = scene.world_positions(|i| i.role == Role::Occluder).collect();
    // Around the rim, whatever the mesh's own order.
    let centre = corners.iter().sum::<DVec3>() / corners.len() as f64;
    let mut corners = corners;
    corners.sort_by(|a, b| {
        let angle = |p: &DVec3| (p.z - centre.z).atan2(p.x - centre.x);
        angle(a).total_cmp(&angle(b))
    });
    corners.try_into().unwrap()
}

/// One of the project's own models.
///
/// # Panics
/// If it cannot be read.
pub fn model(name: &str) -> Scene {
    from_gltf(&root().join(format!("scenes/{name}.glb"))).unwrap()
}

/// Room above a measured error for drivers that place edges differently, in percentage points.
const ABOVE: f64 = 0.3;

/// Whether an error is what a table says was measured, both in percent: it is worse by no more than drivers differ, and
/// better by no more than three tenths and what two digits leave. Where it is much better the table is out of date.
pub fn as_measured(error: f64, measured: f64) -> bool {
    error <= measured + ABOVE && error >= 0.7 * measured - 0.05
}

/// A scene with the pixels that look at it.
pub struct Setup<'a> {
    /// The scene; its first light is used.
    pub scene: &'a Scene,
    /// How pixels look at it.
    pub view: View,
    /// Width and height.
    pub extent: [u32; 2],
    /// Least and largest tangents of the occluder map; fitted without.
    pub window: Option<[[f64; 2]; 2]>,
    /// Whether occluders that do not receive are seen by the pixels.
    pub occluders_seen: bool,
}

impl<'a> Setup<'a> {
    /// A square grid of `side` pixels on the ground, over |x|, |z| ≤ `half`.
    pub fn ground(scene: &'a Scene, half: f64, side: u32) -> Self {
        let view = View::map_of_ground(half, 8.0);
        Self { scene, view, extent: [side; 2], window: None, occluders_seen: false }
    }

    /// The rectangle of the scene's first light.
    pub fn light(&self) -> RectangleLight {
        *self.scene.light(None).unwrap().light.rectangle()
    }

    /// A stage with a node of these settings.
    ///
    /// # Panics
    /// If the node refuses.
    pub fn stage(&self, device: &HeadlessDevice, words: &str) -> Stage {
        let seen = self.occluders_seen;
        let keep = |i: &antumbra::scene::Instance| seen || i.role != Role::Occluder;
        Stage::new(device, self.scene, &self.view, self.extent, settings(words), keep)
            .unwrap_or_else(|e| panic!("{words}: {e}"))
    }

    /// One frame's visible fractions.
    ///
    /// # Panics
    /// If the frame fails.
    pub fn visibility(&self, stage: &mut Stage) -> Vec<f32> {
        let light = self.scene.light(None).unwrap();
        let plan = stage.plan_under(light, self.window).unwrap_or_else(|e| panic!("{e}"));
        stage.run(&plan).unwrap();
        stage.visibility().unwrap()
    }

    /// What each pixel shows: position and normal, without a normal where nothing receives.
    ///
    /// # Panics
    /// If the G-buffer cannot be read.
    pub fn receivers(stage: &Stage) -> Vec<Receiver> {
        let wide = |a: &[f32; 4]| DVec3::new(a[0].into(), a[1].into(), a[2].into());
        let positions = stage.gbuffer().positions().unwrap();
        let normals = stage.gbuffer().normals().unwrap();
        let roles = stage.gbuffer().roles().unwrap();
        positions
            .iter()
            .zip(&normals)
            .zip(&roles)
            .map(|((p, n), role)| Receiver {
                position: wide(p),
                normal: if *role == 0 { DVec3::ZERO } else { wide(n) },
            })
            .collect()
    }

    /// The exact visible fractions behind `generate::card`'s card.
    ///
    /// # Panics
    /// If the scene has another occluder.
    pub fn closed_form_of_card(&self, stage: &Stage) -> Vec<f32> {
        let (light, quad) = (self.light(), card_corners(self.scene));
        let visible = |r: &Receiver| visible_fraction_of_quad(&light, quad, r.position) as f32;
        Self::receivers(stage).iter().map(visible).collect()
    }

    /// The traced visible fractions and their noise; under a line or a polygon the exact ones, which have none.
    ///
    /// # Panics
    /// If the scene cannot be traced.
    pub fn traced(&self, stage: &Stage, rays: u32) -> (Vec<f32>, f64) {
        let (light, receivers) = (self.light(), Self::receivers(stage));
        if light.is_line() {
            let exact = ExactLine::new(self.scene).unwrap();
            let visible = exact.visible_fractions(&light, &receivers).unwrap();
            return (visible.iter().map(|&v| v as f32).collect(), 0.0);
        }
        let whole = self.scene.light(None).unwrap().light;
        if let Some(outline) = whole.outline() {
            let frame = light.world_from_light();
            let place = |&[x, y]: &[f64; 2]| frame.transform_point3(DVec3::new(x, y, 0.0));
            let polygon =
                PolygonLight::new(&outline.iter().map(place).collect::<Vec<_>>()).unwrap();
            let visible = Exact::new(self.scene).unwrap().visible_fractions(&polygon, &receivers);
            return (visible.unwrap().iter().map(|&v| v as f32).collect(), 0.0);
        }
        let truth = truth(self.scene, &receivers, rays);
        (truth.visible.clone(), truth.noise)
    }
}

/// What the rays of the first light say of receivers. Tests of several techniques look at the same pixels: each truth is
/// traced once a program.
///
/// # Panics
/// If the scene cannot be traced.
pub fn truth(scene: &Scene, receivers: &[Receiver], rays: u32) -> Arc<Traced> {
    type Truths = HashMap<u64, Arc<OnceLock<Arc<Traced>>>>;
    static TRUTHS: LazyLock<Mutex<Truths>> = LazyLock::new(Mutex::default);
    let mut key = Words(DefaultHasher::new());
    write!(key, "{scene:?} {receivers:?} {rays}").unwrap();
    let mut truths = TRUTHS.lock().unwrap_or_else(PoisonError::into_inner);
    let truth = Arc::clone(truths.entry(key.0.finish()).or_default());
    drop(truths);
    let traced = truth.get_or_init(|| {
        let light = scene.light(None).unwrap().light;
        let sampling = Sampling::new(rays, 1).unwrap();
        let tracer = Tracer::new(scene).unwrap();
        Arc::new(tracer.visible_fractions(light, receivers, &sampling).unwrap())
    });
    Arc::clone(traced)
}

/// Hashes what is written.
struct Words(DefaultHasher);

impl Write for Words {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.0.write(text.as_bytes());
        Ok(())
    }
}

/// Mean |error| over the pixels in shadow or penumbra, in percent (Atty 2006 section 5.2.1).
///
/// # Panics
/// If the images cannot be compared.
pub fn percent(truth: &[f32], image: &[f32]) -> f64 {
    100.0 * summary(truth, image).mean_abs_error
}

/// The whole comparison.
///
/// # Panics
/// If the images cannot be compared.
pub fn summary(truth: &[f32], image: &[f32]) -> ErrorSummary {
    ErrorSummary::between(truth, image, None).unwrap_or_else(|e| panic!("{e}"))
}

/// A line of one metre, turned out of the maps' rows.
///
/// # Panics
/// Never: the numbers are legal.
pub fn metre_line() -> RectangleLight {
    generate::line_light(1.0, 0.4).unwrap()
}

/// The bunny under the middle line of its own light, a metre long.
///
/// # Panics
/// If the model has no light.
pub fn bunny_under_a_line() -> Scene {
    let mut scene = model("bunny");
    let light = *scene.lights[0].light.rectangle();
    let half = light.world_from_light().transform_vector3(DVec3::X * 0.5);
    let line = RectangleLight::line(light.center(), half, light.emission()).unwrap();
    scene.lights[0].light = line.into();
    scene
}

#[cfg(test)]
mod tests {
    use super::as_measured;

    #[test]
    fn a_table_is_wrong_in_either_direction() {
        assert!(as_measured(1.2, 1.2) && as_measured(1.49, 1.2) && as_measured(0.8, 1.2));
        assert!(!as_measured(1.51, 1.2) && !as_measured(0.78, 1.2) && !as_measured(f64::NAN, 1.2));
    }
}
