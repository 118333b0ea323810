//! A description of a light, its occluders and its receivers, from their bounding boxes alone, before anything is
//! drawn.

use crate::lent::{Geometry, MeshInstance};
use crate::stages::depth_layers::{self, Eye, LightBox, MapView};
use glam::{DMat4, DVec4};

/// The most occluders that are compared in pairs; more count as overlapping.
const MOST_COMPARED: usize = 16;

/// A light, its occluders and its receivers, as far as their bounding boxes show.
///
/// Distances are from the light's plane along its normal, in metres. They are bounds: the true distances lie between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Situation {
    /// The light's width and height, metres; the height of a line is 0, and a point has neither.
    pub light: [f64; 2],
    /// The number of meshes that may block light on its way to a receiver.
    pub occluders: usize,
    /// The number of all meshes of the frame that block light.
    pub given: usize,
    /// The number of meshes that receive.
    pub receivers: usize,
    /// The number of meshes that block and receive.
    pub both: usize,
    /// The number of occluders that the host draws.
    pub host_drawn: usize,
    /// The number of occluders that the node draws whole although a texture cuts holes into them.
    pub cut_out: usize,
    /// The number of occluders that opacity textures cut out ([`MeshInstance::opacity`]).
    pub textured: usize,
    /// The number of those that let a part of the light through, because their texture has no cutoff.
    pub translucent: usize,
    /// The number of the occluders' triangles, without those of meshes that the host draws.
    pub triangles: u64,
    /// The least and largest distance of occluders; the least is at least 1e-4 of the receivers' largest.
    pub occluder_distances: [f64; 2],
    /// The least and largest distance of receivers where an occluder may shadow them.
    pub receiver_distances: [f64; 2],
    /// Whether every occluder is a sheet: a flat box.
    pub sheets: bool,
    /// Whether some occluder is double-sided and no sheet, and so may be open.
    pub open: bool,
    /// Whether some occluder may hide another from the map's projection point.
    pub overlap: bool,
    /// The largest share of the light, 0 to 1, that an occluder's back hides and its front does not, or the other way
    /// round: Atty 2006 eq. 3 for the occluder's whole thickness, over the light's side.
    pub thickness: f64,
    /// The width of the widest penumbra, across the light's rays, metres.
    pub penumbra: f64,
    /// The width of the widest penumbra in pixels of the smallest size there; infinite where the camera is inside the
    /// region that may be shadowed.
    pub penumbra_pixels: f64,
    /// The most shadow edges that a line of one metre may cross, estimated from the occluders' triangles as if they
    /// cover a face of their box once; infinite where the triangles are not known.
    pub edges: f64,
    /// The most shadow edges across a pixel of the largest size there, 0 to 1.
    pub edges_a_pixel: f64,
    /// The size of a map's texel at the furthest shadow, in pixels of the smallest size there; infinite where the
    /// camera is inside the region. Every technique's edges are off by about this much.
    pub texel_pixels: f64,
    /// The smaller side of the map's view at the occluders' mean distance, metres.
    pub size: f64,
}

/// The inputs of a situation, besides occluders and camera.
pub(crate) struct Seen<'a> {
    pub light: [f64; 2],
    /// The number of meshes that block, whether or not they can shadow anything.
    pub given: usize,
    pub receivers: &'a [LightBox],
    /// The view from the light's centre of the receivers that may be shadowed.
    pub shadowed: &'a MapView,
    /// The view of the technique's map.
    pub map: &'a MapView,
}

/// The camera whose pixels a situation is measured in.
pub(crate) struct Camera {
    pub light_from_world: DMat4,
    pub world_from_ndc: DMat4,
    pub extent: [u32; 2],
}

