//! Every sum beside its f64 twin and the bound that is derived for it in docs/rounding.md.

use antumbra::FramePlan;
use antumbra::graph::Pass;
use antumbra::scene::{Scene, generate};
use antumbra::techniques::soft_shadow_map::twin::{OccluderMap, occlusion};
use antumbra::techniques::soft_shadow_map::{Blocks, GatherMap, PatchDraw};
use antumbra_tests::measure::Setup;
use antumbra_tests::{TestDevice, device};
use ash::vk;
use glam::{DMat4, DVec3};

mod sums;

use sums::{Receiver, Rounding, half, quotients, rounded, stall, threshold};

/// What one addition rounds by at most, as a share of the sum.
const U: f64 = 1.0 / 16_777_216.0;

/// The light's side, m. No number here is round, so that no sum is exact by luck.
const LIGHT: f64 = 0.37;

/// A card parallel to the light at this distance from it, wide enough for any window; the ground is at 4 m.
struct Case {
    distance: f64,
    /// The occluder map's side as a multiple of the light's, as the receiver under its middle sees it: a texel
    /// hides (share / N)² of the light.
    share: f64,
}

/// A texel of N = 4096 hides 2⁻²² of the light.
const HALF_OF_MAP: Case = Case { distance: 1.937, share: 2.0 };
/// The light fills the map: full umbra is the sum of 16 million texels of N = 4096.
const ALL_OF_MAP: Case = Case { distance: 1.937, share: 1.02 };
/// 46 times as near to the receiver as it is to the light, in w.
const NEAR: Case = Case { distance: 3.9137, share: 2.0 };

impl Case {
    fn scene(&self) -> Scene {
        let mut scene = generate::card(generate::square_light(LIGHT).unwrap());
        scene.instances[1].world_from_mesh =
            DMat4::from_translation(DVec3::Y * (4.0 - self.distance))
                * DMat4::from_scale(DVec3::splat(3.0));
        scene
    }

    fn window(&self) -> [[f64; 2]; 2] {
        let half = 0.5 * self.share * LIGHT * (1.0 / self.distance - 0.25);
        [[-half; 2], [half; 2]]
    }

    /// w of the occluder over the distance in w to the receiver: how often an error of the one counts.
    fn condition(&self) -> f64 {
        1.0 / (1.0 - self.distance / 4.0)
    }
}

/// What the device added up, and all that it is made of.
struct Sums {
    w: Vec<f32>,
    side: usize,
    scale: [f32; 2],
    /// t and w of the receiver under the light's middle, and its sum.
    t: [f32; 2],
    w_r: f32,
    sum: f32,
}

fn push<T: bytemuck::AnyBitPattern>(plan: &FramePlan, name: &str) -> T {
    let named = |p: &&Pass| p.name == name;
    bytemuck::pod_read_unaligned(
        plan.plan().graph.passes().iter().find(named).unwrap().push.bytes(),
    )
}

impl Sums {
    fn of(device: &TestDevice, case: &Case, map: u32, receiver_map: u32, accumulate: &str) -> Self {
        let scene = case.scene();
        let setup = Setup::ground(&scene, 1.0, 8);
        let words = format!(
            "receivers=map sides=one map={map} receiver_map={receiver_map} accumulate={accumulate}"
        );
        let mut stage = setup.stage(device, &words);
        let plan = stage.plan(setup.light(), Some(case.window())).unwrap();
        stage.run(&plan).unwrap();
        let (depth, _) = stage.inspect::<f32>(&plan, "depth_layers.front_depth").unwrap();
        let (stored, _) = stage.inspect::<f32>(&plan, "depth_layers.receiver_depth").unwrap();
        let front = "soft_shadow_map.front_map";
        let sums: Vec<f32> = if accumulate == "blend-fp16" {
            let (sums, _) = stage.inspect::<u16>(&plan, front).unwrap();
            sums.into_iter().map(from_half).collect()
        } else {
            stage.inspect::<f32>(&plan, front).unwrap().0
        };
        let blocks: Blocks = push(&plan, "soft_shadow_map.blocks");
        let (scale, step, first, inv_near) = if accumulate == "gather" {
            let p: GatherMap = push(&plan, "soft_shadow_map.gather_front");
            (p.scale, p.t_step, p.t_first, p.receiver_inv_near)
        } else {
            let p: PatchDraw = push(&plan, "soft_shadow_map.blend_front");
            (p.scale, p.t_step, p.t_first, p.receiver_inv_near)
        };
        let side = receiver_map as usize;
        let middle = side * side / 2;
        Self {
            w: depth.iter().map(|d| d * blocks.inv_near).collect(),
            side: map as usize,
            scale,
            t: [0, 1].map(|a| first[a] + (side / 2) as f32 * step[a]),
            w_r: stored[middle] * inv_near,
            sum: sums[middle],
        }
    }

