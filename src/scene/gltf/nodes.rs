//! The node hierarchy: where everything stands, and the camera.

use super::json::{self, Root, at};
use super::{MAX_COORDINATE, Problem};
use crate::error::quoted;
use crate::scene::{Camera, Lens};
use glam::{DMat3, DMat4, DQuat, DVec3};
use std::f64::consts::PI;

/// A node of the scene.
pub(super) struct Placed {
    /// Index into the file's nodes.
    pub node: usize,
    /// The finite transform from the node's space to the world.
    pub world: DMat4,
    /// Whether its meshes and lights are not to be seen, for its own sake or that of a node above.
    pub hidden: bool,
}

/// The largest difference of a matrix's last row from 0, 0, 0, 1, for files that write it as f32.
const AFFINE: f64 = 1e-5;

/// The node's name, or `node N`.
pub(super) fn name(root: &Root, node: usize) -> String {
    match root.nodes.get(node).and_then(|n| n.name.as_deref()) {
        Some(name) if !name.is_empty() => name.into(),
        _ => format!("node {node}"),
    }
}

/// The most characters of a name that more than one instance has: each keeps a copy.
const SHARED_NAME: usize = 64;

/// The name of a node's instances: of a mesh at so many places, in so many parts.
pub(super) fn name_of_instances(root: &Root, node: usize, [places, parts]: [usize; 2]) -> String {
    let name = name(root, node);
    match name.char_indices().nth(SHARED_NAME) {
        Some((end, _)) if places > 1 || parts > 2 => {
            format!("{}…", name.get(..end).unwrap_or_default())
        }
        _ => name,
    }
}

/// The node as a sentence names it: `node "lamp"`, or `node 3`.
pub(super) fn label(root: &Root, node: usize) -> String {
    match root.nodes.get(node).and_then(|n| n.name.as_deref()) {
        Some(name) if !name.is_empty() => format!("node {}", quoted(name)),
        _ => format!("node {node}"),
    }
}

/// The nodes of the default scene that something stands at, with their transforms, in the order of the file; and where
/// there are skins, the transforms of all nodes to the world, which are 1 for those outside the scene.
pub(super) fn placed(root: &Root) -> Result<(Vec<Placed>, Vec<DMat4>), Problem> {
    let is_skinned = root.nodes.iter().any(|node| node.skin.is_some());
    let skinned = if is_skinned { root.nodes.len() } else { 0 };
    let mut worlds = vec![DMat4::IDENTITY; skinned];
    // The transforms of what has children, and whether it is hidden. They wait in a list, not on the call stack, which
    // a deep file could exhaust.
    let mut parents = vec![(DMat4::IDENTITY, false)];
    let mut waiting: Vec<(usize, usize)> = roots(root)?.into_iter().map(|node| (node, 0)).collect();
    let mut seen = vec![false; root.nodes.len()];
    let mut placed = Vec::new();
    while let Some((index, parent)) = waiting.pop() {
        let node = at(&root.nodes, index, "nodes", || "the scene".into())?;
        // A tree reaches each node once; anything else may be a cycle, or as bad: 2^n paths.
        if std::mem::replace(&mut seen[index], true) {
            return Err(format!(
                "{} is reached twice; a node may have one parent, and none of its own children as that",
                label(root, index)
            ));
        }
        let local = local(root, index).map_err(|e| format!("{}: {e}", label(root, index)))?;
        let (above, hidden) = parents[parent];
        let world = above * local;
        let visibility = node.extensions.as_deref().and_then(|e| e.visibility.as_ref());
        let hidden = hidden || visibility.is_some_and(|v| !v.visible);
        if !world.is_finite() {
            return Err(format!("{}: its transform is not finite", label(root, index)));
        }
        if let Some(of_node) = worlds.get_mut(index) {
            *of_node = world;
        }
        for child in &node.children {
            at(&root.nodes, *child, "nodes", || label(root, index))?;
            waiting.push((*child, parents.len()));
        }
        if !node.children.is_empty() {
            parents.push((world, hidden));
        }
        let shines = node.extensions.as_ref().is_some_and(|e| e.shines());
        if node.mesh.is_some() || node.camera.is_some() || shines || !node.extras.is_null() {
            placed.push(Placed { node: index, world, hidden });
        }
    }
    placed.sort_by_key(|p| p.node);
    Ok((placed, worlds))
}

fn roots(root: &Root) -> Result<Vec<usize>, Problem> {
    if root.scene.is_some() || !root.scenes.is_empty() {
        let index = root.scene.unwrap_or(0);
        return Ok(at(&root.scenes, index, "scenes", || "its member \"scene\"".into())?
            .nodes
            .clone());
    }
    let mut is_child = vec![false; root.nodes.len()];
    for child in root.nodes.iter().flat_map(|n| &n.children) {
        if let Some(flag) = is_child.get_mut(*child) {
            *flag = true;
        }
    }
    Ok((0..root.nodes.len()).filter(|node| !is_child[*node]).collect())
}

