//! The host's G-buffer as passes over its pixels read it.

use crate::graph::{Access, Graph, Need, Pass, ResourceId, Use};
use crate::stages::views::{Region, Served};
use bytemuck::{Pod, Zeroable};
use glam::{DMat4, DVec3};

/// The binding of the lent normals (`light_space.glsl`), behind all that passes bind of their own.
const NORMAL_AT: u8 = 18;
/// The binding of the constants.
const CONSTANTS_AT: u8 = 19;

/// Where the regions of the view and of the next finer one begin in the buffer of constants, in bytes.
const REGIONS_AT: u64 = (size_of::<Constants>() + size_of::<NormalConstants>()) as u64;

/// Where the nearest occluders before the receivers of both begin in it, in bytes.
const NEAREST_AT: u64 = REGIONS_AT + size_of::<RegionConstants>() as u64;

/// Where the nearest occluder before a view's receivers is in the buffer of constants, in floats. Passes read that of
/// their own view and of the next finer one, so that every other view has the same place.
pub(crate) fn nearest_at(view: u32) -> u32 {
    (NEAREST_AT / 4) as u32 + view % 2
}

/// The host's G-buffer, as resources of the graph.
#[derive(Clone, Copy, Debug)]
pub struct GBuffer {
    /// The depth image, as the host's camera sees the scene.
    pub depth: ResourceId,
    /// The image of roles: red 1 blocks and receives, ½ receives only, 0 receives nothing. Without it every pixel has
    /// 1.
    pub mask: Option<ResourceId>,
    /// The image of the surfaces' normals.
    pub normal: Option<ResourceId>,
    /// The buffer of [`Constants`].
    pub constants: ResourceId,
    /// Width and height in pixels.
    pub extent: [u32; 2],
    /// The depth of a pixel that shows no surface.
    pub background: f32,
}

/// The numbers of camera and G-buffer that all passes over the pixels read (`light_space.glsl`).
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Constants {
    /// Normalized device coordinates to light space, by column.
    pub light_from_ndc: [f32; 16],
    /// A plane of column, row and depth to its normal's x, y and z in light space, on the viewer's side.
    pub plane_to_normal: [[f32; 4]; 3],
    /// The G-buffer's width and height.
    pub extent: [i32; 2],
    /// The depth of a pixel that shows no surface.
    pub background: f32,
    /// Bit 0: there is a mask; bits 1 to 3: the [encoding](crate::NormalEncoding) of lent normals, 0 without them;
    /// bit 4: light is parallel; bits 8 to 11: the view, of those that share the pixels; bits 12 to 15: the last of these.
    pub flags: i32,
}

/// The numbers behind [`Constants`] that passes over the pixels read where normals are lent.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct NormalConstants {
    /// The space of the lent normals to light space, by column; the fourth number of each is not read.
    pub light_from_normal: [[f32; 4]; 3],
}

/// The numbers behind [`NormalConstants`]: the regions of the view and of the next finer one.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct RegionConstants {
    /// Each in its own view's space.
    regions: [Region; 2],
    /// How far aside of the view's window the finer one's middle is, tangents; the last two are not read.
    finer_aside: [f32; 4],
}

impl NormalConstants {
    /// The numbers for the space of a view that looks `aside`.
    pub(crate) fn seen_aside(&self, [x, y]: [f64; 2]) -> Self {
        let [s, t] = [x as f32, y as f32];
        let turned = |[x, y, z, _]: [f32; 4]| [x, y, z + s * x + t * y, 0.0];
        Self { light_from_normal: self.light_from_normal.map(turned) }
    }
}

/// A plane (a, b, c, d) of the image, which holds what a column + b row + c depth + d is 0 of, to x, y and z of its
/// normal in light space, on the viewer's side: the inverse's transpose, as for all planes, of which a normal takes
/// three rows. The largest number is 1.
///
/// The viewer is where column and row do not matter, at depth infinity, or in that direction for an orthographic camera.
pub(crate) fn plane_to_normal(
    light_from_ndc: &DMat4,
    ndc_from_light: &DMat4,
    extent: [u32; 2],
    background: f32,
) -> [[f32; 4]; 3] {
    let [width, height] = extent.map(f64::from);
    let first = DVec3::new(1.0 / width - 1.0, 1.0 / height - 1.0, 0.0);
    let ndc_from_pixel = DMat4::from_translation(first)
        * DMat4::from_scale(DVec3::new(2.0 / width, 2.0 / height, 1.0));
    let inverse = ndc_from_pixel.inverse() * *ndc_from_light;
    let columns = [inverse.x_axis, inverse.y_axis, inverse.z_axis];
    let eye = light_from_ndc.z_axis.w as f32;
    let is_towards = if eye == 0.0 { background != 0.0 } else { eye < 0.0 };
    let most = columns.iter().fold(0.0, |most, column| column.abs().max_element().max(most));
    let scale = if is_towards { 1.0 / most } else { -1.0 / most };
    columns.map(|column| (scale * column).as_vec4().to_array())
}