    fn exact(&self) -> f64 {
        let map = OccluderMap { w: &self.w, side: self.side, scale: self.scale };
        occlusion(&map, self.t, self.w_r)
    }

    fn receiver(&self) -> Receiver<'_> {
        Receiver { w: &self.w, side: self.side, scale: self.scale, t: self.t, w_r: self.w_r }
    }

    /// The same card and light through an occluder map of another side.
    fn through(&self, side: u32) -> Self {
        let finer = f64::from(side) / self.side as f64;
        Self {
            w: vec![self.w[0]; side as usize * side as usize],
            side: side as usize,
            scale: self.scale.map(|s| (f64::from(s) / finer) as f32),
            t: self.t.map(|t| (f64::from(t) * finer) as f32),
            ..*self
        }
    }

    /// What a texel hides of the light where all of it is seen before it.
    fn patch(&self) -> f64 {
        let k = 1.0 / f64::from(self.w[self.w.len() / 2] - self.w_r);
        f64::from(self.scale[0]) * f64::from(self.scale[1]) * k * k
    }
}

fn from_half(bits: u16) -> f32 {
    let (exponent, fraction) = (i32::from(bits >> 10 & 31), f32::from(bits & 1023));
    if exponent == 0 {
        fraction * 2.0_f32.powi(-24)
    } else {
        (1024.0 + fraction) * 2.0_f32.powi(exponent - 25)
    }
}

fn shown(what: &str, n: u32, sums: &Sums, exact: f64, [worst, likely, found]: [f64; 3]) {
    let patch = sums.patch();
    let terms = exact / patch;
    println!(
        "| {what} | {n} | {terms:.0} | 2^{:.1} | {exact:.6} | {worst:.1e} | {likely:.1e} | {found:.1e} |",
        patch.log2()
    );
}

/// How the gather's sum may be off (docs/rounding.md): by additions of a block's 64 texels, of a superblock's 16
/// blocks with two sums each, of a row's superblocks and of rows; by the roundings of a closed form or of the two
/// ends of what texels cover; and by half a rounding of a node's mean, which the square of the magnification
/// counts twice.
fn gather_bound(map: u32, condition: f64) -> f64 {
    let superblocks = f64::from(map.div_ceil(32));
    (64.0 + 32.0 + 2.0 * superblocks + 16.0 + 2.0 * condition) * U
}

