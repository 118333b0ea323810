//! Descriptor sets of the host's meshes: of those whose triangles shaders read, the positions at binding 0 and the indices
//! at binding 1; of those that textures cut out, the coordinates, the texture and the indices. They are written each time a
//! plan that reads meshes is recorded, before its first pass.

use super::host::Host;
use super::maker::Maker;
use super::pipeline::PassObjects;
use crate::Error;
use crate::frame::{CutOutList, Description, TriangleList};
use crate::graph::{Graph, Work};
use ash::vk;

/// The sets of all places, as many at each as a frame may have meshes; a place is a light of a frame slot.
#[derive(Default)]
pub(crate) struct MeshSets {
    sets: Vec<vk::DescriptorSet>,
    a_place: usize,
}

impl MeshSets {
    /// Allocates the sets where a pass of the graph reads meshes.
    pub fn new(
        maker: &mut Maker,
        graph: &Graph,
        kinds: &[PassObjects],
        description: &Description,
        places: u32,
    ) -> Result<Self, Error> {
        let reads = graph.kinds().position(|p| matches!(p.work, Work::EachMesh { .. }));
        let Some(layout) = reads.and_then(|kind| Some(kinds.get(kind)?.layouts.mesh)) else {
            return Ok(Self::default());
        };
        let a_place = description.capacity.meshes;
        let count = a_place * places;
        let sizes = [vk::DescriptorPoolSize {
            ty: vk::DescriptorType::STORAGE_BUFFER,
            descriptor_count: 2 * count,
        }];
        let sets = allocate(maker, layout, count, &sizes, "the meshes")?;
        Ok(Self { sets, a_place: a_place as usize })
    }

    /// How many sets there are.
    pub fn count(&self) -> usize {
        self.sets.len()
    }

    /// Writes the sets of a place with the meshes of a frame: one for each run of meshes that share their buffers.
    pub fn write(&self, host: &Host, list: &TriangleList, place: usize) {
        let mut last = None;
        let mut sets = self.sets.iter().skip(place * self.a_place).take(self.a_place);
        for mesh in &list.meshes {
            let pair = (mesh.positions, mesh.indices);
            if last.replace(pair) == Some(pair) {
                continue;
            }
            let Some(&set) = sets.next() else { return };
            let whole =
                |buffer| vk::DescriptorBufferInfo { buffer, offset: 0, range: vk::WHOLE_SIZE };
            let buffers = [whole(pair.0), whole(pair.1)];
            let write = vk::WriteDescriptorSet::default()
                .dst_set(set)
                .descriptor_type(vk::DescriptorType::STORAGE_BUFFER)
                .buffer_info(&buffers);
            // SAFETY: Host::borrow's promise: the slot's earlier commands are done, so no command uses the
            // set; the host's buffers are alive and have STORAGE_BUFFER usage.
            unsafe { host.device.update_descriptor_sets(&[write], &[]) };
        }
    }

    /// The set of each mesh of a frame, in the list's order.
    pub fn of<'a>(
        &'a self,
        list: &'a TriangleList,
        place: usize,
    ) -> impl Iterator<Item = vk::DescriptorSet> + 'a {
        let mut at = place * self.a_place;
        let mut last = None;
        list.meshes.iter().map_while(move |mesh| {
            let pair = (mesh.positions, mesh.indices);
            if last.replace(pair).is_some_and(|last| last != pair) {
                at += 1;
            }
            self.sets.get(at).copied()
        })
    }
}

/// The sets of the meshes that textures cut out, as many at each place as a frame may have.
#[derive(Default)]
pub(crate) struct CutOutSets {
    sets: Vec<vk::DescriptorSet>,
    a_place: usize,
}

impl CutOutSets {
    /// Allocates the sets where a pass of the graph needs them.
    pub fn new(
        maker: &mut Maker,
        graph: &Graph,
        kinds: &[PassObjects],
        description: &Description,
        places: u32,
    ) -> Result<Self, Error> {
        let a_place = description.cut_outs.meshes;
        let mut passes = graph.kinds();
        let needs = passes
            .position(|p| p.draws_cut_outs() || matches!(p.work, Work::EachCutOut { .. }))
            .filter(|_| a_place > 0);
        let Some(layout) = needs.and_then(|kind| Some(kinds.get(kind)?.layouts.mesh)) else {
            return Ok(Self::default());
        };
        let count = a_place * places;
        let size = |ty, descriptor_count| vk::DescriptorPoolSize { ty, descriptor_count };
        let sizes = [
            size(vk::DescriptorType::STORAGE_BUFFER, 2 * count),
            size(vk::DescriptorType::SAMPLED_IMAGE, count),
        ];
        let sets = allocate(maker, layout, count, &sizes, "cut-out meshes")?;
        Ok(Self { sets, a_place: a_place as usize })
    }

    /// How many sets there are.
    pub fn count(&self) -> usize {
        self.sets.len()
    }

    /// Writes the sets of a place with the meshes of a frame.
    pub fn write(&self, host: &Host, list: &CutOutList, place: usize) {
        for (number, of) in list.sets.iter().enumerate() {
            let Some(set) = self.of(number as u32, place) else { return };
            let whole =
                |buffer| vk::DescriptorBufferInfo { buffer, offset: 0, range: vk::WHOLE_SIZE };
            let buffers = [whole(of.coordinates), whole(of.indices)];
            let image = [vk::DescriptorImageInfo {
                image_view: of.view,
                image_layout: of.layout,
                ..Default::default()
            }];
            let write =
                |binding| vk::WriteDescriptorSet::default().dst_set(set).dst_binding(binding);
            let buffer = |binding, nth: usize| {
                write(binding)
                    .descriptor_type(vk::DescriptorType::STORAGE_BUFFER)
                    .buffer_info(&buffers[nth..=nth])
            };
            let sampled = write(1).descriptor_type(vk::DescriptorType::SAMPLED_IMAGE);
            let writes = [buffer(0, 0), sampled.image_info(&image), buffer(2, 1)];
            // SAFETY: Host::borrow's promise: the slot's earlier commands are done, so no command uses the set; the
            // host's buffers and view are alive, with the usage that OpacityTexture says.
            unsafe { host.device.update_descriptor_sets(&writes, &[]) };
        }
    }

    /// The set of a mesh by its number among those that are cut out.
    pub fn of(&self, number: u32, place: usize) -> Option<vk::DescriptorSet> {
        let at = number as usize;
        (at < self.a_place).then(|| self.sets.get(place * self.a_place + at).copied()).flatten()
    }
}

/// Allocates a number of sets of one layout from a pool of their own, which has these descriptors.
fn allocate(
    maker: &mut Maker,
    layout: vk::DescriptorSetLayout,
    count: u32,
    sizes: &[vk::DescriptorPoolSize],
    whose: &str,
) -> Result<Vec<vk::DescriptorSet>, Error> {
    let create = vk::DescriptorPoolCreateInfo::default().max_sets(count).pool_sizes(sizes);
    // SAFETY: the device is valid (Host::borrow).
    let pool = unsafe { maker.host.device.create_descriptor_pool(&create, None) }
        .map_err(Error::vulkan(format!("creating the descriptor pool of {whose}")))?;
    maker.keep(pool);
    let layouts = vec![layout; count as usize];
    let allocate =
        vk::DescriptorSetAllocateInfo::default().descriptor_pool(pool).set_layouts(&layouts);
    // SAFETY: the pool was sized for exactly these sets, and the layout is alive.
    unsafe { maker.host.device.allocate_descriptor_sets(&allocate) }
        .map_err(Error::vulkan(format!("allocating the descriptor sets of {whose}")))
}
