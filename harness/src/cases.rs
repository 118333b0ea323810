//! Scenes made to need something, or not to; `tests/techniques/planner.rs` and `benches/planner` share them.

// The scenes are constants of this file: one that cannot be made is a fault of it.
#![allow(clippy::unwrap_used)]

use antumbra::RectangleLight;
use antumbra::effects::Effect;
use antumbra::scene::{Mesh, Role, Scene, generate};
use glam::{DMat4, DVec3};

/// A scene made to need some effects and not others.
pub struct Case {
    /// The case's name, for tables.
    pub name: &'static str,
    /// The scene.
    pub scene: Scene,
    /// The settings as text.
    pub words: &'static str,
    /// Half the side of the ground that pixels see, metres.
    pub half: f64,
    /// The kinds of pass that run, in order.
    pub runs: &'static [&'static str],
    /// The effects that are left out, beside those that are left out in most scenes.
    pub left_out: &'static [Effect],
}

fn light(side: f64) -> RectangleLight {
    generate::square_light(side).unwrap()
}

/// A scene of meshes over the ground, each with its centre's place, under a square light of side `side` at 4 m.
fn over_ground<const N: usize>(side: f64, occluders: [(Mesh, DVec3); N]) -> Scene {
    let mut scene = generate::stage(light(side));
    for (i, (mesh, at)) in occluders.into_iter().enumerate() {
        let name = format!("occluder {i}");
        // Edges on texel borders have no error at all, which no scene of many has.
        let turned = DMat4::from_translation(at) * DMat4::from_rotation_y(0.35);
        scene.add(&name, mesh, turned, Role::Occluder);
    }
    scene
}

fn sheet(side: f64) -> Mesh {
    Mesh { double_sided: true, ..generate::quad(side, side) }
}

fn solid(width: f64, height: f64) -> Mesh {
    generate::cuboid(DVec3::new(width, height, width))
}

fn up(y: f64) -> DVec3 {
    DVec3::Y * y
}

const LIT: &[&str] = &["visibility.lit"];
const SSM: &[&str] = &[
    "gbuffer.constants",
    "depth_layers.front",
    "depth_layers.back",
    "soft_shadow_map.blocks",
    "soft_shadow_map.superblocks",
    "visibility.tiles_start",
    "visibility.tiles",
    "soft_shadow_map.gather_pixels",
];
const SSM_FRONT: &[&str] = &[
    "gbuffer.constants",
    "depth_layers.front",
    "soft_shadow_map.blocks",
    "soft_shadow_map.superblocks",
    "visibility.tiles_start",
    "visibility.tiles",
    "soft_shadow_map.gather_pixels",
];
const HARD: &[&str] = &["gbuffer.constants", "depth_layers.front", "hard.visibility"];
const OWN_HARD: &[&str] = &["gbuffer.constants", "depth_layers.hard", "hard.visibility"];
const RAYS: &[&str] = &[
    "gbuffer.constants",
    "depth_layers.front",
    "depth_layers.back",
    "depth_layers.near_back",
    "depth_layers.far_front",
    "ray_march.columns",
    "ray_march.level",
    "ray_march.start",
    "ray_march.classify",
    "ray_march.trace",
    "ray_march.filter_rows",
    "ray_march.filter_columns",
];
const RAYS_FRONT: &[&str] = &[
    "gbuffer.constants",
    "depth_layers.front",
    "ray_march.columns",
    "ray_march.level",
    "ray_march.start",
    "ray_march.classify",
    "ray_march.trace",
    "ray_march.filter_rows",
    "ray_march.filter_columns",
];
const RAYS_UNFILTERED: &[&str] = &[
    "gbuffer.constants",
    "depth_layers.front",
    "depth_layers.back",
    "depth_layers.near_back",
    "depth_layers.far_front",
    "ray_march.columns",
    "ray_march.level",
    "ray_march.start",
    "ray_march.classify",
    "ray_march.trace",
];

const SLICES: &[&str] = &[
    "gbuffer.constants",
    "depth_layers.front",
    "depth_layers.back",
    "occlusion_textures.histogram_start",
    "occlusion_textures.histogram",
    "occlusion_textures.place_fitted",
    "occlusion_textures.front_slices",
    "occlusion_textures.back_slices",
    "occlusion_textures.mask",
    "occlusion_textures.sum_rows",
    "occlusion_textures.sum_columns",
    "visibility.tiles_start",
    "visibility.tiles",
    "occlusion_textures.visibility",
];
const LINES: &[&str] = &[
    "gbuffer.constants",
    "linear_light.middle_occluders",
    "linear_light.middle_receivers",
    "linear_light.middle_copy",
    "linear_light.mask",
    "linear_light.place",
    "linear_light.occluders",
    "linear_light.receivers",
    "linear_light.start",
    "linear_light.copy",
    "linear_light.left_edges",
    "linear_light.left_skins",
    "linear_light.keep_first",
    "linear_light.right_edges",
    "linear_light.right_skins",
    "linear_light.keep",
    "linear_light.visibility",
];

