//! Scenes from glTF 2.0 files.
//!
//! ```text
//! bytes ─ buffers::split ─► JSON ─ json::parse ─► Root ─ nodes::placed ─► nodes in the world
//!                  │                         └► Document ► surfaces        │
//!                  └► binary chunk ► buffers ► accessor ► triangles        ├► extras: light, role
//!                                                             │            └► camera
//!                                                             └────────────────► Scene
//! ```
//! A file is a stranger's: whatever it says is an index, a length or a count is held against what
//! there is before it is used, and anything wrong becomes one sentence that names the thing.

mod accessor;
mod animation;
mod area;
mod attributes;
mod buffers;
mod document;
#[cfg(feature = "draco")]
mod draco;
mod emissive;
mod extensions;
mod extras;
mod images;
mod instances;
mod json;
mod meshes;
#[cfg(feature = "meshopt")]
mod meshopt;
mod nodes;
mod notes;
mod outline;
mod placing;
mod pose;
mod punctual;
#[cfg(any(feature = "draco", feature = "meshopt"))]
mod room;
mod source;
mod surfaces;
mod triangles;

use super::{Bounds, Instance, Role, Scene};
use crate::Error;
use glam::{DMat4, DVec3};
use std::path::Path;

/// A problem with a file, as a sentence that is shown after the file's name.
type Problem = String;

/// The largest distance of things from the origin, in metres. Beyond it f64 itself gets coarser than a
/// shadow's edge, and squares leave f32's range.
const MAX_COORDINATE: f64 = 1e9;

/// Reads a glTF 2.0 scene, `.glb` or `.gltf`.
///
/// - Triangles, strips and fans of the default scene (the first, where none is the default; all
///   nodes, where there is no scene; [`from_gltf_as`] takes another), each node an instance; points and lines are passed over.
///   A mesh that mixes single- and double-sided materials, or such as stop light differently, becomes an instance for each,
///   of one name.
/// - Where a surface stops light, and how much of it, is what its alpha says (`alphaMode` `MASK` or `BLEND`), and its
///   transmission (KHR_materials_transmission): of the textures that take part, PNG, JPEG and WebP images are read into
///   [`Scene::opacity_maps`]. A mesh whose texture cannot be read is [`Mesh::cut_out`](super::Mesh::cut_out) without a map
///   and counts whole, and [`Scene::notes`] says why. It names the alpha of a vertex's color too, which
///   is passed over.
/// - Positions and normals may be integers (KHR_mesh_quantization). A node may place its mesh many times
///   (EXT_mesh_gpu_instancing); all are instances of the node's name. Nodes that are not visible, and what is below them,
///   have neither triangles nor lights (KHR_node_visibility).
/// - Missing normals are flat, as glTF has it. Vertices that no triangle uses are left out.
/// - Meshes may be compressed by Draco (KHR_draco_mesh_compression), with the crate's feature `draco`. Those that have
///   their elements without compression too are read from these.
/// - Morph targets go as far as the weights of the node or the mesh say. Skinned meshes stand where the joints do, of
///   which a vertex has up to eight; their own nodes' transforms do not matter.
/// - Area lights and roles come from the nodes' extras: `"area_light": "rectangle"` with `"width"`,
///   `"height"` (metres, before the node's scale; a height of 0 is a line along the node's X, a width of 0
///   one along its Y, and both shine along its −Z), `"area_light": "polygon"` with `"corners"` (3 to 16 of
///   `[x, y]` in metres in the node's XY plane, before its transform; whichever way they run, it shines along
///   the node's −Z), or `"area_light": "sun"` with `"angular_size"` (radians),
///   wherever the node stands; each optionally with `"color"` and `"intensity"`;
///   `"shadow_role": "occluder"`, `"receiver"` or `"both"`. A scene without a light is returned all
///   the same: [`Scene::light`] is what refuses it.
/// - Lights of the drafts EXT_lights_area and KHR_lights_area, as they stand.
/// - Lights of KHR_lights_punctual: a point is a sphere, a spot a disc, each of the `"radius"` (metres, whatever the scale) in
///   the extras of its node or its own, and a point without one; a directional light is a sun of its `"angular_size"`, or
///   0.0093. A spot's cone and a range are passed over. Nodes with an area light have that alone.
/// - The camera is that of the first node with one, perspective or orthographic; [`Scene::set_camera`] takes another.
/// - Buffers come from the file itself, from data URIs, and from files in its folder or below.
/// - A mesh whose vertices lie far from the origin of its own space is moved there, and its instances the other way
///   ([`Mesh::move_to_origin`](super::Mesh::move_to_origin)).
/// - Meshes that differ in name and material alone, and so look the same in a shadow, are one
///   [`Mesh`](super::Mesh).
///
/// Instances and lights stand in the order of the file's nodes.
///
/// The file may be a stranger's. Memory is at most 256 bytes for each byte of the file and the files of
/// its buffers, and 1 MiB; where meshes are compressed, twice that and 64 MiB, since what they decode to is held to
/// 64 bytes for each byte and 16 MiB. Time grows with them and no faster; the stack is of no account, 128 KiB will
/// do. So that this holds, all meshes together have no more triangles than there are bytes, of which real
/// ones take twenty, and what is compressed counts as it decodes. What instances draw together is a product, which nothing bounds: [`Scene::triangles`]
/// counts it before anything is drawn.
///
/// # Errors
/// [`Error::File`] for a file that cannot be read, is not glTF 2.0, requires an extension that is not
/// supported (any that changes triangles or transforms), contradicts itself, has coordinates that are
/// not finite or beyond 10⁹ m, has no triangles, more than one a byte, or more than 2²⁵, or has an area
/// light that is no rectangle, polygon or sun.
pub fn from_gltf(path: &Path) -> Result<Scene, Error> {
    from_gltf_as(path, &GltfOptions::default())
}

