//! What of a frame and its meshes is refused.

use super::*;
use antumbra::Light;
use antumbra::{LightIndex, Slot, TechniqueIndex};

#[test]
fn frames() {
    use Lends::{GBuffer, Maps};
    let f = framed;
    refuses(vec![
        f("a slot that is not there", |f| f.slot = Slot(2), &["slot 2", "2 frames in flight"]),
        f("a light that is not there", |f| f.light_index = LightIndex(1), &["light 1", "has 1"]),
        f(
            "settings that are not there",
            |f| f.technique_index = TechniqueIndex(3),
            &["technique 3", "has 1"],
        ),
        f(
            "a camera of NaN",
            |f| f.world_from_ndc.x_axis.x = f64::NAN,
            &["world_from_ndc", "finite"],
        ),
        f(
            "a camera of infinity",
            |f| f.world_from_ndc.w_axis.y = f64::INFINITY,
            &["world_from_ndc"],
        ),
        f(
            "a singular camera",
            |f| f.world_from_ndc = DMat4::ZERO,
            &["world_from_ndc", "invertible"],
        ),
        f(
            "a flat camera",
            |f| f.world_from_ndc = DMat4::from_scale(DVec3::new(1.0, 0.0, 1.0)),
            &["world_from_ndc", "invertible"],
        ),
        f(
            "a camera whose determinant overflows",
            |f| f.world_from_ndc = DMat4::from_scale(DVec3::splat(1e200)),
            &["world_from_ndc", "invertible"],
        ),
        f(
            "a camera beyond single precision",
            |f| f.world_from_ndc = DMat4::from_scale(DVec3::splat(1e50)),
            &["world_from_ndc", "32-bit"],
        ),
        f("a background of half", |f| f.background = Some(0.5), &["background is 0.5", "0 where"]),
        f("a background of NaN", |f| f.background = Some(f32::NAN), &["background is NaN"]),
        f(
            "no background of an orthographic camera",
            |f| f.background = None,
            &["orthographic", "background", "Some(0.0) where depth is reversed"],
        ),
        f("no window", |f| f.window = Some([[0.5; 2]; 2]), &["window", "least first"]),
        f("a mirrored window", |f| f.window = Some([[1.0, -1.0], [-1.0, 1.0]]), &["least first"]),
        f("a window of NaN", |f| f.window = Some([[f64::NAN; 2], [1.0; 2]]), &["window", "finite"]),
        f("a window without end", |f| f.window = Some([[-1e300; 2], [1e300; 2]]), &["window"]),
        f("no reach", |f| f.reach = Some(0.0), &["reach is 0", "above 0"]),
        f("a reach backwards", |f| f.reach = Some(-1.0), &["reach is -1"]),
        f("a reach of NaN", |f| f.reach = Some(f64::NAN), &["reach is NaN"]),
        f("normals that are not lent", |f| f.normals = None, &["normals must be given"]),
        f(
            "normals that are scaled",
            |f| f.world_from_normal *= 2.0,
            &["world_from_normal must turn", "unit vectors", "world_from_view"],
        ),
        f(
            "normals that are turned by no number",
            |f| f.world_from_normal.x_axis.x = f64::NAN,
            &["world_from_normal must turn"],
        ),
        f("a mask that is not lent", |f| f.mask = None, &["mask must be given"]),
        f(
            "a texture that was not described",
            |f| f.light_texture = Some(texture()),
            &["light texture"],
        ),
        f(
            "maps that were not described",
            |f| f.occluder_maps = Some(maps(f.light.rectangle())),
            &["occluder maps"],
        ),
        f(
            "an image instead of the node's",
            |f| f.visibility = Visibility::Lent(target()),
            &["lent_visibility"],
        ),
        (
            "an outline for rectangles",
            GBuffer,
            "",
            Framed(|f| f.light = Light::with_outline(*f.light.rectangle(), &TRIANGLE).unwrap()),
            &["a polygon", "takes no polygons"],
        ),
        (
            "a sphere",
            GBuffer,
            "technique=many-lights",
            Framed(|f| f.light = Light::sphere(f.light.center(), 0.2).unwrap()),
            &["a sphere", "many-lights takes no spheres"],
        ),
        (
            "a line for an area",
            GBuffer,
            "technique=pcss",
            Framed(|f| f.light = line().into()),
            &["line", "linear-light"],
        ),
        (
            "a window for maps that have one",
            Maps,
            "",
            Framed(|f| f.window = Some([[-1.0; 2], [1.0; 2]])),
            &["window of their own"],
        ),
        ("no maps", Maps, "", Framed(|f| f.occluder_maps = None), &["occluder maps must be lent"]),
        (
            "no map of the back",
            Maps,
            "",
            Framed(|f| f.occluder_maps.as_mut().unwrap().back = None),
            &["occluder_maps.back", "sides=one"],
        ),
        (
            "a camera of maps that is none",
            Maps,
            "",
            Framed(|f| f.occluder_maps.as_mut().unwrap().clip_from_world = DMat4::IDENTITY),
            &["clip_from_world", "perspective from the light's centre"],
        ),
        (
            "a camera of maps of NaN",
            Maps,
            "",
            Framed(|f| f.occluder_maps.as_mut().unwrap().clip_from_world.x_axis.x = f64::NAN),
            &["clip_from_world", "not finite"],
        ),
    ]);
}

