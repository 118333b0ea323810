//! Signs of mistakes that meshes show, whatever the camera.

use super::Frame;
use super::boxes::{Boxes, has_triangles};
use crate::lent::MeshInstance;
use crate::stages::depth_layers::LightBox;
use glam::DVec3;

/// Signs of mistakes in the meshes around a light. They are found once, and hold as long as the meshes stay.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Odd {
    /// The first mesh that blocks and does not receive.
    pub occluder_alone: Option<usize>,
    /// Every occluder within the light's reach lies behind it.
    pub occluders_behind: bool,
    /// Every receiver within the light's reach lies behind it.
    pub receivers_behind: bool,
    /// There are occluders, and no mesh that receives.
    pub nothing_receives: bool,
}

impl Odd {
    /// Looks at the meshes of a frame. `none_before` says whether no occluder, and no receiver, lies before the light
    /// and within its reach; meshes are looked at one by one only in these cases.
    pub fn of(frame: &Frame, boxes: &Boxes, none_before: [bool; 2]) -> Self {
        let [no_occluder, no_receiver] = none_before;
        let lent = frame.occluder_maps.is_some();
        let receives = |mesh: &MeshInstance| mesh.role.receives();
        let occludes = |mesh: &MeshInstance| mesh.role.blocks();
        Self {
            occluder_alone: boxes.occluder_alone,
            occluders_behind: no_occluder && !lent && all_behind(frame, occludes),
            receivers_behind: no_receiver && all_behind(frame, receives),
            nothing_receives: no_receiver
                && boxes.blockers > 0
                && !frame.meshes.iter().any(receives),
        }
    }
}

/// Whether some of these meshes are within a light's reach, and all of those behind it.
fn all_behind(frame: &Frame, which: impl Fn(&MeshInstance) -> bool) -> bool {
    let light_from_world = frame.light.rectangle().light_from_world();
    let mut some = false;
    for mesh in frame.meshes.iter().filter(|mesh| which(mesh) && has_triangles(mesh)) {
        let placed = LightBox::of(mesh, &light_from_world);
        let nearest = DVec3::ZERO.max(placed.min).min(placed.max);
        if frame.reach.is_some_and(|reach| nearest.length() > reach) {
            continue;
        }
        if placed.max.z > 0.0 {
            return false;
        }
        some = true;
    }
    some
}