#[test]
fn gathered_sums_are_within_their_bound() {
    let device = device();
    // Nine receivers that lie far apart share nodes that serve none of them whole: each texel counts by itself.
    for (name, case, maps, receiver_map) in [
        ("gather, patch 4/N²", &HALF_OF_MAP, &[4096][..], 1),
        ("gather, patch 1/N²", &ALL_OF_MAP, &[64, 128, 256, 512, 1024, 2048, 4096], 1),
        ("gather, near", &NEAR, &[64, 1024], 1),
        ("gather, by texels", &ALL_OF_MAP, &[64, 128, 256, 512], 3),
    ] {
        for &map in maps {
            if name.ends_with("4/N²") && device.leaves_to_others(name) {
                continue;
            }
            let sums = Sums::of(&device, case, map, receiver_map, "gather");
            let exact = sums.exact();
            let found = (f64::from(sums.sum) - exact).abs();
            let bound = gather_bound(map, case.condition());
            shown(name, map, &sums, exact, [bound, (bound * U).sqrt(), found]);
            assert!((exact - 1.0).abs() < 1e-4, "{name}, N = {map}: no full umbra but {exact}");
            assert!(found <= bound, "{name}, N = {map}: {found:.1e}, bound {bound:.1e}");
        }
    }
}

/// What blending may be off by. Each of a row's N contributions is rounded up or down by the next of a Kronecker
/// sequence. Of q of them, q the denominator of one of its convergents, each q-th of the unit interval holds one,
/// so that those below any threshold are off by less than 2. A row is as many such runs as its partial quotients
/// up to N add up to, at most. Thresholds have 16 bits, which is one more; steps are 2⁻²⁴, and rows N. Sums of
/// such steps up to 1 are exact.
fn blend_bound(map: u32) -> f64 {
    let row = 2 * quotients(map).iter().sum::<u64>() + 1;
    f64::from(map) * row as f64 * U
}

/// A CPU's device blends what the processor does to the bit, so that the processor can tell of 16 million rectangles;
/// others may divide otherwise, and round some contributions to the other side.
#[test]
fn blended_sums_are_within_their_bound() {
    let device = device();
    let same = device.properties().device_type == vk::PhysicalDeviceType::CPU;
    for (name, case) in [("blend, patch 4/N²", &HALF_OF_MAP), ("blend, patch 1/N²", &ALL_OF_MAP)]
    {
        for map in [64, 256] {
            let sums = Sums::of(&device, case, map, 1, "blend");
            let apart = f64::from((sums.receiver().blended() - sums.sum).abs());
            let most = if same { 0.0 } else { blend_bound(map) };
            assert!(apart <= most, "{name}, N = {map}: {apart:.1e} from the processor's");
        }
        let coarse = Sums::of(&device, case, 64, 1, "blend");
        for map in [64, 256, 1024, 4096] {
            let sums = coarse.through(map);
            let exact = sums.exact();
            let found = (f64::from(sums.receiver().blended()) - exact).abs();
            let (bound, terms) = (blend_bound(map), 1.0 / sums.patch());
            shown(name, map, &sums, exact, [bound, 0.5 * terms.sqrt() * U, found]);
            assert!(found <= bound, "{name}, N = {map}: {found:.1e}, bound {bound:.1e}");
        }
    }
}

/// Without steps of 2⁻²⁴, 32 bits are not enough for the patches of N = 4096: one of 1.04 · 2⁻²² is 4.16 steps of a
/// sum from ½ on, and counts as 4 two million times. With steps they are, and for less than a step too.
#[test]
fn where_sums_in_32_bits_stop() {
    for (factor, power, stays) in [
        (1.0_f32, 22, true),
        (1.0, 24, true),
        (1.0, 25, false),
        (1.04, 22, false),
        (1.04, 24, false),
    ] {
        let term = factor * 2.0_f32.powi(-power);
        let side = (1.0 / f64::from(term)).sqrt() as usize;
        let (mut plain, mut steps) = (0.0_f32, 0.0_f32);
        for y in 0..side {
            for x in 0..side {
                plain += term;
                steps += rounded(term, threshold(x, y));
            }
        }
        let exact = f64::from(term) * (side * side) as f64;
        let [off, off_in_steps] = [plain, steps].map(|sum| (f64::from(sum) - exact).abs());
        println!("| {factor} · 2^-{power} | {} | {off:.1e} | {off_in_steps:.1e} |", side * side);
        if stays {
            assert_eq!(off, 0.0, "powers of two are exact down to 2^-24");
        } else {
            assert!(off > 0.01, "{factor} · 2^-{power} would do without: {off:.1e}");
        }
        assert!(
            off_in_steps <= blend_bound(side as u32),
            "{factor} · 2^-{power}: {off_in_steps:.1e}"
        );
    }
}

