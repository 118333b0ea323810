//! A bounding volume hierarchy over the blocking triangles, built on the device from the host's own buffers.
//!
//! ```text
//!   which triangles there are ──► keys ──► sort ──► split, order       kept while the list of meshes stays
//!                                                       │
//!   positions, transforms ──────────► triangles ──► boxes ──► nodes    kept while no mesh moves
//! ```
//! Triangles are sorted by their mesh and, within it, by a Morton code of their middle in the mesh's own box. A tree over
//! the sorted leaves splits where keys first differ (Karras 2012), so that each mesh is a subtree of its own: a mesh that
//! moves, or whose vertices move, changes boxes and no subtree. Boxes are made anew from the leaves up whenever anything
//! moved; the tree is right whatever moved, and only slower where triangles have moved far from their neighbours.
//!
//! The hierarchy's space has the world's axes and an origin near the meshes, so that 32-bit floats are precise wherever
//! the scene is; one hierarchy serves all lights. A node is 16 bytes, with a box of 16-bit steps of the root's, and nodes
//! lie in depth-first order: a walk needs no stack, and no path is longer than the 64 bits of two keys.
//!
//! **Limits.** Meshes that the host draws itself are not in it. Keys hold the number of the mesh in their first bits: the
//! more meshes, the coarser the Morton cells of each.

mod sort;

use crate::graph::{Access, Graph, Need, Pass, Push, ResourceId, Until, Use, Work};
use crate::shaders::module;
use ash::vk;
use bytemuck::{Pod, Zeroable};
use smallvec::smallvec;

/// The triangles of a leaf (`hierarchy/texels.glsl`).
pub const LEAF: u32 = 2;
/// The binary logarithm of the images' width (`hierarchy/texels.glsl`).
const TEXELS_BITS: u32 = 12;
/// The texels before the first node (`hierarchy/texels.glsl`).
const HEAD: u32 = 2;
/// Boxes that one of the next level of the pyramid holds, and the most levels (`hierarchy/pyramid.glsl`).
const WIDE: u32 = 8;
const LEVELS: u32 = 9;
/// The bits of a Morton code.
const CODE_BITS: u32 = 30;
/// The Morton cells along a side of a mesh's box.
const CELLS: f64 = 1024.0;

/// Stands beside a triangle's first corner where all of it blocks (`hierarchy/texels.glsl`).
pub const WHOLE: f32 = 1.0;
/// Stands beside a triangle's first corner where a texture says which parts of it block.
pub const CUT_OUT: f32 = 2.0;

/// The push constants of the passes that read a mesh's buffers (`hierarchy/mesh.glsl`).
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct MeshPush {
    /// Mesh space, moved so that the origin is at 0, to the hierarchy's space: a plane for each of x, y and z.
    pub rows: [[f32; 4]; 3],
    /// The least corner of the mesh's box, in mesh space; then [`WHOLE`] or [`CUT_OUT`].
    pub low: [f32; 4],
    /// Morton cells a unit of mesh space.
    pub cells: [f32; 4],
    /// The place of the mesh's first triangle among those of all meshes.
    pub first: u32,
    /// How many triangles it has.
    pub count: u32,
    /// How many places it has: its triangles, and empty ones to fill the last leaf.
    pub padded: u32,
    /// Where its positions begin, in floats.
    pub positions: u32,
    /// Floats from one position to the next.
    pub stride: u32,
    /// Where its indices begin, in indices.
    pub indices: u32,
    /// 16 or 32; 0 without indices.
    pub index_bits: u32,
    /// The bits of a key that are the mesh's.
    pub key: u32,
    /// How many bits of a key are its triangles'.
    pub key_bits: u32,
    /// The mesh's origin.
    pub origin: [f32; 3],
}

impl MeshPush {
    /// The bits of a key that number `meshes` meshes, and those left for their triangles.
    pub fn key_bits(meshes: u32) -> [u32; 2] {
        let of_meshes = u32::BITS - meshes.max(1).saturating_sub(1).leading_zeros();
        [of_meshes, (u32::BITS - of_meshes).min(CODE_BITS)]
    }