/// What is shown of a glTF file that has more than one scene, or moves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GltfOptions<'a> {
    /// The scene, by its name or its number; `None` for the default scene.
    pub scene: Option<&'a str>,
    /// An animation, by its name or its number, and the time of it in seconds: nodes and morph targets are where it has
    /// them then. Before its first key and after its last it stands still. `None` for the nodes as they are.
    pub animation: Option<(&'a str, f64)>,
    /// The radius in metres of point and spot lights whose extras say none; 0 for points.
    pub light_radius: f64,
    /// Meshes that shine are area lights, behind the others: of each primitive whose material has an `emissiveFactor`, times
    /// that of KHR_materials_emissive_strength, the plane parts that hang together, along their fronts, eight an instance at
    /// most and 64 a file. A part with up to 16 corners is a rectangle or a polygon as it is; one with more has the 16 that
    /// matter most, one with holes has none, and both are brighter by what that takes or adds. Such a mesh is a
    /// [`Role::Receiver`]: it stands in no light's way. [`Scene::notes`] says what of it is no light. Of all meshes that
    /// shine 65,536 triangles are looked at, which takes 32 MiB of memory.
    pub emissive: bool,
}

/// Reads a glTF 2.0 scene as [`from_gltf`] does, of the scene and at the time that `options` say.
///
/// # Errors
/// See [`from_gltf`]; also for a scene or an animation that the file has not, times that do not rise, and values that are
/// not finite.
pub fn from_gltf_as(path: &Path, options: &GltfOptions) -> Result<Scene, Error> {
    let bytes = read(path).map_err(|problem| about(path, problem))?;
    from_bytes(&bytes, path, options)
}

/// Reads a glTF file that is in memory already, perhaps from an archive; see [`from_gltf`]. Errors name it by `path`,
/// in whose folder buffer files are looked for; no file has to exist at `path`.
///
/// # Errors
/// See [`from_gltf`].
pub fn from_gltf_bytes(bytes: &[u8], path: &Path) -> Result<Scene, Error> {
    from_bytes(bytes, path, &GltfOptions::default())
}

fn from_bytes(bytes: &[u8], path: &Path, options: &GltfOptions) -> Result<Scene, Error> {
    let folder = path.parent().filter(|f| !f.as_os_str().is_empty()).unwrap_or(Path::new("."));
    parse(bytes, folder, options).map_err(|problem| about(path, problem))
}

