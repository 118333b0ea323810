//! The truth of a group's pixels: what every technique's image is compared with.

use crate::Problem;
use crate::groups::Against;
use antumbra::scene::{Role, Scene};
use antumbra::truth::{Receiver, Sampling, Traced, Tracer, visible_fraction_of_quad};
use antumbra_harness::GBuffer;
use glam::DVec3;
use rayon::prelude::*;

/// The random numbers of the truth; the ray tracer that is measured takes others, since the same
/// numbers would err alike.
const SEED: u64 = 1;

/// What each pixel of a G-buffer shows: position and normal, without a normal where nothing receives.
pub fn receivers(gbuffer: &GBuffer) -> Result<Vec<Receiver>, Problem> {
    let positions = gbuffer.positions()?;
    let normals = gbuffer.normals()?;
    let roles = gbuffer.roles()?;
    let wide = |a: &[f32; 4]| DVec3::new(a[0].into(), a[1].into(), a[2].into());
    let pixels = positions.iter().zip(&normals).zip(&roles);
    let receiver = |((p, n), role): ((&[f32; 4], &[f32; 4]), &u8)| Receiver {
        position: wide(p),
        normal: if *role == 0 { DVec3::ZERO } else { wide(n) },
    };
    Ok(pixels.map(receiver).collect())
}

/// The error in metres of positions read from an f32 image: half a unit in the last place of the largest coordinate.
pub fn position_error(receivers: &[Receiver]) -> f64 {
    let largest = receivers.iter().map(|r| r.position.abs().max_element()).fold(0.0, f64::max);
    largest / f64::from(1 << 24)
}

/// What positions read from an f32 image add to a sampling.
pub fn sampling(
    rays: Result<Sampling, antumbra::Error>,
    receivers: &[Receiver],
) -> Result<Sampling, Problem> {
    Ok(rays.and_then(|s| s.with_position_error(position_error(receivers)))?)
}

/// The card's corners in the world, around its rim.
fn card_corners(scene: &Scene) -> Result<[DVec3; 4], Problem> {
    let mut corners: Vec<DVec3> = scene.world_positions(|i| i.role == Role::Occluder).collect();
    let centre = corners.iter().sum::<DVec3>() / corners.len().max(1) as f64;
    let angle = |p: &DVec3| (p.z - centre.z).atan2(p.x - centre.x);
    corners.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    corners.try_into().map_err(|_| "the closed form wants one card of four corners".into())
}

/// The truth in closed form, which has no noise, or traced, as `against` says.
pub fn truth(
    scene: &Scene,
    tracer: &Tracer,
    receivers: &[Receiver],
    against: Against,
    rays: u32,
) -> Result<Traced, Problem> {
    let light = scene.light(None)?.light;
    match against {
        Against::Card => {
            let card = card_corners(scene)?;
            let seen = |r: &Receiver| match r.normal == DVec3::ZERO {
                true => 1.0,
                false => visible_fraction_of_quad(light.rectangle(), card, r.position) as f32,
            };
            let visible = receivers.par_iter().map(seen).collect();
            Ok(Traced { visible, noise: 0.0, penumbra: 0, rays: 0 })
        }
        Against::Traced => {
            let sampling = sampling(Sampling::new(rays, SEED), receivers)?;
            Ok(tracer.visible_fractions(light, receivers, &sampling)?)
        }
    }
}

/// Whether each pixel shows a receiver.
pub fn mask(receivers: &[Receiver]) -> Vec<bool> {
    receivers.iter().map(|r| r.normal != DVec3::ZERO).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes;

    #[test]
    fn the_cards_two_truths_agree_within_the_noise_that_is_reported() {
        let scene = scenes::made("card", scenes::square(0.4).unwrap()).unwrap();
        let at = |i: u32| DVec3::new(f64::from(i) * 0.05, 0.0, 0.0);
        let receiver = |i| Receiver { position: at(i), normal: DVec3::Y };
        let receivers: Vec<Receiver> = (0..64).map(receiver).collect();
        let tracer = Tracer::new(&scene).unwrap();
        let of = |against| truth(&scene, &tracer, &receivers, against, 512).unwrap();
        let (exact, traced) = (of(Against::Card), of(Against::Traced));
        for (a, b) in exact.visible.iter().zip(&traced.visible) {
            assert!((a - b).abs() <= 6.0 * traced.noise as f32 + 1e-6, "{a} {b}");
        }
    }
}