    /// Morton cells a unit of a box with these sides; none along a side of no length.
    pub fn cells_of(size: [f64; 3]) -> [f32; 4] {
        let along =
            |s: f64| if s > 0.0 { (CELLS / s).min(f64::from(f32::MAX)) as f32 } else { 0.0 };
        [along(size[0]), along(size[1]), along(size[2]), 0.0]
    }

    /// The number of workgroups for the mesh's triangles.
    pub fn groups(&self) -> [u32; 3] {
        groups(self.padded)
    }
}

/// The push constants of the passes that read meshes that textures cut out (`hierarchy/cut_out_push.glsl`).
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct CutOutPush {
    /// The mesh's cut-out, `CutOutRecord` (`src/frame/cut_outs.rs`).
    pub record: [u32; 12],
    /// The place of the mesh's first triangle among those of all meshes.
    pub first: u32,
    /// How many triangles it has.
    pub count: u32,
    /// Where its indices begin, in indices.
    pub indices: u32,
    /// 16 or 32; 0 without indices.
    pub index_bits: u32,
    /// How many times textures are halved.
    pub halved: u32,
}

impl CutOutPush {
    /// For a mesh whose triangles are pushed so.
    pub(crate) fn of_mesh(record: &impl Pod, mesh: &MeshPush) -> Self {
        let MeshPush { first, count, indices, index_bits, .. } = *mesh;
        let record = words_of(record);
        Self { record, first, count, indices, index_bits, halved: 0 }
    }

    /// For a texture.
    pub(crate) fn of_texture(record: &impl Pod, halved: u32) -> Self {
        let record = words_of(record);
        Self { record, first: 0, count: 0, indices: 0, index_bits: 0, halved }
    }

    /// The number of workgroups for a texture: an invocation for four texels.
    pub(crate) fn groups(&self) -> [u32; 3] {
        let [.., extent] = self.record;
        groups(((extent & 0xffff) * (extent >> 16)).div_ceil(4))
    }
}

/// The words of a record of 48 bytes.
fn words_of(record: &impl Pod) -> [u32; 12] {
    let mut words = [0; 12];
    let bytes = bytemuck::bytes_of(record);
    for (word, bytes) in words.iter_mut().zip(bytes.as_chunks().0) {
        *word = u32::from_ne_bytes(*bytes);
    }
    words
}

/// The push constants of the passes over leaves and nodes (`hierarchy/topology.glsl`).
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct LeavesPush {
    /// The number of leaves.
    pub leaves: u32,
    /// The place of a level of the pyramid of boxes.
    pub start: u32,
    /// The number of boxes in that level.
    pub count: u32,
}

/// The sizes of a hierarchy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sizes {
    /// The most triangles that there is memory for.
    pub capacity: u32,
    /// The triangles of this frame's meshes, those that fill leaves included.
    pub triangles: u32,
    /// The texels of opacity textures that there is memory for; 0 where no mesh is ever cut out.
    pub texels: u32,
    /// The meshes of this frame that textures cut out.
    pub cut_outs: u32,
}

impl Sizes {
    /// The number of leaves.
    pub fn leaves(&self) -> u32 {
        self.triangles / LEAF
    }

    /// The number of nodes.
    pub fn nodes(&self) -> u32 {
        (2 * self.leaves()).saturating_sub(1)
    }

    /// What decides which of the hierarchy's passes a frame needs: how many levels of boxes there are above the leaves, or
    /// that there are no triangles; and whether textures cut some of them out.
    pub(crate) fn decides(&self) -> (Option<u32>, bool) {
        let counts = std::iter::successors(Some(self.leaves()), |count| Some(count.div_ceil(WIDE)));
        let levels = counts.take_while(|count| *count > 1).count() as u32;
        ((self.triangles > 0).then_some(levels), self.cut_outs > 0)
    }
}

/// A hierarchy as passes read it.
#[derive(Clone, Copy, Debug)]
pub struct Hierarchy {
    /// The nodes in depth-first order, behind the root's box: R32G32B32A32_UINT, one texel each.
    pub nodes: ResourceId,
    /// The triangles, leaf by leaf: R32G32B32A32_SFLOAT, three texels each.
    pub triangles: ResourceId,
    /// What textures say of them; `None` where no mesh is ever cut out.
    pub cut_outs: Option<CutOuts>,
}