fn about(path: &Path, problem: Problem) -> Error {
    Error::File { path: path.display().to_string(), problem }
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
fn parse(bytes: &[u8], folder: &Path, options: &GltfOptions) -> Result<Scene, Problem> {
    let (text, chunk) = buffers::split(bytes)?;
    let mut root = json::parse(text)?;
    let document: document::Document = json::from_json(text)?;
    #[cfg(feature = "draco")]
    draco::mark(&mut root);
    if let Some(scene) = options.scene {
        let names = root.scenes.iter().map(|scene| scene.name.as_str());
        root.scene = Some(json::by_name("scene", names, scene)?);
    }
    if let Some(animation) = options.animation {
        // Nodes move before anything stands at them; what it reads of buffers is let go again.
        let buffers = buffers::Buffers::new(&root, bytes.len(), chunk, folder);
        let changes = animation::Changes::at(&root, &buffers, &document, animation)?;
        changes.apply(&mut root)?;
    }
    let buffers = buffers::Buffers::new(&root, bytes.len(), chunk, folder);
    let (all_placed, worlds) = nodes::placed(&root)?;
    let reader = triangles::Reader::new(&root, &buffers, &document, options.emissive);
    let mut meshes = meshes::Meshes::new((&root, &document), &buffers, reader, &worlds);
    let mut shining = emissive::Shining::default();
    let mut places = instances::Places::new(&root, &buffers);
    let mut scene = Scene::default();

    for placed in &all_placed {
        let label = || nodes::label(&root, placed.node);
        let node = json::at(&root.nodes, placed.node, "nodes", label)?;
        if let Some(camera) = node.camera {
            let camera = nodes::camera(&root, camera, placed)?;
            scene.cameras.push((nodes::name(&root, placed.node), camera));
            scene.camera.get_or_insert(camera);
        }
        let Some(index) = node.mesh.filter(|_| !placed.hidden) else { continue };
        let role = extras::role(&node.extras).map_err(|e| format!("{}: {e}", label()))?;
        let (found, skin) = meshes.find(index, placed.node)?;
        // A skin's joints place its mesh, and its node does not (glTF 2.0 §3.7.3.3).
        let worlds = match skin {
            Some(origin) => vec![DMat4::from_translation(origin)],
            None => places.of(placed)?,
        };
        places.split(placed, [worlds.len(), found.len()])?;
        let name = nodes::name_of_instances(&root, placed.node, [worlds.len(), found.len()]);
        for (world, mesh) in worlds.iter().flat_map(|w| found.clone().map(move |mesh| (w, mesh))) {
            let world_from_mesh = *world * DMat4::from_translation(meshes.origins[mesh]);
            meshes::within_reach(&world_from_mesh, &meshes.boxes[mesh])
                .map_err(|e| format!("{}: {e}", label()))?;
            let mut instance = Instance { name: name.clone(), mesh, world_from_mesh, role };
            if let Some(emission) = meshes.emissions[mesh] {
                // It lies where its own lights do, and would stand before them.
                instance.role = Role::Receiver;
                let notes = &mut meshes.reader.surfaces.notes;
                shining.add(&meshes.read[mesh], &instance, emission, notes);
            }
            scene.instances.push(instance);
        }
    }
    if scene.instances.is_empty() {
        return Err("it has no triangles in its scene, so nothing can cast or show a shadow".into());
    }
    // Lights come last: a sun lies where it shines on all.
    let all = meshes.around(&scene.instances, |i| i.role.blocks());
    let all = all.or_else(|| meshes.around(&scene.instances, |_| true));
    let all = all.unwrap_or(Bounds { min: DVec3::ZERO, max: DVec3::ZERO });
    for placed in all_placed.iter().filter(|placed| !placed.hidden) {
        let node =
            json::at(&root.nodes, placed.node, "nodes", || nodes::label(&root, placed.node))?;
        // An area light is what a node with both was given on purpose.
        let mut light = extras::light(&root, placed.node, &node.extras, &placed.world, &all)?;
        if light.is_none() {
            light = area::light((&root, &document), placed)?;
        }
        if light.is_none() {
            light = punctual::light((&root, &document), placed, &all, options.light_radius)?;
        }
        scene.lights.extend(light);
    }
    scene.meshes = meshes.read;
    let mut surfaces = meshes.reader.surfaces;
    scene.lights.extend(shining.lights(&mut surfaces.notes));
    scene.opacity_maps = surfaces.maps;
    scene.notes = surfaces.notes.sentences();
    Ok(scene)
}

#[cfg(test)]
mod tests;
