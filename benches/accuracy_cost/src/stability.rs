//! How still a shadow stays while the camera moves.
//!
//! ```text
//!    frame k        frame k+1      P, a still point of a surface, is what the middle of a pixel shows in frame k. It
//!    ┌─┬─┬─┐        ┌─┬─┬─┐        counts where the next frame has it within a quarter of a pixel from the middle of
//!    │ │P│ │        │ │ │ │        one that shows the same surface; what that pixel shows is Q.
//!    ├─┼─┼─┤        ├─┼─┼─┤
//!    │ │ │ │        │ │PQ │        change         |v(Q) − v(P)|, v the image at the two pixels
//!    └─┴─┴─┘        └─┴─┴─┘        truth's change |t(Q) − t(P)|, t traced at both places
//!                                  error's change |(v(Q) − t(Q)) − (v(P) − t(P))|
//! ```
//! An image must change where P and Q lie on different sides of the edge of a shadow, and the truth's change says how
//! much. The error's change is what a technique adds: v(Q) − t(Q) + t(P) is what it shows of P itself in the second frame.
//! The truth has the same random numbers at P and Q, so that its noise is mostly the same. Nothing is subtracted from
//! either but that.
//!
//! Points that face away from the light are left out: nobody sees what is wrong there. All else counts, lit or not.

use crate::Problem;
use crate::groups::{Entry, Group, Ready, Stage};
use crate::measure::{Bench, template};
use crate::options::Scale;
use crate::places::{self, ROOM, STREET, SUN};
use crate::stats::quartiles;
use crate::store::{Changes, Errors, Outcome, Row, Times};
use crate::techniques::{Method, method};
use crate::truth;
use antumbra::truth::{ErrorSummary, Receiver, Sampling, Tracer, seen_error};
use antumbra::{Light, Technique};
use antumbra_harness::{View, shade};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// The study's name.
pub const STABILITY: &str = "stability";

/// The curves: one view, and as many as there are by default.
pub const CURVES: [&str; 2] = ["one view", "default views"];

/// Every so many pixels along each side one is a point.
const APART: usize = 2;

/// How far from the middle of a pixel a point may be in the next frame, in pixels.
const BESIDE: f64 = 0.25;

/// Rays a point of the truth: noise of a hundredth in a penumbra, most of which is the same in the next frame.
const RAYS: u32 = 256;

/// How far from a point's plane what a pixel shows may lie, over its distance from the eye, and the least cosine
/// between their normals, for both to be the same surface.
const SAME_PLANE: f64 = 1e-3;
const SAME_NORMAL: f64 = 0.99;

/// The groups: a walk along a street under a sun, and one through a room.
pub fn all(scale: &Scale) -> Vec<Group> {
    let (frames, techniques): (usize, &[&str]) = match scale.quick {
        true => (24, &["ray-march", "pcss"]),
        false => (200, &["ray-march", "soft-shadow-map", "pcss", "hard", "traced"]),
    };
    let entries = techniques.iter().flat_map(|&technique| {
        let one = Entry::new(technique, CURVES[0], "views=1".into(), 1.0);
        let default = Entry::new(technique, CURVES[1], String::new(), 2.0);
        // What looks at triangles has no views.
        let both = [Some(one).filter(|_| technique != "traced"), Some(default)];
        both.into_iter().flatten()
    });
    let entries: Vec<Entry> = entries.collect();
    let of = |(scene, light): (&'static str, &str)| Group {
        study: STABILITY,
        scene: scene.into(),
        light: light.into(),
        stage: Stage::Walk { scene, light: light.into(), frames },
        extent: [160, 120],
        against: crate::groups::Against::Traced,
        at: None,
        entries: entries.clone(),
    };
    let scenes = [(STREET, SUN), (ROOM, "ceiling panel")];
    scenes.into_iter().take(if scale.quick { 1 } else { scenes.len() }).map(of).collect()
}

/// A point in a frame and in the next.
#[derive(Clone, Copy)]
struct Pair {
    /// The pixels that show it.
    pixels: [usize; 2],
    /// The truth at what they show.
    truth: [f32; 2],
    /// The unshadowed irradiance in the first frame.
    irradiance: f64,
}