impl Hierarchy {
    /// The needs of a pass that looks no opacity textures up, and of one that does and takes its place where a frame has
    /// any; both where the frame is none.
    pub(crate) fn needs(&self, graph: &mut Graph, need: &Need) -> [Need; 2] {
        match self.cut_outs.map(|cut_outs| cut_outs.there) {
            Some(Some(true)) if need.is_yes() => {
                let why = "textures cut out meshes that block, and are looked up by another pass";
                [Need::No(graph.because(why)), *need]
            }
            Some(Some(false)) if need.is_yes() => {
                [*need, Need::No(graph.because("no texture cuts out a mesh that blocks"))]
            }
            _ => [*need; 2],
        }
    }
}

/// What textures say of a hierarchy's triangles (`hierarchy/cut.glsl`).
#[derive(Clone, Copy, Debug)]
pub struct CutOuts {
    /// Whether the frame has any; `None` for no frame.
    there: Option<bool>,
    /// The place in its texture and the texture of each triangle that one cuts out: R32G32B32A32_SFLOAT, three texels each.
    pub places: ResourceId,
    /// The opacities of all textures, four to a texel: R32_UINT.
    pub opacities: ResourceId,
}

impl CutOuts {
    /// What a pass binds from a binding on.
    pub(crate) fn bound(&self, first: u8) -> [Use; 2] {
        let of = |nth, id| Use::bound(first + nth, id, Access::SampledCompute);
        [of(0, self.places), of(1, self.opacities)]
    }
}

/// The workgroups of 64 invocations for a number of them, as `common/lists.glsl` numbers them.
pub(crate) fn groups(invocations: u32) -> [u32; 3] {
    const A_ROW: u32 = 16384;
    let groups = invocations.div_ceil(64).max(1);
    [groups.min(A_ROW), groups.div_ceil(A_ROW), 1]
}

/// Adds the passes that make the levels of the pyramid of boxes above the leaves.
fn pyramid(graph: &mut Graph, boxes: ResourceId, sizes: Sizes, need: &Need) {
    let most = sizes.capacity.div_ceil(LEAF);
    let (mut start, mut count) = (0, sizes.leaves());
    let mut in_all = most;
    let enough = Need::No(graph.because("the level below is one box"));
    while in_all > 1 {
        let push = Push::new(&LeavesPush { leaves: sizes.leaves(), start, count });
        graph.push(Pass::compute(
            "hierarchy.pyramid",
            module!("hierarchy/pyramid.comp"),
            groups(count.div_ceil(WIDE)),
            push,
            smallvec![Use::bound(0, boxes, Access::BufferUpdate)],
            if count > 1 || sizes.triangles == 0 { need } else { &enough },
        ));
        start += count;
        count = count.div_ceil(WIDE);
        in_all = in_all.div_ceil(WIDE);
    }
}

/// Declares an image of so many texels, whose content is valid until a mesh moves.
fn image(graph: &mut Graph, name: &'static str, format: vk::Format, texels: u32) -> ResourceId {
    let height = texels.div_ceil(1 << TEXELS_BITS).max(1);
    let id = graph.image(name, format, [1 << TEXELS_BITS, height], crate::graph::Owner::Kept);
    graph.keep_until(id, Until::Moved);
    id
}

/// Adds the passes that copy opacity textures, and write where triangles lie in them.
fn cut_outs(graph: &mut Graph, sizes: Sizes, places: ResourceId, need: &Need) -> CutOuts {
    let none = graph.because("no texture cuts out a mesh that blocks");
    let there = (sizes.triangles > 0).then_some(sizes.cut_outs > 0);
    let need = if there == Some(false) && need.is_yes() { &Need::No(none) } else { need };
    let format = vk::Format::R32_UINT;
    let opacities = image(graph, "hierarchy.opacities", format, sizes.texels.div_ceil(4));
    let format = vk::Format::R32G32B32A32_SFLOAT;
    let texels = 3 * sizes.capacity.next_multiple_of(LEAF);
    let cut = image(graph, "hierarchy.cut_outs", format, texels);
    graph.push(Pass {
        name: "hierarchy.opacities",
        uses: smallvec![Use::bound(0, opacities, Access::ImageWrite)],
        push: Push::NONE,
        work: Work::EachCutOut { shader: module!("hierarchy/opacities.comp"), textures: true },
        need: *need,
    });
    graph.push(Pass {
        name: "hierarchy.cut_outs",
        uses: smallvec![
            Use::bound(0, places, Access::BufferReadCompute),
            Use::bound(1, cut, Access::ImageWrite),
        ],
        push: Push::NONE,
        work: Work::EachCutOut { shader: module!("hierarchy/cut_outs.comp"), textures: false },
        need: *need,
    });
    CutOuts { there, places: cut, opacities }
}