impl Situation {
    /// Describes a frame by its boxes. `occluders` are those that the node draws. Where the host lends maps there are
    /// none, and the worst case within the maps' view stands for them. The values in pixels are unknown until
    /// [`Self::seen_by`].
    pub(crate) fn of<'a>(
        seen: &Seen,
        occluders: impl Iterator<Item = (&'a MeshInstance, &'a LightBox)>,
    ) -> Self {
        let (shadowed, map) = (seen.shadowed, seen.map);
        let nearest_receiver = seen.receivers.iter().map(|b| b.min.z).fold(f64::INFINITY, f64::min);
        let behind = match map.eye {
            Eye::Behind(behind) => behind,
            Eye::Infinity => 0.0,
        };
        let near = (map.near - behind).max(1e-4 * shadowed.far);
        let mut s = Self {
            light: seen.light,
            occluders: 0,
            given: seen.given,
            receivers: seen.receivers.len(),
            both: 0,
            host_drawn: 0,
            cut_out: 0,
            textured: 0,
            translucent: 0,
            triangles: 0,
            occluder_distances: [near, (map.far - behind).max(near)],
            receiver_distances: [nearest_receiver.max(near), shadowed.far.max(near)],
            sheets: true,
            open: false,
            overlap: false,
            thickness: 0.0,
            penumbra: 0.0,
            penumbra_pixels: f64::INFINITY,
            edges: 0.0,
            edges_a_pixel: 1.0,
            texel_pixels: f64::INFINITY,
            size: 0.0,
        };
        let texel = [0, 1].map(|i| (map.max[i] - map.min[i]) / f64::from(map.side));
        let mut windows = [None; MOST_COMPARED];
        for (mesh, placed) in occluders {
            s.add(mesh, placed);
            // Only the first few are compared.
            if let Some(window) = windows.get_mut(s.occluders) {
                *window = depth_layers::window_of(map.eye, placed, map.near);
                let before = &windows[..s.occluders];
                s.overlap |= before.iter().any(|b| meet(&windows[s.occluders], b, texel));
            } else {
                s.overlap = true;
            }
            s.occluders += 1;
        }
        if s.occluders == 0 {
            s = Self { sheets: false, overlap: true, thickness: 1.0, edges: f64::INFINITY, ..s };
        }
        s.penumbra = s.light[0].max(s.light[1]) * (s.receiver_distances[1] / near - 1.0).max(0.0);
        let middle = 0.5 * (s.occluder_distances[0] + s.occluder_distances[1]);
        let side = (0..2).map(|i| map.max[i] - map.min[i]).fold(f64::INFINITY, f64::min);
        s.size = side * if map.eye == Eye::Infinity { 1.0 } else { middle + behind };
        s
    }

    /// Whether the light is a point, whose shadows have no penumbra.
    pub fn is_point(&self) -> bool {
        self.light == [0.0; 2]
    }

    /// The situation with its values in a camera's pixels filled in.
    pub(crate) fn seen_by(mut self, camera: &Camera, shadowed: &MapView, map: &MapView) -> Self {
        let [smallest, largest] = pixel_sizes(camera, shadowed);
        let inside = smallest <= 0.0;
        self.penumbra_pixels = match (self.is_point(), inside) {
            (true, _) => 0.0,
            (false, true) => f64::INFINITY,
            (false, false) => self.penumbra / smallest,
        };
        self.edges_a_pixel = (self.edges * largest).min(1.0);
        let side = (0..2).map(|i| map.max[i] - map.min[i]).fold(f64::INFINITY, f64::min);
        let reach = match map.eye {
            Eye::Infinity => 1.0,
            Eye::Behind(behind) => self.receiver_distances[1] + behind,
        };
        self.texel_pixels = side * reach / f64::from(map.side) / smallest;
        self
    }

    fn add(&mut self, mesh: &MeshInstance, placed: &LightBox) {
        let triangles = match mesh.geometry {
            Geometry::Buffers(buffers) => {
                let through = mesh.opacity.map(|opacity| opacity.cutoff.is_none());
                self.cut_out += usize::from(mesh.cut_out && through.is_none());
                self.textured += usize::from(through.is_some());
                self.translucent += usize::from(through == Some(true));
                u64::from(buffers.count / 3)
            }
            Geometry::HostDrawn(_) => {
                self.host_drawn += 1;
                self.edges = f64::INFINITY;
                0
            }
        };
        self.triangles += triangles;
        self.both += usize::from(mesh.role.receives());
        let mut sides = [0, 1, 2].map(|axis| placed.edge(axis).length());
        sides.sort_by(f64::total_cmp);
        let face = (sides[2] * sides[1]).sqrt().max(f64::MIN_POSITIVE);
        self.edges = self.edges.max(4.0 * (triangles as f64).sqrt() / face);
        if placed.thin_axis.is_some() {
            return;
        }
        self.sheets = false;
        self.open |= mesh.double_sided;
        let front = placed.min.z.max(self.occluder_distances[0]);
        let back = placed.max.z;
        let receiver = self.receiver_distances[0];
        let thickness = if receiver <= back {
            1.0
        } else {
            0.5 * receiver * (back - front) / (front * (receiver - back))
        };
        self.thickness = self.thickness.max(thickness.clamp(0.0, 1.0));
    }
}

/// The least and largest (u, v) of a box; `None` where the map shows nothing of it.
type Window = Option<([f64; 2], [f64; 2])>;

/// Whether two windows come within a texel of this size of each other.
fn meet(a: &Window, b: &Window, texel: [f64; 2]) -> bool {
    let (Some(a), Some(b)) = (a, b) else { return false };
    (0..2).all(|i| a.1[i] + texel[i] >= b.0[i] && b.1[i] + texel[i] >= a.0[i])
}

/// The width of the smallest and of the largest pixel where shadows may fall, metres; 0 and infinity where the camera
/// is inside that region.
///
/// A pixel at a point is 2w/(W |g|) wide, with w the point's clip coordinate, W the image's width and g the part of the
/// gradient of clip x across the view. w is linear, so that its extremes over the frustum that may be shadowed lie at
/// the frustum's corners.
fn pixel_sizes(camera: &Camera, shadowed: &MapView) -> [f64; 2] {
    let clip_from_world = camera.world_from_ndc.inverse();
    let clip_from_light = clip_from_world * camera.light_from_world.inverse();
    let row = |i: usize| clip_from_light.row(i);
    let center = camera.world_from_ndc * DVec4::new(0.0, 0.0, 0.5, 1.0);
    // The sign that w has in front of the camera.
    let sign = (clip_from_world * (center / center.w)).w.signum();
    let across = |r: DVec4| {
        let view = row(3).truncate();
        let along = view.normalize_or_zero();
        let r = r.truncate();
        (r - along * r.dot(along)).length()
    };
    let per_w = (0..2)
        .map(|i| 2.0 / (f64::from(camera.extent[i]) * across(row(i)).max(f64::MIN_POSITIVE)))
        .fold([f64::INFINITY, 0.0], |[least, most]: [f64; 2], x| [least.min(x), most.max(x)]);
    let v = shadowed;
    let mut w = [f64::INFINITY, 0.0f64];
    for i in 0..8 {
        let d = if i & 4 == 0 { v.near } else { v.far };
        let u = if i & 1 == 0 { v.min[0] } else { v.max[0] };
        let t = if i & 2 == 0 { v.min[1] } else { v.max[1] };
        let at = sign * row(3).dot(DVec4::new(u * d, t * d, d, 1.0));
        w = [w[0].min(at), w[1].max(at)];
    }
    // A corner lies behind the camera, or the matrix does not say what does.
    if !(w[0] > 0.0 && w[0] <= w[1] && w[1].is_finite()) {
        return [0.0, f64::INFINITY];
    }
    [w[0] * per_w[0], w[1] * per_w[1]]
}