/// The frames of a walk, and the points of each that the next one shows too.
struct Walk<'a> {
    ready: &'a Ready,
    light: Light,
    extent: [u32; 2],
    views: Vec<View>,
    pairs: Vec<Vec<Pair>>,
}

/// What a frame's pixels show.
struct Shown {
    receivers: Vec<Receiver>,
    irradiance: Vec<f64>,
}

/// Measures a walk with every entry.
pub fn measure(bench: &Bench, group: &Group, say: &dyn Fn(&str)) -> Result<Vec<Row>, Problem> {
    let Stage::Walk { scene, frames, .. } = &group.stage else {
        return Err("it is no walk".into());
    };
    let made = places::made(scene).ok_or_else(|| format!("no scene is called {scene}"))?;
    let ready = group.ready()?;
    let light = ready.scene.light(None)?.clone();
    let at = |i: usize| i as f64 / (*frames - 1).max(1) as f64;
    let views = (0..*frames).map(|i| View::of(&(made.walk)(at(i)), group.extent)).collect();
    let (extent, pairs) = (group.extent, Vec::new());
    let mut walk = Walk { ready: &ready, light: light.light, extent, views, pairs };
    say("points and truth");
    walk.look(bench)?;
    let template = template(group, &ready, &light);
    let row = |entry: &Entry| {
        say(&format!("{} {}", entry.technique, entry.words));
        let outcome = match walk.follow(bench, entry) {
            Ok(Some((errors, times))) => Outcome::Measured { errors, times },
            Ok(None) => Outcome::NotThere,
            Err(problem) => Outcome::Failed(problem.0),
        };
        Row { outcome, ..template.of(entry) }
    };
    Ok(group.entries.iter().map(row).collect())
}

impl Walk<'_> {
    /// Finds the points of each frame that the next one shows, and traces them.
    fn look(&mut self, bench: &Bench) -> Result<(), Problem> {
        let mut stage = self.ready.stage(bench.device, self.extent, Technique::default())?;
        let tracer = Tracer::new(&self.ready.scene)?;
        let mut before: Option<Shown> = None;
        for view in &self.views {
            let shown = self.shown(&mut stage, view)?;
            if let Some(before) = before.take() {
                let sampling = truth::sampling(Sampling::new(RAYS, 1), &shown.receivers)?;
                let truth = |receiver: &Receiver, stream: usize| {
                    let of =
                        tracer.visible_fraction(self.light, receiver, &sampling, stream as u64);
                    of.map(|of| of.visible as f32)
                };
                let pair = |first: usize| {
                    let point = before.receivers[first];
                    let second = pixel_of(view, self.extent, &point, &shown.receivers)?;
                    let both = truth(&point, first)
                        .and_then(|p| Ok([p, truth(&shown.receivers[second], first)?]));
                    let (pixels, irradiance) = ([first, second], before.irradiance[first]);
                    Some(both.map(|truth| Pair { pixels, truth, irradiance }))
                };
                let points = self.points(&before);
                let pairs = points.into_par_iter().filter_map(pair);
                self.pairs.push(pairs.collect::<Result<_, _>>()?);
            }
            before = Some(shown);
        }
        Ok(())
    }

    /// Paints what a view shows.
    fn shown(&self, stage: &mut antumbra_harness::Stage, view: &View) -> Result<Shown, Problem> {
        stage.show(&self.ready.scene, view, |i| self.ready.keeps(i))?;
        let gbuffer = stage.gbuffer();
        let irradiance =
            shade::irradiances(&self.light, &gbuffer.positions()?, &gbuffer.normals()?);
        Ok(Shown { receivers: truth::receivers(gbuffer)?, irradiance })
    }

    /// The pixels whose middles are a frame's points: of a grid those that the light can reach.
    fn points(&self, shown: &Shown) -> Vec<usize> {
        let [width, height] = self.extent.map(|side| side as usize);
        let rows = (0..height).step_by(APART);
        let places = rows.flat_map(|y| (0..width).step_by(APART).map(move |x| y * width + x));
        let seen =
            |i: &usize| shown.irradiance[*i] > 0.0 && shown.receivers[*i].normal != DVec3::ZERO;
        places.filter(seen).collect()
    }

    /// Every frame by a technique.
    fn follow(&self, bench: &Bench, entry: &Entry) -> Result<Option<(Errors, Times)>, Problem> {
        let settings = match method(entry.technique, &entry.words)? {
            Some(Method::Node(settings)) => *settings,
            Some(_) => return Err("it runs without a node, whose frames are followed here".into()),
            None => return Ok(None),
        };
        let mut stage = self.ready.stage(bench.device, self.extent, settings)?;
        let (mut images, mut ms, mut record) = (Vec::new(), Vec::new(), Vec::new());
        for view in &self.views {
            stage.show(&self.ready.scene, view, |i| self.ready.keeps(i))?;
            let plan = stage.plan(self.light, None)?;
            let times = stage.run(&plan)?;
            ms.push(times.frame.as_secs_f64() * 1e3);
            record.push(times.record.as_secs_f64() * 1e6);
            images.push(stage.visibility()?);
        }
        let times = Times {
            // The first frame compiles what the driver compiles.
            frame_ms: quartiles(ms.get(1..).unwrap_or_default()),
            frames: ms.len().saturating_sub(1),
            record_us: quartiles(&record)[1],
            gpu_bytes: stage.node()?.memory().iter().map(|r| r.bytes).sum(),
            passes: Vec::new(),
        };
        let all = || {
            self.pairs.iter().zip(&images).flat_map(|(p, image)| p.iter().map(move |p| (p, image)))
        };
        let truth: Vec<f32> = all().map(|(pair, _)| pair.truth[0]).collect();
        let image: Vec<f32> = all().map(|(pair, image)| image[pair.pixels[0]]).collect();
        let irradiance: Vec<f64> = all().map(|(pair, _)| pair.irradiance).collect();
        let errors = Errors {
            summary: ErrorSummary::between(&truth, &image, None)?,
            seen_error: Some(seen_error(&truth, &image, &irradiance, None)?),
            changes: Some(Box::new(changes(&self.pairs, &images))),
            ..Errors::default()
        };
        Ok(Some((errors, times)))
    }
}

