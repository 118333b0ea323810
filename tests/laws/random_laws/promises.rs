//! What each technique promises of a law, and why.

use antumbra::Technique;
use antumbra::stages::depth_layers::Projection;
use antumbra::techniques::occlusion_textures::{Combine, Placement, Prefilter};
use antumbra::techniques::soft_shadow_map::Accumulate;

/// What is continuous changes by less when its inputs are rounded otherwise. A position 5 m away is rounded to
/// 2⁻²⁴ of that, and the closest occluders are seen ten times as large and more on the light: under 2⁻¹² of it.
pub const SMOOTH: f64 = 1.0 / 4096.0;

/// The same of slices that are put where faces are: these are counted in 960 bins of the distance, and where a face's
/// rounding takes it to the next one, planes of slices move by a bin or two, and with them the rims of all kernels. So it
/// is where several views look at what is near: a face counts for the share that the slice of its bin does not.
pub const A_BIN: f64 = 1.0 / 128.0;

/// How much is rounding; where a gather may be off by its tolerance, it may be so on either side, as other texels
/// make a node.
pub fn smooth(settings: &Technique) -> f64 {
    match settings {
        Technique::OcclusionTextures(s)
            if s.placement == Placement::Fitted
                || (s.combine, s.prefilter) == (Combine::Correlated, Prefilter::Sat)
                    && s.views > 1 =>
        {
            A_BIN
        }
        Technique::SoftShadowMap(s) => SMOOTH + 2.0 * f64::from(s.tolerance),
        // A sample at the very edge of a triangle is seen or hidden.
        Technique::Traced(s) => 2.0 / f64::from(s.rays.min(s.samples.side().pow(2))),
        _ => SMOOTH,
    }
}

/// How many pixels of an image may change more than that. Rasters put vertices on a grid of 2⁻⁴ to 2⁻⁸ texels:
/// what is rounded otherwise takes the next place on it once in some ten thousand times, and an edge then gains or
/// loses a texel. One of something close to the light shadows as much as all the rest.
pub const ONE_TEXEL: f64 = 0.5;

/// And how many of all pixels of a law's images: that happens in fewer than one image in fifty.
pub const FEW_TEXELS: f64 = 2e-3;

/// The same under mirrors. A raster that moves vertices by up to 2⁻⁴ texels (four bits are what Vulkan asks for) need
/// not move them the other way there: of the texels at an edge one in 16 is won or lost, and 4/24 of a map of 24² are
/// at the edge of what fills it.
pub const FEW_TEXELS_MIRRORED: f64 = 4.0 / 24.0 / 16.0;

/// How an image of the same scene differs, turned, mirrored or seen with other random numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Likeness {
    /// By rounding alone ([`SMOOTH`], [`ONE_TEXEL`]).
    Rounding,
    /// By the noise of so many samples, which is as often too much as too little.
    Noise(u32),
    /// By no more than this in the mean over pixels that are not lit.
    Mean(f64),
}

/// A scene mirrored, or a light whose axes are told of otherwise.
pub fn turned(settings: &Technique) -> Likeness {
    match settings {
        Technique::Hard(_) | Technique::OcclusionTextures(_) => Likeness::Rounding,
        Technique::SoftShadowMap(s) if s.accumulate != Accumulate::BlendFp16 => Likeness::Rounding,
        // Patches are added in another order: up to map² times half a step of 2⁻¹¹ off, an eighth of that here.
        Technique::SoftShadowMap(_) => Likeness::Mean(0.02),
        // Samples are where others were: the disc's taps and the points have no symmetry.
        Technique::Pcss(_) => Likeness::Mean(0.1),
        Technique::ManyLights(s) => Likeness::Noise(s.samples),
        Technique::RayMarch(s) => Likeness::Noise(s.rays),
        // A texel is widened to its right and lower neighbours, which were its left and upper ones: an occluder's
        // edge moves by part of a texel.
        Technique::BackProjection(_) => Likeness::Mean(0.03),
        // Samples are put one after the other, the first of two as good ones first.
        Technique::LinearLight(_) => Likeness::Mean(0.03),
        // The grid of samples is turned, and its mirror image is another.
        Technique::Traced(s) => Likeness::Noise(s.rays.min(s.samples.side().pow(2))),
        other => panic!("{other}: no promise yet"),
    }
}

/// Whether another occluder may raise the visible fraction where the maps' texels stay as they are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rise {
    /// By no more than this: each texel, slice or point only gains what blocks, and what is made of them only falls by
    /// that.
    By(f64),
    /// By the technique's model, which keeps a face or two of each texel: a new one takes the place of what was
    /// there. A known fault.
    Hides,
}

