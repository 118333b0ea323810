//! The scenes, each under three lights or under lights of its own, and anyone's own.

use crate::Problem;
use crate::hills::hills;
use crate::options::Options;
use crate::places;
use antumbra::scene::generate::{self, GROUND_SIDE, cuboid};
use antumbra::scene::{AreaLight, Camera, Role, Scene, from_gltf};
use antumbra::{RectangleLight, Shape};
use antumbra_harness::ply::ply;
use glam::{DMat4, DVec3};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// The three lights of the made scenes: names and sides in metres, over objects 1 m across whose top
/// is about 1.5 m below and whose shadow falls 2 m further down.
pub const LIGHTS: [(&str, f64); 3] = [("small", 0.1), ("medium", 0.4), ("large", 1.0)];

/// What the light of a file is scaled by for the same three names.
const SCALES: [f64; 3] = [0.25, 1.0, 2.0];

/// Leaves of the plant; a few hundred are a dense one.
const LEAVES: u32 = 300;

/// The scene of Curtis 2009 tables 4.1 and 4.3, where it was fetched.
pub const DRAGON: &str = "dragon";
/// The scene of Curtis 2009 tables 4.2 and 4.4.
pub const CUBE: &str = "elongated cube";

/// That dragon has 100,000 triangles. Of the versions that `benches/fetch_dragon.sh` fetches
/// this one's 47,794 are nearest; the next has 202,520.
const DRAGON_FILE: &str = "dragon_vrip_res3";

