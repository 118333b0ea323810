//! Descriptor sets: one for each kind of pass, frame slot and light, written each time a plan is recorded,
//! at the kind's first pass. Its other passes touch the same resources (`graph::compile` sees to that), and
//! a set must not be written again while commands that use it are recorded.
//!
//! The sets are written even where nothing seems to have changed: a host may destroy a view and get the same handle for
//! its next one.

use super::host::Host;
use super::maker::Maker;
use super::objects::{Object, name};
use super::pipeline::PassObjects;
use crate::Error;
use crate::graph::{Graph, Pass};
use ash::vk;

/// The most bindings that a pass has.
const MAX_BINDINGS: usize = 20;

/// The descriptor sets of all kinds of pass, place by place; a place is a light of a frame slot.
pub(crate) struct Descriptors {
    sets: Vec<vk::DescriptorSet>,
    kinds: usize,
}

impl Descriptors {
    /// Allocates every set that `kinds` of pass need in any of `places`.
    pub fn new(
        maker: &mut Maker,
        graph: &Graph,
        kinds: &[PassObjects],
        places: u32,
    ) -> Result<Self, Error> {
        if let Some(pass) = graph.kinds().find(|p| bound(p).any(|b| b.0 as usize >= MAX_BINDINGS)) {
            return Err(Error::Frame(format!(
                "{}: a binding is beyond the {MAX_BINDINGS} that a pass may have",
                pass.name
            )));
        }
        let types = [
            vk::DescriptorType::SAMPLED_IMAGE,
            vk::DescriptorType::STORAGE_IMAGE,
            vk::DescriptorType::STORAGE_BUFFER,
        ];
        let sizes: Vec<_> = types
            .iter()
            .map(|&ty| {
                let uses = graph.kinds().flat_map(|p| &p.uses);
                let count = uses.filter(|u| u.access.descriptor() == Some(ty)).count() as u32;
                vk::DescriptorPoolSize { ty, descriptor_count: (count * places).max(1) }
            })
            .collect();
        let create = vk::DescriptorPoolCreateInfo::default()
            .max_sets(kinds.len() as u32 * places)
            .pool_sizes(&sizes);
        // SAFETY: the device is valid (Host::borrow).
        let pool = unsafe { maker.host.device.create_descriptor_pool(&create, None) }
            .map_err(Error::vulkan("creating the descriptor pool"))?;
        maker.keep(pool);
        let layouts: Vec<_> =
            (0..places).flat_map(|_| kinds.iter().map(|k| k.layouts.set)).collect();
        let allocate =
            vk::DescriptorSetAllocateInfo::default().descriptor_pool(pool).set_layouts(&layouts);
        // SAFETY: the pool was sized for exactly these sets, and the layouts are alive.
        let sets = unsafe { maker.host.device.allocate_descriptor_sets(&allocate) }
            .map_err(Error::vulkan("allocating the descriptor sets"))?;
        for (place, of_place) in sets.chunks(kinds.len().max(1)).enumerate() {
            for (set, pass) in of_place.iter().zip(graph.kinds()) {
                name(maker.host, *set, &format!("{}.set_{place}", pass.name));
            }
        }
        Ok(Self { sets, kinds: kinds.len() })
    }

    /// The set of a kind of pass at a place; `None` for passes that bind nothing.
    pub fn set(&self, pass: &Pass, kind: usize, place: usize) -> Option<vk::DescriptorSet> {
        bound(pass).next()?;
        self.sets.get(place * self.kinds + kind).copied()
    }

    /// Writes a pass's set with the objects that `look_up` returns.
    pub fn write(
        &self,
        host: &Host,
        pass: &Pass,
        set: vk::DescriptorSet,
        look_up: impl Fn(&crate::graph::Use) -> (Object, vk::ImageLayout),
    ) {
        let mut images = [vk::DescriptorImageInfo::default(); MAX_BINDINGS];
        let mut buffers = [vk::DescriptorBufferInfo::default(); MAX_BINDINGS];
        for u in &pass.uses {
            let Some(binding) = u.binding.map(usize::from) else { continue };
            match look_up(u) {
                (Object::Image { view, .. }, layout) => {
                    images[binding] =
                        vk::DescriptorImageInfo::default().image_view(view).image_layout(layout);
                }
                (Object::Buffer(buffer), _) => {
                    buffers[binding] =
                        vk::DescriptorBufferInfo::default().buffer(buffer).range(vk::WHOLE_SIZE);
                }
                (Object::None, _) => {}
            }
        }
        let mut writes = [vk::WriteDescriptorSet::default(); MAX_BINDINGS];
        let mut count = 0;
        for (binding, kind) in bound(pass) {
            let at = binding as usize;
            let write = vk::WriteDescriptorSet::default()
                .dst_set(set)
                .dst_binding(binding)
                .descriptor_type(kind);
            writes[count] = if kind == vk::DescriptorType::STORAGE_BUFFER {
                write.buffer_info(std::slice::from_ref(&buffers[at]))
            } else {
                write.image_info(std::slice::from_ref(&images[at]))
            };
            count += 1;
        }
        // SAFETY: Host::borrow's promise: the slot's earlier commands are done, and this
        // frame's first use of the set comes later, so no command uses it; views and buffers are alive.
        unsafe { host.device.update_descriptor_sets(&writes[..count], &[]) };
    }
}

/// The binding and the descriptor type of each resource that a pass binds.
fn bound(pass: &Pass) -> impl Iterator<Item = (u32, vk::DescriptorType)> + '_ {
    pass.uses.iter().filter_map(|u| Some((u.binding?.into(), u.access.descriptor()?)))
}