/// A polygon in the half-metre light.
const TRIANGLE: [[f64; 2]; 3] = [[0.0, 0.0], [0.2, 0.0], [0.0, 0.2]];

fn line() -> RectangleLight {
    generate::line_light(1.0, 0.0).unwrap()
}

fn buffers(mesh: &mut MeshInstance) -> &mut MeshBuffers {
    match &mut mesh.geometry {
        Geometry::Buffers(buffers) => buffers,
        Geometry::HostDrawn(_) => panic!("the host draws it"),
    }
}

#[test]
fn meshes() {
    use Lends::GBuffer;
    let m = drawn;
    refuses(vec![
        m("bounds of NaN", |m| m.bounds[0][1] = f32::NAN, &["mesh 1", "finite"]),
        m("bounds without end", |m| m.bounds[1][2] = f32::INFINITY, &["mesh 1", "finite"]),
        m("a place of NaN", |m| m.world_from_mesh.w_axis.x = f64::NAN, &["mesh 1", "finite"]),
        m(
            "a transposed transform",
            |m| m.world_from_mesh = m.world_from_mesh.transpose(),
            &["mesh 1", "0, 0, 0, 1", "transposed"],
        ),
        m("a transform of nothing", |m| m.world_from_mesh = DMat4::ZERO, &["mesh 1", "0, 0, 0, 1"]),
        m("no positions", |m| buffers(m).positions = vk::Buffer::null(), &["mesh 1", "null"]),
        m(
            "no indices",
            |m| buffers(m).indices.as_mut().unwrap().0 = vk::Buffer::null(),
            &["mesh 1", "null"],
        ),
        m("35 indices", |m| buffers(m).count = 35, &["mesh 1", "multiple of 3"]),
        m("one vertex", |m| (buffers(m).indices, buffers(m).count) = (None, 1), &["multiple of 3"]),
        m("positions at an odd place", |m| buffers(m).positions_offset = 6, &["mesh 1", "4 bytes"]),
        m(
            "indices at an odd place",
            |m| buffers(m).indices.as_mut().unwrap().1 = 2,
            &["mesh 1", "multiple of their size"],
        ),
        m(
            "indices of no type",
            |m| buffers(m).indices.as_mut().unwrap().2 = vk::IndexType::NONE_KHR,
            &["mesh 1", "16 or 32 bits"],
        ),
        m("an unknown stride", |m| buffers(m).positions_stride = 20, &["stride of 20", "[12]"]),
        (
            "the host's own draws for slices",
            GBuffer,
            "technique=occlusion-textures",
            Drawn(|m| m.geometry = Geometry::HostDrawn(3)),
            &["mesh 1", "occlusion-textures", "give its buffers"],
        ),
        (
            "the host's own draws for a line",
            GBuffer,
            "technique=linear-light",
            Drawn(|m| m.geometry = Geometry::HostDrawn(3)),
            &["mesh 1", "linear-light", "give its buffers"],
        ),
    ]);
}

/// What the host draws itself has no triangles to trace; it may receive, and block where nothing is audited.
#[test]
fn meshes_that_an_audit_cannot_trace() {
    let plan = |audit, role| {
        let mut given = Given::new(Lends::GBuffer, "");
        given.description.audit = audit;
        given.meshes[1].geometry = Geometry::HostDrawn(5);
        given.meshes[1].role = role;
        given.plan(Lends::GBuffer, |_| {})
    };
    let sentence = plan(64, Role::Both).unwrap_err().to_string();
    println!("{sentence}");
    for word in ["mesh 1 is drawn by the host", "audit", "give its buffers"] {
        assert!(sentence.contains(word), "{sentence}");
    }
    plan(64, Role::Receiver).unwrap();
    plan(0, Role::Both).unwrap();
}