/// Another occluder anywhere.
pub fn with_another(settings: &Technique) -> Rise {
    match settings {
        // Nearer surfaces hide what is behind them for one point of the light, and so they should. Of several views from
        // the light's centre, what is nearest decides which one serves a receiver.
        Technique::Hard(s) if s.views > 1 => Rise::Hides,
        Technique::Hard(_) | Technique::ManyLights(_) => Rise::By(SUMMED),
        // Every face is counted, in slices that stay. What lies behind slices that hide all but 1/1024 is not asked
        // for. Fitted ones move, and what slices have in common is a guess.
        Technique::OcclusionTextures(s)
            if s.placement == Placement::Uniform && s.combine != Combine::Correlated =>
        {
            Rise::By(1.0 / 1024.0 + SUMMED)
        }
        // Each triangle only adds to what is hidden. With it the hierarchy's origin moves, and a sample at the very edge of
        // another triangle may be seen; and where its tile sends rays from then on, these must go to all samples.
        Technique::Traced(s) if s.rays >= s.samples.side().pow(2) => Rise::By(4.0 / 64.0),
        _ => Rise::Hides,
    }
}

/// How much higher the visible fraction may be in the mean of all pixels with an occluder more.
pub const HIDES: f64 = 0.01;

/// How far the mean of a light's halves is from the whole light, as a mean over pixels that are not lit by all
/// three. Halves are seen from elsewhere, so each of the three images is off by an error of its own on such scenes:
/// maps of 16² to 33² texels, things that cross and touch, are open and lie one behind the other. Half as much again
/// as was measured on either driver.
pub fn halves(settings: &Technique) -> f64 {
    match settings {
        // It sees the light's centre alone, and halves have others: a known fault, small where lights are.
        Technique::Hard(_) => 0.11,
        // One distance for all blockers, of which each half sees others.
        Technique::Pcss(_) => 0.25,
        // Up to twelve points, and others for the halves: the noise of a dozen is 0.16.
        Technique::ManyLights(_) => 0.16,
        // Nearest faces alone, of which each half sees others.
        Technique::BackProjection(_) | Technique::SoftShadowMap(_) => 0.21,
        Technique::RayMarch(_) => 0.14,
        Technique::OcclusionTextures(_) => 0.15,
        Technique::LinearLight(_) => 0.08,
        // Few rays may stand for the samples where a tile is dense.
        Technique::Traced(_) => 0.08,
        other => panic!("{other}: no promise yet"),
    }
}

/// The share of pixels beyond a texel of a hard shadow's edges where a light of 0.1 mm differs from it.
pub fn shrunk(settings: &Technique) -> f64 {
    match settings {
        Technique::Hard(_) => 0.0,
        // Slices flatten what is in them: contacts are lost, and edges move by half a slice.
        Technique::OcclusionTextures(_) => 0.1,
        _ => 0.05,
    }
}

/// Sums of a few hundred numbers up to 1, of which each may round otherwise.
pub const SUMMED: f64 = 1e-6;

/// How far from a plane through the light's centre occluders are that are apart, as a tangent.
pub const APART: f64 = 0.1;

/// The most that an occluder which shares no texel with others may raise a pixel; none where neighbours, slices or
/// samples depend on it all the same.
pub fn with_another_elsewhere(settings: &Technique) -> Option<f64> {
    if let Rise::By(bound) = with_another(settings) {
        return Some(bound);
    }
    match settings {
        // What is nearest decides which view serves a receiver.
        Technique::SoftShadowMap(s) if s.views > 1 => None,
        Technique::BackProjection(s) if s.views > 1 => None,
        Technique::RayMarch(s) if s.views > 1 && s.projection == Projection::Centre => None,
        // Texels are added up. A node's closed form is off by the tolerance at most on either side.
        Technique::SoftShadowMap(s) => match s.accumulate {
            Accumulate::Gather => Some(2.0 * f64::from(s.tolerance) + 1e-5),
            // Of map² additions each rounds to 2⁻²⁴.
            Accumulate::Blend => Some(1e-4),
            Accumulate::BlendFp16 => None,
        },
        Technique::BackProjection(_) => Some(1e-5),
        // Each ray stays where it is. What a filter makes of them does not.
        Technique::RayMarch(s) if !s.filter => Some(SUMMED),
        _ => None,
    }
}

/// How much higher the visible fraction may be in the mean of all pixels with an occluder more that is elsewhere.
pub const HIDES_ELSEWHERE: f64 = 5e-3;

/// The mean |difference| of two estimates of so many samples: √2 times the standard deviation of a share of N, which
/// is ½/√N at most, times √(2/π).
pub fn noise(samples: u32) -> f64 {
    0.57 / f64::from(samples).sqrt()
}

/// How much brighter the halves may be than the whole, as a mean over pixels that are not lit by all three.
pub const BRIGHTER: f64 = 0.1;