/// The counter-example: Atty 2006 Fig. 14 and eq. 4, to the bit.
#[test]
fn sums_in_sixteen_bits_stall_where_equation_4_says() {
    let device = device();
    let mut roundings = vec![Rounding::Truncates, Rounding::ToNearest];
    for map in [32, 64, 128, 256, 512] {
        let sums = Sums::of(&device, &ALL_OF_MAP, map, 1, "blend-fp16");
        let blended = |r: Rounding| sums.receiver().patches().fold(0.0, |s, (h, _)| half(s + h, r));
        roundings.retain(|&rounding| blended(rounding) == sums.sum);
        assert!(!roundings.is_empty(), "N = {map}: neither way of rounding gives {}", sums.sum);
        let stall = stall(sums.patch() as f32, roundings[0]);
        println!("| {map} | 2^{:.1} | {stall} | {} |", sums.patch().log2(), sums.sum);
        if stall < 1.0 {
            assert_eq!(sums.sum, stall, "N = {map}, {roundings:?}");
        }
        assert!(map > 32 || sums.sum > 0.9, "coarse maps have large patches: {}", sums.sum);
        assert!(map < 128 || sums.sum < 0.3, "N = {map}: 16 bits do not stall: {}", sums.sum);
    }
    println!("{roundings:?}");
}

/// Means of windows of 2^k texels a side are kept in 16 bits: exact up to k = 5, and from there on each level
/// rounds by 2⁻¹⁰ at most.
#[test]
fn levels_of_means_are_within_their_bound() {
    for rounding in [Rounding::Truncates, Rounding::ToNearest] {
        // Of a map of N = 1024, three in ten.
        let blocks = |i: usize| f32::from(u8::from(threshold(i, 0) < 0.3));
        let mut level: Vec<f32> = (0..1 << 20).map(blocks).collect();
        let mut exact: Vec<f64> = level.iter().map(|&v| v.into()).collect();
        for k in 1..=10_i32 {
            level = level.chunks(4).map(|v| half(0.25 * v.iter().sum::<f32>(), rounding)).collect();
            exact = exact.chunks(4).map(|v| 0.25 * v.iter().sum::<f64>()).collect();
            let off = |(&v, &exact): (&f32, &f64)| (f64::from(v) - exact).abs() / exact.max(1e-9);
            let found = level.iter().zip(&exact).map(off).fold(0.0, f64::max);
            let bound = f64::from((k - 5).max(0)) / 1024.0;
            println!("| {rounding:?} | 2^{k} | {bound:.1e} | {found:.1e} |");
            assert!(found <= bound, "{rounding:?}, {k}: {found:.1e}");
        }
    }
}

/// Counts are whole numbers, exact up to 2²⁴; what is left is one division.
#[test]
fn counts_are_whole() {
    let device = device();
    let scene = generate::spheres(generate::square_light(0.6).unwrap());
    let setup = Setup::ground(&scene, 2.0, 48);
    for (words, parts) in [
        ("technique=many-lights samples=257 map=32", 257.0_f64),
        ("technique=ray-march rays=9 filter=off map=64", 9.0),
    ] {
        let image = setup.visibility(&mut setup.stage(&device, words));
        let mut between = 0;
        for &v in &image {
            let hidden = (1.0 - f64::from(v)) * parts;
            // 1 − count/parts: a division of up to 2.5 ulp (Vulkan) and a difference.
            assert!((hidden - hidden.round()).abs() <= 6.0 * U * parts, "{words}: {hidden}");
            between += usize::from(v > 0.0 && v < 1.0);
        }
        assert!(between > 20, "{words}: {between} pixels in penumbra");
    }
}