/// Every scene, and what it calls for.
pub fn cases() -> Vec<Case> {
    use Effect as E;
    let ground_alone = generate::stage(light(0.4));
    let mut both_ground = ground_alone.clone();
    both_ground.instances.iter_mut().for_each(|i| i.role = Role::Both);
    let mut nobody = over_ground(0.4, [(sheet(1.0), up(2.0))]);
    nobody.instances.retain(|i| i.role.blocks());
    let near = || over_ground(0.01, [(sheet(1.0), up(0.02))]);
    let short = RectangleLight::line(DVec3::Y * 4.0, DVec3::X * 0.005, DVec3::NEG_Y).unwrap();
    let mut lined = near();
    lined.lights[0].light = short.into();
    let apart = over_ground(
        0.4,
        [(sheet(0.4), DVec3::new(-0.6, 2.0, 0.0)), (sheet(0.4), DVec3::new(0.6, 2.0, 0.0))],
    );
    let some_matter = over_ground(
        0.4,
        [
            (solid(0.5, 0.5), up(2.0)),
            (sheet(1.0), up(6.0)),
            (solid(0.5, 0.5), DVec3::new(0.0, 8.0, 0.0)),
        ],
    );
    let case = |name, scene, words, half, runs: &'static [&'static str]| Case {
        name,
        scene,
        words,
        half,
        runs,
        left_out: &[],
    };
    let without = |left_out: &'static [Effect], case: Case| Case { left_out, ..case };
    let rays = "technique=ray-march map=128 rays=4";
    let slices = "technique=occlusion-textures slices=4 map=128";
    let flat = &[E::BackSide, E::Fusion];
    let point = &[E::Penumbra, E::InnerPenumbra];
    vec![
        case("the ground alone", ground_alone.clone(), "", 2.0, LIT),
        case("a ground that could block itself", both_ground, "", 2.0, LIT),
        case(
            "an occluder behind the light",
            over_ground(0.4, [(solid(0.5, 0.5), up(8.0))]),
            "",
            2.0,
            LIT,
        ),
        case("nothing receives", nobody, "", 2.0, LIT),
        case(
            "an occluder aside, far below the ground",
            over_ground(0.4, [(solid(0.5, 0.5), up(-3.0))]),
            "",
            2.0,
            LIT,
        ),
        case("the ground alone, by rays", ground_alone, rays, 2.0, LIT),
        without(
            point,
            case("a card just over the ground under a small light", near(), "map=512", 0.6, HARD),
        ),
        without(
            point,
            case(
                "the same by rays",
                near(),
                "technique=ray-march map=512 rays=4 levels=mip",
                0.6,
                HARD,
            ),
        ),
        without(
            point,
            case(
                "the same by slices",
                near(),
                "technique=occlusion-textures slices=4 map=512",
                0.6,
                OWN_HARD,
            ),
        ),
        without(point, case("the same by PCSS", near(), "technique=pcss map=512", 0.6, HARD)),
        without(
            point,
            case(
                "the same by many lights",
                near(),
                "technique=many-lights samples=16 map=512",
                0.6,
                OWN_HARD,
            ),
        ),
        without(
            flat,
            case(
                "a thin leaf",
                over_ground(0.4, [(sheet(0.6), up(2.0))]),
                "map=128",
                1.2,
                SSM_FRONT,
            ),
        ),
        without(
            flat,
            case(
                "a thin leaf by rays",
                over_ground(0.4, [(sheet(0.6), up(2.0))]),
                rays,
                1.2,
                RAYS_FRONT,
            ),
        ),
        without(flat, case("two leaves side by side", apart.clone(), "map=128", 1.8, SSM_FRONT)),
        without(flat, case("two leaves side by side, by rays", apart, rays, 1.8, RAYS_FRONT)),
        without(
            flat,
            case(
                "a board 2 mm thick, high up",
                over_ground(0.4, [(solid(0.6, 0.002), up(2.5))]),
                "map=128",
                1.8,
                SSM_FRONT,
            ),
        ),
        without(
            flat,
            case(
                "the board by rays",
                over_ground(0.4, [(solid(0.6, 0.002), up(2.5))]),
                rays,
                1.8,
                RAYS_FRONT,
            ),
        ),
        case("a closed solid", over_ground(0.4, [(solid(0.5, 0.5), up(2.0))]), "map=128", 1.4, SSM),
        case(
            "a closed solid by rays",
            over_ground(0.4, [(solid(0.5, 0.5), up(2.0))]),
            rays,
            1.4,
            RAYS,
        ),
        case("two fused occluders", generate::stacked_cards(light(0.4)), "map=128", 2.2, SSM),
        case("two fused occluders by rays", generate::stacked_cards(light(0.4)), rays, 2.2, RAYS),
        case("a standing box", generate::tall_box(light(1.0)), "map=128", 2.2, SSM),
        case(
            "a mesh on itself",
            generate::spheres(light(0.4)).with_occluders_as(Role::Both),
            "map=128",
            2.2,
            SSM,
        ),
        case("one of three matters", some_matter, "map=128", 1.4, SSM),
        without(
            &[E::Noise],
            case(
                "penumbrae of two pixels, by rays",
                over_ground(0.02, [(solid(0.5, 0.5), up(2.0))]),
                rays,
                1.4,
                RAYS_UNFILTERED,
            ),
        ),
        case(
            "a closed solid by slices",
            over_ground(0.4, [(solid(0.5, 0.5), up(2.0))]),
            slices,
            1.4,
            SLICES,
        ),
        case(
            "a line",
            generate::stacked_cards(generate::line_light(1.0, 0.4).unwrap()),
            "technique=linear-light map=128",
            2.2,
            LINES,
        ),
        without(
            point,
            case(
                "the line just over a card",
                lined,
                "technique=linear-light lines=1 samples=4 map=512",
                0.6,
                OWN_HARD,
            ),
        ),
    ]
}
