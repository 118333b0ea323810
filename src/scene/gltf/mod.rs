//! Scenes from glTF 2.0 files.
//!
//! ```text
//! bytes ─ buffers::split ─► JSON ─ json::parse ─► Root ─ nodes::placed ─► nodes in the world
//!                  │                                                   │
//!                  └► binary chunk ► buffers ► accessor ► triangles    ├► extras: light, role
//!                                                             │        └► camera
//!                                                             └────────────► Scene
//! ```
//! A file is a stranger's: whatever it says is an index, a length or a count is held against what
//! there is before it is used, and anything wrong becomes one sentence that names the thing.

mod accessor;
mod buffers;
mod extras;
mod json;
mod nodes;
mod triangles;

use super::{Bounds, Instance, Mesh, Scene, quoted};
use crate::Error;
use glam::{DMat4, DVec3};
use std::path::Path;

/// What is wrong with a file: one sentence, to which the file's name is put before.
type Problem = String;

/// How far from the origin things may lie, in metres. Beyond it f64 itself gets coarser than a
/// shadow's edge, and squares leave f32's range.
const MAX_COORDINATE: f64 = 1e9;

/// Reads a glTF 2.0 scene, `.glb` or `.gltf`.
///
/// - Triangles, strips and fans of the default scene (the first, where none is the default; all
///   nodes, where there is no scene), each node an instance; points and lines are passed over.
///   A mesh that mixes single- and double-sided materials becomes two instances of one name.
/// - Textures are not read. A mesh of whose materials one is not opaque (`alphaMode`) is marked
///   [`Mesh::cut_out`](super::Mesh::cut_out), and its triangles count whole.
/// - Missing normals are flat, as glTF has it. Vertices that no triangle uses are left out.
/// - Skinned and morphed meshes stand at rest, as their vertices say.
/// - Area lights and roles come from the nodes' extras: `"area_light": "rectangle"` with `"width"`,
///   `"height"` (metres, before the node's scale; a height of 0 is a line along the node's X, a width of 0
///   one along its Y, and both shine along its −Z), `"area_light": "polygon"` with `"corners"` (3 to 16 of
///   `[x, y]` in metres in the node's XY plane, before its transform; whichever way they run, it shines along
///   the node's −Z), or `"area_light": "sun"` with `"angular_size"` (radians),
///   wherever the node stands; each optionally with `"color"` and `"intensity"`;
///   `"shadow_role": "occluder"`, `"receiver"` or `"both"`. A scene without a light is returned all
///   the same: [`Scene::light`] is what refuses it.
/// - The camera is that of the first node with a perspective one; orthographic ones are passed over.
/// - Buffers come from the file itself, from data URIs, and from files in its folder or below.
///
/// Instances and lights stand in the order of the file's nodes.
///
/// # Errors
/// [`Error::File`] for a file that cannot be read, is not glTF 2.0, requires an extension that is not
/// supported (any that changes triangles or transforms), contradicts itself, has coordinates that are
/// not finite or beyond 10⁹ m, has no triangles, or has an area light that is no rectangle, polygon or
/// sun.
pub fn from_gltf(path: &Path) -> Result<Scene, Error> {
    let folder = path.parent().filter(|f| !f.as_os_str().is_empty()).unwrap_or(Path::new("."));
    read(path)
        .and_then(|bytes| parse(&bytes, folder))
        .map_err(|problem| Error::File { path: path.display().to_string(), problem })
}

fn read(path: &Path) -> Result<Vec<u8>, Problem> {
    let unreadable = |e: std::io::Error| format!("it cannot be read: {e}");
    // A pipe or a device could keep a reader forever.
    if !std::fs::metadata(path).map_err(unreadable)?.is_file() {
        return Err("it is not a regular file; name a .glb or .gltf".into());
    }
    std::fs::read(path).map_err(unreadable)
}

/// Reads a file's bytes; `folder` is where its external buffers lie.
fn parse(bytes: &[u8], folder: &Path) -> Result<Scene, Problem> {
    let (text, chunk) = buffers::split(bytes)?;
    let root = json::parse(text)?;
    let buffers = buffers::Buffers::new(&root, chunk, folder);
    let mut reader = triangles::Reader::new(&root, &buffers);
    let mut scene = Scene::default();
    // Of each glTF mesh already read, where its triangles are in the scene.
    let mut known: Vec<Option<Vec<(usize, Bounds)>>> = vec![None; root.meshes.len()];

    let all_placed = nodes::placed(&root)?;
    for placed in &all_placed {
        let label = || nodes::label(&root, placed.node);
        let node = json::at(&root.nodes, placed.node, "nodes", label)?;
        if let (None, Some(camera)) = (scene.camera, node.camera) {
            scene.camera = nodes::camera(&root, camera, placed)?;
        }
        let Some(index) = node.mesh else { continue };
        let role = extras::role(&node.extras).map_err(|e| format!("{}: {e}", label()))?;
        let slot = known.get_mut(index).ok_or_else(|| {
            format!("{} refers to meshes[{index}], and the file has {}", label(), root.meshes.len())
        })?;
        let parts = match slot {
            Some(parts) => parts,
            None => slot.insert(add_meshes(&mut scene, reader.read(index)?)),
        };
        for (mesh, bounds) in parts.iter() {
            within_reach(&placed.world, bounds).map_err(|e| format!("{}: {e}", label()))?;
            scene.instances.push(Instance {
                name: nodes::name(&root, placed.node),
                mesh: *mesh,
                world_from_mesh: placed.world,
                role,
            });
        }
    }
    if scene.instances.is_empty() {
        return Err("it has no triangles in its scene, so nothing can cast or show a shadow".into());
    }
    // Lights come last: a sun lies where it shines on all.
    let all = scene.bounds(|i| i.role.blocks()).or_else(|| scene.bounds(|_| true));
    let all = all.unwrap_or(Bounds { min: DVec3::ZERO, max: DVec3::ZERO });
    for placed in &all_placed {
        let node =
            json::at(&root.nodes, placed.node, "nodes", || nodes::label(&root, placed.node))?;
        let light = extras::light(&root, placed.node, &node.extras, &placed.world, &all)?;
        scene.lights.extend(light);
    }
    Ok(scene)
}

/// Appends meshes and says where each is and how far it reaches, in mesh space.
fn add_meshes(scene: &mut Scene, meshes: Vec<Mesh>) -> Vec<(usize, Bounds)> {
    let mut added = Vec::new();
    for mesh in meshes {
        let positions = mesh.positions.iter().map(|p| DVec3::from_array(p.map(f64::from)));
        let bounds = positions.fold(None, |bounds: Option<Bounds>, p| {
            let b = bounds.unwrap_or(Bounds { min: p, max: p });
            Some(Bounds { min: b.min.min(p), max: b.max.max(p) })
        });
        if let Some(bounds) = bounds {
            added.push((scene.meshes.len(), bounds));
            scene.meshes.push(mesh);
        }
    }
    added
}

fn within_reach(world_from_mesh: &DMat4, bounds: &Bounds) -> Result<(), Problem> {
    let reaches = |c: DVec3| world_from_mesh.transform_point3(c).abs().max_element();
    // `max` passes NaN over, so each corner is compared by itself.
    if bounds.corners().into_iter().all(|c| reaches(c) <= MAX_COORDINATE) {
        Ok(())
    } else {
        Err(format!("its mesh reaches further than {MAX_COORDINATE:e} m from the origin"))
    }
}

#[cfg(test)]
mod tests;