/// Adds the passes that build the hierarchy, and those that fit it to where the meshes are.
pub(crate) fn declare(graph: &mut Graph, sizes: Sizes, need: &Need) -> Hierarchy {
    let Sizes { capacity, .. } = sizes;
    let (room, leaves) = (u64::from(capacity), u64::from(capacity.div_ceil(LEAF)));
    let triangles = image(
        graph,
        "hierarchy.triangles",
        vk::Format::R32G32B32A32_SFLOAT,
        3 * capacity.next_multiple_of(LEAF),
    );
    let texels = HEAD + 2 * capacity.div_ceil(LEAF);
    let nodes = image(graph, "hierarchy.nodes", vk::Format::R32G32B32A32_UINT, texels);
    let kept = |graph: &mut Graph, name, bytes, until| {
        let id = graph.buffer(name, bytes);
        graph.keep_until(id, until);
        id
    };
    let places = kept(graph, "hierarchy.places", 4 * room, Until::Listed);
    let inner = kept(graph, "hierarchy.inner", 16 * leaves, Until::Listed);
    let parents = kept(graph, "hierarchy.parents", 8 * leaves, Until::Listed);
    let order = kept(graph, "hierarchy.order", 8 * leaves, Until::Listed);
    // An eighth more for the levels above the leaves, and one box a level for those that are not full.
    let boxes_bytes = 24 * (leaves + leaves.div_ceil(7) + u64::from(LEVELS));
    let boxes = kept(graph, "hierarchy.boxes", boxes_bytes, Until::Moved);

    let read = |binding, id| Use::bound(binding, id, Access::BufferReadCompute);
    let write = |binding, id| Use::bound(binding, id, Access::BufferWriteCompute);
    let sorted = sort::keys(graph, sizes, need);
    let push = Push::new(&LeavesPush { leaves: sizes.leaves(), start: 0, count: 0 });
    let (of_leaves, of_nodes) = (groups(sizes.leaves()), groups(sizes.nodes()));
    graph.push(Pass::compute(
        "hierarchy.split",
        module!("hierarchy/split.comp"),
        of_leaves,
        push,
        smallvec![read(0, sorted), write(1, places), write(2, inner), write(3, parents)],
        need,
    ));
    graph.push(Pass::compute(
        "hierarchy.order",
        module!("hierarchy/order.comp"),
        of_nodes,
        push,
        smallvec![read(0, inner), read(1, parents), write(2, order)],
        need,
    ));
    graph.push(Pass {
        name: "hierarchy.triangles",
        uses: smallvec![read(0, places), Use::bound(1, triangles, Access::ImageWrite),],
        push: Push::NONE,
        work: Work::EachMesh { shader: module!("hierarchy/triangles.comp") },
        need: *need,
    });
    graph.push(Pass::compute(
        "hierarchy.boxes",
        module!("hierarchy/boxes.comp"),
        of_leaves,
        push,
        smallvec![Use::bound(0, triangles, Access::ImageRead), write(1, boxes)],
        need,
    ));
    pyramid(graph, boxes, sizes, need);
    graph.push(Pass::compute(
        "hierarchy.nodes",
        module!("hierarchy/nodes.comp"),
        of_nodes,
        push,
        smallvec![
            read(0, boxes),
            read(1, inner),
            read(2, order),
            Use::bound(3, nodes, Access::ImageWrite),
        ],
        need,
    ));
    let cut_outs = (sizes.texels > 0).then(|| cut_outs(graph, sizes, places, need));
    Hierarchy { nodes, triangles, cut_outs }
}
