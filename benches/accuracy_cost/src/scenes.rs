//! The scenes, each under three lights, and anyone's own.

use crate::hills::hills;
use crate::{Problem, curtis};
use antumbra::RectangleLight;
use antumbra::scene::generate::{self, GROUND_SIDE};
use antumbra::scene::{Role, Scene, from_gltf};
use glam::DMat4;
use std::path::{Path, PathBuf};

/// The three lights of the made scenes: names and sides in metres, over objects 1 m across whose top
/// is about 1.5 m below and whose shadow falls 2 m further down.
pub const LIGHTS: [(&str, f64); 3] = [("small", 0.1), ("medium", 0.4), ("large", 1.0)];

/// What the light of a file is scaled by for the same three names.
const SCALES: [f64; 3] = [0.25, 1.0, 2.0];

/// Leaves of the plant; a few hundred are a dense one.
const LEAVES: u32 = 300;

/// Where a scene comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// Made in code under a square light of one of [`LIGHTS`].
    Made(&'static str),
    /// One of the project's own files, its light scaled to three sizes.
    Committed(&'static str),
    /// Anyone's file, under its first light as it is.
    File(PathBuf),
}

/// A scene to be measured.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneSpec {
    /// Its name in the report.
    pub name: String,
    /// Where it comes from.
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

/// The glTF files of a folder, sorted by name.
///
/// # Errors
/// A sentence where the folder cannot be read or holds none.
pub fn own(folder: &Path) -> Result<Vec<SceneSpec>, Problem> {
    let told = |e: std::io::Error| format!("--scenes {}: {e}", folder.display());
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(told)? {
        let path = entry.map_err(told)?.path();
        let extension = path.extension().map(|e| e.to_ascii_lowercase());
        if extension.is_some_and(|e| e == "glb" || e == "gltf") {
            files.push(path);
        }
    }
    files.sort();
    if files.is_empty() {
        return Err(format!(
            "--scenes {}: there is no .glb or .gltf in it; give a folder of glTF files",
            folder.display()
        ));
    }
    let spec = |path: PathBuf| {
        let name = path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        SceneSpec { name, source: Source::File(path) }
    };
    Ok(files.into_iter().map(spec).collect())
}

impl SceneSpec {
    /// The names of its lights.
    pub fn lights(&self) -> Vec<&'static str> {
        match self.source {
            Source::File(_) => vec!["its own"],
            _ => LIGHTS.iter().map(|l| l.0).collect(),
        }
    }

    /// The scene under one of its lights.
    ///
    /// # Errors
    /// A sentence that names the file, where it cannot be used.
    pub fn load(&self, light: &str) -> Result<Scene, Problem> {
        let index = LIGHTS.iter().position(|l| l.0 == light).unwrap_or(1);
        match &self.source {
            Source::Made(name) => {
                let mut scene = made(name, square(LIGHTS[index].1)?)?;
                if *name == "card" {
                    turn(&mut scene);
                }
                Ok(scene)
            }
            Source::Committed(name) => {
                let mut scene = committed(name)?;
                let light = scene.lights.first_mut().ok_or("the file has no light")?;
                light.light = scaled(&light.light, SCALES[index])?;
                Ok(scene)
            }
            Source::File(path) => {
                let scene = from_gltf(path).map_err(|e| e.to_string())?;
                let name = path.display();
                let light = scene.light(None).map_err(|e| format!("{name}: {e}"))?;
                if light.outline().is_some() {
                    return Err(format!(
                        "{name}: its light is a polygon, which most of what is compared does not take; \
                         give it a rectangle"
                    ));
                }
                if scene.triangles() == 0 {
                    return Err(format!(
                        "{name}: the scene has no triangles; at least one mesh node must be drawn"
                    ));
                }
                Ok(scene)
            }
        }
    }
}

/// Turns what blocks light by 20° about the middle. The node fits its map to what blocks, so that a
/// lone aligned card has its edges on texel borders and no error at all, which says nothing of a
/// card in a scene of many.
fn turn(scene: &mut Scene) {
    for instance in scene.instances.iter_mut().filter(|i| i.role.blocks()) {
        let turn = DMat4::from_rotation_y(20f64.to_radians());
        instance.world_from_mesh = turn * instance.world_from_mesh;
    }
}

/// A square light over the middle of the ground.
///
/// # Errors
/// As [`generate::square_light`].
pub fn square(side: f64) -> Result<RectangleLight, Problem> {
    generate::square_light(side).map_err(|e| e.to_string())
}

/// The same light, its sides times `by`.
///
/// # Errors
/// A sentence where no light of that size can be.
pub fn scaled(light: &RectangleLight, by: f64) -> Result<RectangleLight, Problem> {
    let frame = light.world_from_light();
    let [a, b] = light.half_extents().map(|half| half * by);
    // Emission is −(u × v), and light space's axes are right-handed about it: v is −y.
    let u = frame.x_axis.truncate() * a;
    let v = -frame.y_axis.truncate() * b;
    RectangleLight::new(light.center(), u, v).map_err(|e| e.to_string())
}

/// One of the project's own files.
///
/// # Errors
/// A sentence where it cannot be read.
pub fn committed(name: &str) -> Result<Scene, Problem> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    from_gltf(&root.join(format!("{name}.glb"))).map_err(|e| e.to_string())
}

/// A scene made in code, by name.
///
/// # Errors
/// A sentence for a name that is not known.
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
            .map_err(|e| format!("suzanne: {e}"))?
            .with_occluders_as(Role::Both),
        curtis::CUBE => curtis::elongated_cube(light),
        curtis::DRAGON => curtis::dragon(light)?,
        model => {
            generate::normalized(&committed(model)?, light).map_err(|e| format!("{model}: {e}"))?
        }
    })
}

/// The bunny over hills, its shadow on what is no plane.
fn over_hills(light: RectangleLight) -> Result<Scene, Problem> {
    let mut scene = generate::normalized(&committed("bunny")?, light).map_err(|e| e.to_string())?;
    for instance in scene.instances.iter().filter(|i| i.role == Role::Receiver) {
        scene.meshes[instance.mesh] = hills(GROUND_SIDE, 96);
    }
    Ok(scene)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_loads_under_every_light_and_the_sizes_grow() {
        for spec in standard() {
            let mut last = 0.0;
            for light in spec.lights() {
                let scene = spec.load(light).unwrap();
                let [a, b] = scene.light(None).unwrap().light.half_extents();
                assert!(a * b > last, "{} {light}", spec.name);
                last = a * b;
                assert!(scene.instances.iter().any(|i| i.role.blocks()));
                assert!(scene.instances.iter().any(|i| i.role.receives()));
            }
        }
    }

    #[test]
    fn a_scaled_light_keeps_its_place_and_side() {
        let scene = committed("bunny").unwrap();
        let light = scene.light(None).unwrap().light;
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
        assert!(own(&empty).unwrap_err().contains("glTF"));
        std::fs::remove_dir(&empty).unwrap();
        assert!(own(&empty).unwrap_err().contains("antumbra-no-scenes"));
    }
}