/// The pixel whose middle is near a point, where that shows the same surface.
fn pixel_of(
    view: &View,
    [width, height]: [u32; 2],
    still: &Receiver,
    shown: &[Receiver],
) -> Option<usize> {
    let clip = view.clip_from_world * still.position.extend(1.0);
    let at = (clip.truncate() / clip.w).truncate() * 0.5 + 0.5;
    let inside = clip.w > 0.0 && (0.0..1.0).contains(&at.x) && (0.0..1.0).contains(&at.y);
    if !inside {
        return None;
    }
    let at = at * DVec2::new(f64::from(width), f64::from(height));
    if (at - at.floor() - 0.5).length() > BESIDE {
        return None;
    }
    let pixel = at.y as usize * width as usize + at.x as usize;
    let Receiver { position, normal } = shown[pixel];
    let beside = still.normal.dot(position - still.position).abs();
    let same = beside <= SAME_PLANE * clip.w && still.normal.dot(normal) >= SAME_NORMAL;
    same.then_some(pixel)
}

/// The changes of what both frames of each pair show.
fn changes(pairs: &[Vec<Pair>], images: &[Vec<f32>]) -> Changes {
    let (mut of_image, mut of_truth, mut of_error) = (Vec::new(), Vec::new(), Vec::new());
    for (pairs, images) in pairs.iter().zip(images.windows(2)) {
        for Pair { pixels: [p, q], truth: [t, u], .. } in pairs {
            let change = f64::from(images[1][*q]) - f64::from(images[0][*p]);
            let truth = f64::from(*u) - f64::from(*t);
            of_image.push(change.abs());
            of_truth.push(truth.abs());
            of_error.push((change - truth).abs());
        }
    }
    let [change, truth_change, error_change] = [of_image, of_truth, of_error].map(spread);
    Changes {
        pairs: change.count,
        change_mean: change.mean,
        change_p99: change.p99,
        change_p999: change.p999,
        change_worst: change.worst,
        truth_change_mean: truth_change.mean,
        truth_change_p99: truth_change.p99,
        truth_change_p999: truth_change.p999,
        truth_change_worst: truth_change.worst,
        error_change_mean: error_change.mean,
        error_change_p99: error_change.p99,
        error_change_p999: error_change.p999,
        error_change_worst: error_change.worst,
    }
}