impl Constants {
    /// Adds the buffer that holds the constants.
    pub(crate) fn declare(graph: &mut Graph) -> ResourceId {
        graph.buffer("gbuffer.constants", NEAREST_AT + 8)
    }

    /// The constants for one of the views that share the pixels.
    pub(crate) fn for_view(&self, view: usize, count: usize) -> Self {
        let last = count as i32 - 1;
        Self { flags: self.flags | (view as i32) << 8 | last << 12, ..*self }
    }

    /// The constants in the space of a view. Its planes are those of light space, with x and y times what the view looks
    /// aside added to the z of their normals.
    pub(crate) fn seen_aside(&self, light_from_ndc: &DMat4, view: &Served) -> Self {
        if view.aside == [0.0; 2] {
            return *self;
        }
        let view_from_ndc = view.view_from_light() * *light_from_ndc;
        let [x, y, z] = self.plane_to_normal;
        let [s, t] = view.aside.map(|tangent| tangent as f32);
        let z = std::array::from_fn(|i| z[i] + s * x[i] + t * y[i]);
        Self {
            light_from_ndc: view_from_ndc.as_mat4().to_cols_array(),
            plane_to_normal: [x, y, z],
            ..*self
        }
    }

    /// Adds the pass that writes the constants, and where normals are lent the one that writes theirs.
    pub(crate) fn write(
        &self,
        normals: Option<&NormalConstants>,
        graph: &mut Graph,
        buffer: ResourceId,
        need: &Need,
    ) {
        graph.push(Pass::constants("gbuffer.constants", buffer, 0, self, need));
        if let Some(normals) = normals {
            let behind = size_of::<Self>() as u64;
            graph.push(Pass::constants("gbuffer.normals", buffer, behind, normals, need));
        }
    }

    /// Adds the passes that write the regions of one of several views that share the pixels, the finest first, and of the
    /// next finer one. The last view has all that others leave, and its passes are the first.
    pub(crate) fn write_regions(
        graph: &mut Graph,
        buffer: ResourceId,
        (view, views): (usize, &[Served]),
        need: &Need,
    ) {
        let is_last = view + 1 == views.len();
        let own = if is_last { Region::ALL } else { views[view].region };
        let finer = view.checked_sub(1).map(|finer| &views[finer]);
        let [x, y] = finer.map_or([0.0; 2], |finer| {
            [0, 1].map(|i| (finer.aside[i] - views[view].aside[i]) as f32)
        });
        let regions = RegionConstants {
            regions: [own, finer.map_or(Region::NONE, |finer| finer.region)],
            finer_aside: [x, y, 0.0, 0.0],
        };
        graph.push(Pass::constants("gbuffer.regions", buffer, REGIONS_AT, &regions, need));
        if is_last {
            // The nearest occluders are found on the device, where views from the light's centre want them.
            graph.push(Pass::constants("gbuffer.nearest", buffer, NEAREST_AT, &[-1.0f32; 2], need));
        }
    }
}

impl GBuffer {
    /// The uses of depth and mask at bindings 0 and 1; without a mask the depth is bound there and not read.
    pub fn bound(&self) -> [Use; 2] {
        [
            Use::bound(0, self.depth, Access::SampledCompute),
            Use::bound(1, self.mask.unwrap_or(self.depth), Access::SampledCompute),
        ]
    }

    /// The uses of everything that tells a pixel's place, plane and role: depth, mask, normals and constants. Where an
    /// image is not lent, the depth is bound in its place and not read.
    pub(crate) fn all_bound(&self) -> [Use; 4] {
        let [depth, mask] = self.bound();
        let normal = self.normal.unwrap_or(self.depth);
        [depth, mask, Use::bound(NORMAL_AT, normal, Access::SampledCompute), self.constants_use()]
    }