/// The node's transform to its parent's space.
fn local(root: &Root, index: usize) -> Result<DMat4, Problem> {
    let node = at(&root.nodes, index, "nodes", || "the scene".into())?;
    if let Some(matrix) = node.matrix.as_deref() {
        let m = DMat4::from_cols_array(matrix);
        let last = m.row(3) - glam::DVec4::W;
        // Written so that NaN is refused too.
        if !(last.abs().max_element() <= AFFINE && m.is_finite()) {
            return Err("its matrix is not finite and affine; its last row must be 0 0 0 1".into());
        }
        return Ok(DMat4::from_cols(
            m.x_axis.with_w(0.0),
            m.y_axis.with_w(0.0),
            m.z_axis.with_w(0.0),
            m.w_axis.with_w(1.0),
        ));
    }
    let translation = node.translation.as_deref().map_or(DVec3::ZERO, |t| DVec3::from_array(*t));
    let scale = node.scale.as_deref().map_or(DVec3::ONE, |s| DVec3::from_array(*s));
    let rotation = node.rotation.as_deref().map_or(DQuat::IDENTITY, |r| DQuat::from_array(*r));
    // Written as f32, quaternions are not quite of length 1, and a length is a scale.
    let length = rotation.length();
    if !(length.is_normal() && translation.is_finite() && scale.is_finite()) {
        return Err(
            "its translation, rotation and scale must be finite, and the rotation not 0".into()
        );
    }
    Ok(DMat4::from_scale_rotation_translation(scale, rotation / length, translation))
}

/// The lens and the near plane of `cameras[index]`.
fn lens(camera: &json::Camera, index: usize) -> Result<(Lens, f64), Problem> {
    let wrong = |what: String| Err(format!("cameras[{index}] has {what}"));
    match (&camera.perspective, &camera.orthographic) {
        (Some(of), _) => {
            let (yfov, near) = (of.yfov, of.znear);
            if !(yfov > 0.0 && yfov < PI) {
                return wrong(format!("a yfov of {yfov}; it must be between 0 and π"));
            }
            if !(near > 0.0 && near.is_finite()) {
                return wrong(format!("a znear of {near}; it must be above 0"));
            }
            Ok((Lens::Perspective { yfov }, near))
        }
        (None, Some(of)) => {
            // A negative size mirrors, which glTF advises against and says nothing of.
            let half = [of.xmag, of.ymag].map(f64::abs);
            let (near, far) = (of.znear, of.zfar);
            if !half.iter().all(|x| (1e-9..=MAX_COORDINATE).contains(x)) {
                let [x, y] = [of.xmag, of.ymag];
                return wrong(format!(
                    "an xmag of {x} and a ymag of {y}; they must be above 0 and finite"
                ));
            }
            if !(near >= 0.0 && far > near && far <= MAX_COORDINATE) {
                return wrong(format!(
                    "a znear of {near} and a zfar of {far}; zfar must be beyond znear, and that at 0 or more"
                ));
            }
            Ok((Lens::Orthographic { half, far }, near))
        }
        (None, None) => wrong("neither a perspective nor an orthographic projection".into()),
    }
}

/// `cameras[index]`, seen from a node.
pub(super) fn camera(root: &Root, index: usize, at_node: &Placed) -> Result<Camera, Problem> {
    let camera = at(&root.cameras, index, "cameras", || label(root, at_node.node))?;
    let (lens, near) = lens(camera, index)?;
    let clip_from_view =
        Camera { world_from_view: DMat4::IDENTITY, lens, near }.clip_from_view(1.0);
    if !clip_from_view.inverse().is_finite() || !clip_from_view.determinant().is_normal() {
        return Err(format!(
            "cameras[{index}] has numbers beyond those that a projection can have"
        ));
    }
    // A camera's scale has no meaning (glTF 2.0 §3.10.3): keep where it looks, then what is up.
    let m = at_node.world;
    let z = m.z_axis.truncate().try_normalize();
    let x = z.and_then(|z| m.y_axis.truncate().cross(z).try_normalize().map(|x| (x, z)));
    let eye = m.w_axis.truncate();
    let Some((x, z)) = x.filter(|_| eye.abs().max_element() <= MAX_COORDINATE) else {
        return Err(format!(
            "{}: no view can be had from its transform, which is flat or out of reach",
            label(root, at_node.node)
        ));
    };
    let mut world_from_view = DMat4::from_mat3(DMat3::from_cols(x, z.cross(x), z));
    world_from_view.w_axis = eye.extend(1.0);
    Ok(Camera { world_from_view, lens, near })
}