struct Spread {
    count: usize,
    mean: f64,
    p99: f64,
    p999: f64,
    worst: f64,
}

/// Mean, 99th and 99.9th percentile (nearest rank) and largest; 0 of none.
fn spread(mut values: Vec<f64>) -> Spread {
    values.sort_unstable_by(f64::total_cmp);
    let count = values.len();
    let at = |rank: usize| rank.checked_sub(1).map_or(0.0, |i| values[i]);
    Spread {
        count,
        mean: values.iter().sum::<f64>() / count.max(1) as f64,
        p99: at((count * 99).div_ceil(100)),
        p999: at((count * 999).div_ceil(1000)),
        worst: at(count),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair(pixels: [usize; 2], truth: [f32; 2]) -> Pair {
        Pair { pixels, truth, irradiance: 1.0 }
    }

    /// Three frames of two pixels: what the first shows in its pixel 0 the second shows in its pixel 1, and so on.
    #[test]
    fn an_error_that_stays_is_no_change_and_one_that_comes_and_goes_is() {
        let pairs = [
            vec![pair([0, 1], [0.5, 0.75])],
            vec![pair([1, 0], [0.75, 0.75]), pair([0, 1], [1.0, 1.0])],
        ];
        let right = [vec![0.5, 9.0], vec![1.0, 0.75], vec![0.75, 1.0]];
        let of = |images: &[Vec<f32>]| changes(&pairs, images);
        let same = of(&right);
        assert_eq!((same.pairs, same.change_worst, same.truth_change_worst), (3, 0.25, 0.25));
        assert_eq!((same.error_change_worst, same.error_change_mean), (0.0, 0.0));
        let darker = right.clone().map(|image| image.iter().map(|v| v - 0.125).collect());
        assert_eq!(of(&darker).error_change_worst, 0.0);
        let mut flickers = right;
        flickers[2][0] = 0.25;
        let found = of(&flickers);
        assert_eq!((found.error_change_worst, found.error_change_p999), (0.5, 0.5));
        assert_eq!((found.change_worst, found.error_change_mean), (0.5, 0.5 / 3.0));
        assert_eq!(of(&[]).pairs, 0);
    }

    /// A point is found in the pixel that shows it, and not where something stands before it.
    #[test]
    fn a_point_is_seen_where_its_own_surface_is() {
        let camera = (places::made(STREET).unwrap().walk)(0.0);
        let view = View::of(&camera, [8, 6]);
        let inverse = view.clip_from_world.inverse();
        let on_ground = |x: f64, y: f64| {
            let at = |depth| inverse.project_point3(DVec3::new(x, y, depth));
            let (near, far) = (at(0.9), at(0.01));
            near + (far - near) * (near.y / (near.y - far.y))
        };
        let middle = |pixel: usize| {
            let (x, y) = ((pixel % 8) as f64, (pixel / 8) as f64);
            on_ground((x + 0.5) / 4.0 - 1.0, (y + 0.5) / 3.0 - 1.0)
        };
        // The lowest row of pixels looks at the ground.
        let pixel = 5 * 8 + 3;
        let receiver = |position| Receiver { position, normal: DVec3::Y };
        let mut shown: Vec<_> = (0..48).map(|i| receiver(middle(i))).collect();
        let still = receiver(middle(pixel) + DVec3::new(0.01, 0.0, 0.01));
        let found = |shown: &[Receiver]| pixel_of(&view, [8, 6], &still, shown);
        assert_eq!(found(&shown), Some(pixel));
        let aside = receiver(middle(pixel).midpoint(middle(pixel + 1)));
        assert_eq!(pixel_of(&view, [8, 6], &aside, &shown), None, "half a pixel away");
        shown[pixel].position.y += 0.05;
        assert_eq!(found(&shown), None);
        shown[pixel].position.y -= 0.05;
        shown[pixel].normal = DVec3::X;
        assert_eq!(found(&shown), None);
        let behind = receiver(camera.world_from_view.w_axis.truncate() + DVec3::Z);
        assert_eq!(pixel_of(&view, [8, 6], &behind, &shown), None);
    }
}