/// Where a scene comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// Made in code under a square light of one of [`LIGHTS`].
    Made(&'static str),
    /// One of the project's own files, its light scaled to three sizes.
    Committed(&'static str),
    /// Made in code with lights of its own, one of [`places::ALL`].
    Place(&'static str),
    /// One of the project's own files, its lights as they are.
    Whole(&'static str),
    /// Anyone's file, its lights as they are.
    File(PathBuf),
}

/// A light that a scene is measured under.
#[derive(Clone, Debug, PartialEq)]
pub struct Lit {
    /// What the report calls it, one of a kind within its scene.
    pub name: String,
    pub is_sun: bool,
}

/// The project's own files of whole scenes.
pub const WHOLE: [&str; 3] = ["kitchen", "yard", "hall"];

/// What the one light of a file is called.
const ITS_OWN: &str = "its own";

/// A scene to be measured.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneSpec {
    pub name: String,
    pub source: Source,
}

/// The scenes that every run has, in the report's order.
pub fn standard() -> Vec<SceneSpec> {
    let made = ["card", "tall box", "stacked cards", "slats", "foliage"].map(Source::Made);
    let files = ["bunny", "suzanne"].map(Source::Committed);
    let all = made.into_iter().chain(files).chain([Source::Made("hills")]);
    all.map(|source| {
        let (Source::Made(name) | Source::Committed(name)) = source else { unreachable!() };
        SceneSpec { name: name.into(), source }
    })
    .collect()
}

/// The scenes that have lights of their own, in the report's order.
pub fn whole() -> Vec<SceneSpec> {
    let made = places::ALL.iter().map(|made| (made.name, Source::Place(made.name)));
    let files = WHOLE.into_iter().map(|name| (name, Source::Whole(name)));
    made.chain(files).map(|(name, source)| SceneSpec { name: name.into(), source }).collect()
}

/// The glTF files of a folder, sorted by name.
///
/// # Errors
/// A folder that cannot be read or holds none.
pub fn own(folder: &Path) -> Result<Vec<SceneSpec>, Problem> {
    let problem = Problem::of::<std::io::Error>(format!("--scenes {}", folder.display()));
    let paths = std::fs::read_dir(folder).map_err(&problem)?.map(|e| e.map(|e| e.path()));
    let mut files: Vec<PathBuf> = paths.collect::<Result<_, _>>().map_err(&problem)?;
    let is_gltf = |e: &OsStr| ["glb", "gltf"].iter().any(|known| e.eq_ignore_ascii_case(known));
    files.retain(|path| path.extension().is_some_and(is_gltf));
    files.sort();
    if files.is_empty() {
        let sentence = "there is no .glb or .gltf in it; give a folder of glTF files";
        return Err(Problem::of(format!("--scenes {}", folder.display()))(sentence));
    }
    let spec = |path: PathBuf| {
        let name = path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        SceneSpec { name, source: Source::File(path) }
    };
    Ok(files.into_iter().map(spec).collect())
}

impl SceneSpec {
    /// The lights that it is measured under, one at a time: of a file those that most of what is compared takes.
    pub fn lights(&self) -> Vec<Lit> {
        let three = || LIGHTS.iter().map(|l| Lit { name: l.0.into(), is_sun: false }).collect();
        let scene = match &self.source {
            Source::Made(_) | Source::Committed(_) => return three(),
            Source::Place(_) | Source::Whole(_) => self.unlit(),
            Source::File(path) => from_gltf(path).map_err(Problem::from),
        };
        let lights = scene.map(|scene| scene.lights).unwrap_or_default();
        let named = named(&lights).into_iter().zip(&lights);
        let taken: Vec<Lit> = named
            .filter(|(_, light)| is_taken(light))
            .map(|(name, light)| Lit {
                name: if lights.len() == 1 { ITS_OWN.into() } else { name },
                is_sun: matches!(light.light.shape(), Shape::Sun { .. }),
            })
            .collect();
        // What cannot be measured is a row that says why.
        if taken.is_empty() { vec![Lit { name: ITS_OWN.into(), is_sun: false }] } else { taken }
    }

    /// Whether its lights are its own.
    pub fn is_whole(&self) -> bool {
        !matches!(self.source, Source::Made(_) | Source::Committed(_))
    }

    /// A scene with lights of its own, all of them.
    fn unlit(&self) -> Result<Scene, Problem> {
        match &self.source {
            Source::Place(name) => {
                let made =
                    places::made(name).ok_or_else(|| format!("no scene is called {name}"))?;
                (made.make)()
            }
            Source::Whole(name) => committed(name),
            _ => Err("its lights are the report's".into()),
        }
    }

    /// The scene under one of its lights.
    pub fn load(&self, light: &str) -> Result<Scene, Problem> {
        let index = LIGHTS.iter().position(|l| l.0 == light).unwrap_or(1);
        match &self.source {
            Source::Made(name) => {
                let mut scene = made(name, square(LIGHTS[index].1)?)?;
                if *name == "card" {
                    // The node fits its map to what blocks, so that a lone aligned card has its edges on texel
                    // borders and no error at all, which says nothing of a card in a scene of many.
                    move_blocks(&mut scene, DMat4::from_rotation_y(20f64.to_radians()));
                }
                Ok(scene)
            }
            Source::Committed(name) => {
                let mut scene = committed(name)?;
                let light = scene.lights.first_mut().ok_or("the file has no light")?;
                light.light = scaled(light.light.rectangle(), SCALES[index])?.into();
                Ok(scene)
            }
            Source::Place(_) | Source::Whole(_) => Ok(under(self.unlit()?, light)),
            Source::File(path) => {
                let scene = under(from_gltf(path)?, light);
                let problem = Problem::of(path.display());
                let light = scene.light(None).map_err(Problem::of(path.display()))?;
                let shape = light.light.shape();
                if !is_taken(light) {
                    return Err(Problem::of(path.display())(format!(
                        "its light is a {}, which most of what is compared does not take; give it a rectangle",
                        shape.name()
                    )));
                }
                if scene.triangles() == 0 {
                    return Err(problem(
                        "the scene has no triangles; at least one mesh node must be drawn",
                    ));
                }
                Ok(scene)
            }
        }
    }
}

/// Whether most of what is compared takes a light.
fn is_taken(light: &AreaLight) -> bool {
    matches!(light.light.shape(), Shape::Rectangle | Shape::Line | Shape::Sun { .. })
}

/// The names of lights, with a number behind those that another has before.
fn named(lights: &[AreaLight]) -> Vec<String> {
    let name = |(i, light): (usize, &AreaLight)| match lights[..i]
        .iter()
        .filter(|before| before.name == light.name)
        .count()
    {
        0 => light.name.clone(),
        before => format!("{} ({})", light.name, before + 1),
    };
    lights.iter().enumerate().map(name).collect()
}

/// A scene under the one of its lights that [`named`] calls so, or the first.
fn under(mut scene: Scene, light: &str) -> Scene {
    let at = named(&scene.lights).iter().position(|name| name == light).unwrap_or(0);
    scene.lights = scene.lights.into_iter().skip(at).take(1).collect();
    scene
}

/// Moves what blocks light, after it was placed.
pub fn move_blocks(scene: &mut Scene, by: DMat4) {
    for instance in scene.instances.iter_mut().filter(|i| i.role.blocks()) {
        instance.world_from_mesh = by * instance.world_from_mesh;
    }
}

/// A square light over the middle of the ground.
pub fn square(side: f64) -> Result<RectangleLight, Problem> {
    Ok(generate::square_light(side)?)
}

/// A light with its sides times `by`.
pub fn scaled(light: &RectangleLight, by: f64) -> Result<RectangleLight, Problem> {
    let frame = light.world_from_light();
    let [a, b] = light.half_extents().map(|half| half * by);
    // Emission is −(u × v), and light space's axes are right-handed about it: v is −y.
    let u = frame.x_axis.truncate() * a;
    let v = -frame.y_axis.truncate() * b;
    Ok(RectangleLight::new(light.center(), u, v)?)
}

/// One of the project's own files.
pub fn committed(name: &str) -> Result<Scene, Problem> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    Ok(from_gltf(&root.join(format!("{name}.glb")))?)
}

/// A scene made in code, by name.
pub fn made(name: &str, light: RectangleLight) -> Result<Scene, Problem> {
    Ok(match name {
        "card" => generate::card(light),
        "tall box" => generate::tall_box(light),
        "stacked cards" => generate::stacked_cards(light),
        "slats" => generate::slats(light, 8),
        "foliage" => generate::foliage(light, LEAVES, 1),
        "hills" => over_hills(light)?,
        "spheres" => generate::spheres(light),
        "contact" => generate::contact(light),
        "spheres on themselves" => generate::spheres(light).with_occluders_as(Role::Both),
        "suzanne on herself" => generate::normalized(&committed("suzanne")?, light)
            .map_err(Problem::of("suzanne"))?
            .with_occluders_as(Role::Both),
        CUBE => elongated_cube(light),
        DRAGON => dragon(light)?,
        model => generate::normalized(&committed(model)?, light).map_err(Problem::of(model))?,
    })
}

/// The bunny over hills, its shadow on what is no plane.
fn over_hills(light: RectangleLight) -> Result<Scene, Problem> {
    let mut scene = generate::normalized(&committed("bunny")?, light)?;
    for instance in scene.instances.iter().filter(|i| i.role == Role::Receiver) {
        scene.meshes[instance.mesh] = hills(GROUND_SIDE, 96);
    }
    Ok(scene)
}

/// A cube stretched to four times its height and floating half a metre over the ground. The paper's cube casts
/// a shadow that is darker just beneath it by its extent towards the light; here the light of 1 m sees past
/// its top to all of the ground below, which is in umbra for the bottom alone: seen from there the top hides
/// (0.25 · 4/1.5)² = 0.44 of the light, the bottom all.
pub fn elongated_cube(light: RectangleLight) -> Scene {
    let mut scene = generate::stage(light);
    scene.add(
        CUBE,
        cuboid(DVec3::new(0.25, 1.0, 0.25)),
        DMat4::from_translation(DVec3::Y),
        Role::Both,
    );
    with_camera(scene)
}

/// A camera nearer than one that frames all of the scene: what is compared should fill the picture.
fn with_camera(mut scene: Scene) -> Scene {
    let target = scene.bounds(|i| i.role.blocks()).map_or(DVec3::ZERO, |b| b.center());
    scene.camera = Some(camera_at(&scene, target, 0.6));
    scene
}

/// The camera that frames all of a scene, its distance from a target times a factor.
pub fn camera_at(scene: &Scene, target: DVec3, factor: f64) -> Camera {
    let mut camera = Camera::framing(scene, 4.0 / 3.0);
    let eye = camera.world_from_view.w_axis.truncate();
    camera.world_from_view.w_axis = (target + factor * (eye - target)).extend(1.0);
    camera
}

/// Where `benches/fetch_dragon.sh` puts it.
pub fn dragon_path() -> PathBuf {
    Options::root().join(format!("target/dragon/{DRAGON_FILE}.ply"))
}

/// The dragon, its largest extent 1 m, standing on the ground. Both scenes' objects block and receive, as
/// in the paper.
pub fn dragon(light: RectangleLight) -> Result<Scene, Problem> {
    let path = dragon_path();
    let mesh = ply(&path).ok_or_else(|| {
        format!("{}: no PLY of triangles; benches/fetch_dragon.sh fetches it", path.display())
    })?;
    let mut object = Scene::default();
    object.add(DRAGON, mesh, DMat4::IDENTITY, Role::Both);
    let scene = generate::normalized(&object, light)?;
    let low = scene.bounds(|i| i.role.blocks()).map_or(0.0, |b| b.min.y);
    let mut scene = scene.with_occluders_as(Role::Both);
    move_blocks(&mut scene, DMat4::from_translation(DVec3::NEG_Y * low));
    Ok(with_camera(scene))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each light of a scene with lights of its own is loaded by its name, and no two have the same.
    #[test]
    fn every_light_of_a_whole_scene_is_measured_by_itself() {
        for spec in whole() {
            let lights = spec.lights();
            assert!(lights.len() >= 3, "{}: {lights:?}", spec.name);
            for (i, light) in lights.iter().enumerate() {
                assert!(lights[..i].iter().all(|other| other.name != light.name), "{light:?}");
                let scene = spec.load(&light.name).unwrap();
                assert!(scene.lights.len() == 1 && scene.lights[0].name == light.name, "{light:?}");
                assert!(scene.instances.iter().all(|i| i.role == Role::Both), "{}", spec.name);
            }
        }
        let suns = whole().iter().flat_map(SceneSpec::lights).filter(|light| light.is_sun).count();
        assert_eq!(suns, 2, "the street's and the yard's");
    }

    #[test]
    fn the_cubes_top_hides_less_than_half_of_the_light_from_below() {
        let scene = elongated_cube(square(1.0).unwrap());
        let bounds = scene.bounds(|i| i.role.blocks()).unwrap();
        let light = *scene.light(None).unwrap().light.rectangle();
        let height = light.center().y;
        let share = |y: f64| {
            let side = bounds.size().x * height / y;
            (side / (2.0 * light.half_extents()[0])).powi(2)
        };
        assert!(share(bounds.max.y) < 0.5 && share(bounds.min.y) > 1.0);
    }

    #[test]
    fn every_scene_loads_under_every_light_and_the_sizes_grow() {
        for spec in standard() {
            let mut last = 0.0;
            for light in spec.lights() {
                let scene = spec.load(&light.name).unwrap();
                let [a, b] = scene.light(None).unwrap().light.rectangle().half_extents();
                assert!(a * b > last, "{} {}", spec.name, light.name);
                last = a * b;
                assert!(scene.instances.iter().any(|i| i.role.blocks()));
                assert!(scene.instances.iter().any(|i| i.role.receives()));
            }
        }
    }

    #[test]
    fn a_scaled_light_keeps_its_place_and_side() {
        let scene = committed("bunny").unwrap();
        let light = *scene.light(None).unwrap().light.rectangle();
        let twice = scaled(&light, 2.0).unwrap();
        assert!((twice.emission() - light.emission()).length() < 1e-12);
        for (twice, once) in twice.half_extents().iter().zip(light.half_extents()) {
            assert!((twice - 2.0 * once).abs() < 1e-12);
        }
        assert!(
            (twice.world_from_light().x_axis - light.world_from_light().x_axis).length() < 1e-12
        );
        assert!(scaled(&light, 0.0).is_err());
    }

    #[test]
    fn a_folder_without_scenes_is_refused_by_name() {
        let folder = std::env::temp_dir();
        let empty = folder.join(format!("antumbra-no-scenes-{}", std::process::id()));
        std::fs::create_dir_all(&empty).unwrap();
        assert!(own(&empty).unwrap_err().0.contains("glTF"));
        std::fs::remove_dir(&empty).unwrap();
        assert!(own(&empty).unwrap_err().0.contains("antumbra-no-scenes"));
    }
}