    /// The use of the constants alone.
    pub(crate) fn constants_use(&self) -> Use {
        Use::bound(CONSTANTS_AT, self.constants, Access::BufferReadCompute)
    }
}

#[cfg(test)]
mod tests {
    use super::plane_to_normal;
    use crate::techniques::common::twin::{normal_of_plane, towards_viewer};
    use glam::{DMat4, DVec3};

    const EXTENT: [u32; 2] = [640, 480];

    /// Cameras, each with the depth of its background: perspectives with a far plane at infinity, at 90 m and reversed
    /// there, and two without.
    fn cameras() -> [(DMat4, f32); 5] {
        let by_rows = |rows: [[f64; 4]; 4]| DMat4::from_cols_array_2d(&rows).transpose();
        let scaled = |depth: [f64; 4], w: [f64; 4]| {
            by_rows([[1.6, 0.0, 0.0, 0.0], [0.0, -2.1, 0.0, 0.0], depth, w])
        };
        let [away, everywhere] = [[0.0, 0.0, -1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
        let far = 90.0 / 89.9;
        [
            (scaled([0.0, 0.0, 0.0, 0.1], away), 0.0),
            (scaled([0.0, 0.0, -far, -0.1 * far], away), 1.0),
            (scaled([0.0, 0.0, far - 1.0, 0.1 * far], away), 0.0),
            (scaled([0.0, 0.0, -0.01, 0.0], everywhere), 1.0),
            (scaled([0.0, 0.0, 0.01, 1.0], everywhere), 0.0),
        ]
    }

    /// A plane's normal by its depths in neighbouring pixels is the plane's, on the viewer's side, however far away
    /// light space has its origin.
    #[test]
    fn depths_of_a_plane_give_its_normal() {
        for (clip_from_view, background) in cameras() {
            for distance in [3.0, 1e5] {
                let view_from_light = DMat4::from_rotation_x(0.4)
                    * DMat4::from_rotation_y(1.1)
                    * DMat4::from_translation(DVec3::new(0.3, -0.2, -distance));
                let ndc_from_light = clip_from_view * view_from_light;
                let light_from_ndc = ndc_from_light.inverse();
                let m = plane_to_normal(&light_from_ndc, &ndc_from_light, EXTENT, background);
                let normal = DVec3::new(0.3, 0.8, 0.5).normalize();
                // The plane through a point five metres before the viewer.
                let view_from_here = clip_from_view.inverse();
                let depth_at = |[x, y]: [f64; 2]| {
                    let ndc = [2.0 * (x + 0.5) / 640.0 - 1.0, 2.0 * (y + 0.5) / 480.0 - 1.0];
                    let on_ray =
                        |z: f64| view_from_here.project_point3(DVec3::new(ndc[0], ndc[1], z));
                    let [a, b] = [on_ray(0.25), on_ray(0.75)];
                    let height = |p: DVec3| normal.dot(p - DVec3::new(0.0, 0.0, -5.0));
                    let place = a + (b - a) * (height(a) / (height(a) - height(b)));
                    clip_from_view.project_point3(place).z
                };
                let at = [200.0, 300.0];
                let depth = depth_at(at);
                let steps = [depth_at([201.0, 300.0]) - depth, depth_at([200.0, 301.0]) - depth];
                let matrix: Vec<f32> = m.iter().flatten().copied().collect();
                let single = |v: [f64; 2]| v.map(|c| c as f32);
                let found = normal_of_plane(&matrix, single(at), depth as f32, single(steps));
                let found = DVec3::from_array(found.map(f64::from));
                let expected = view_from_light.inverse().transform_vector3(normal);
                let columns = light_from_ndc.to_cols_array();
                let ndc = DVec3::new(401.0 / 640.0 - 1.0, 601.0 / 480.0 - 1.0, depth);
                let place = light_from_ndc.project_point3(ndc).to_array();
                let viewer = towards_viewer(&columns, place, f64::from(background));
                let side = expected.dot(DVec3::from_array(viewer)).signum();
                let off = (found - side * expected).length();
                assert!(off < 2e-4, "{clip_from_view} from {distance} m: {found}, not {expected}");
            }
        }
    }
}
