//! What a walk creates: nothing behind its first frames, neither memory nor Vulkan objects.

use super::*;
use std::cell::{Cell, RefCell};

thread_local! {
    /// How many objects this test's device has made.
    static MADE: Cell<usize> = const { Cell::new(0) };
    static REAL: RefCell<Option<ash::Device>> = const { RefCell::new(None) };
}

/// The device's own table, where a call is passed on to; one object more is counted.
fn real() -> ash::Device {
    MADE.set(MADE.get() + 1);
    REAL.with_borrow(Clone::clone).unwrap()
}

/// Replaces calls of a table by ones that count: their names, what they take, and what they return.
macro_rules! count {
    ($table:ident: $($call:ident($($argument:ident: $kind:ty),*);)+) => {
        $({
            unsafe extern "system" fn counted(
                device: vk::Device,
                $($argument: $kind),*
            ) -> vk::Result {
                // SAFETY: passed on as they came.
                unsafe { (real().fp_v1_0().$call)(device, $($argument),*) }
            }
            $table.$call = counted;
        })+
    };
}

/// The device, by which every object that it makes is counted.
fn counting(device: &ash::Device) -> ash::Device {
    use vk::*;
    type None<'a> = *const AllocationCallbacks<'a>;
    let mut table = device.fp_v1_0().clone();
    count! { table:
        create_buffer(a: *const BufferCreateInfo<'_>, b: None<'_>, c: *mut Buffer);
        create_image(a: *const ImageCreateInfo<'_>, b: None<'_>, c: *mut Image);
        create_image_view(a: *const ImageViewCreateInfo<'_>, b: None<'_>, c: *mut ImageView);
        create_framebuffer(a: *const FramebufferCreateInfo<'_>, b: None<'_>, c: *mut Framebuffer);
        create_render_pass(a: *const RenderPassCreateInfo<'_>, b: None<'_>, c: *mut RenderPass);
        create_sampler(a: *const SamplerCreateInfo<'_>, b: None<'_>, c: *mut Sampler);
        create_query_pool(a: *const QueryPoolCreateInfo<'_>, b: None<'_>, c: *mut QueryPool);
        create_command_pool(a: *const CommandPoolCreateInfo<'_>, b: None<'_>, c: *mut CommandPool);
        create_fence(a: *const FenceCreateInfo<'_>, b: None<'_>, c: *mut Fence);
        create_semaphore(a: *const SemaphoreCreateInfo<'_>, b: None<'_>, c: *mut Semaphore);
        create_event(a: *const EventCreateInfo<'_>, b: None<'_>, c: *mut Event);
        create_buffer_view(a: *const BufferViewCreateInfo<'_>, b: None<'_>, c: *mut BufferView);
        create_shader_module(
            a: *const ShaderModuleCreateInfo<'_>, b: None<'_>, c: *mut ShaderModule
        );
        create_descriptor_pool(
            a: *const DescriptorPoolCreateInfo<'_>, b: None<'_>, c: *mut DescriptorPool
        );
        create_descriptor_set_layout(
            a: *const DescriptorSetLayoutCreateInfo<'_>, b: None<'_>, c: *mut DescriptorSetLayout
        );
        create_pipeline_layout(
            a: *const PipelineLayoutCreateInfo<'_>, b: None<'_>, c: *mut PipelineLayout
        );
        create_compute_pipelines(
            a: PipelineCache, b: u32, c: *const ComputePipelineCreateInfo<'_>, d: None<'_>,
            e: *mut Pipeline
        );
        create_graphics_pipelines(
            a: PipelineCache, b: u32, c: *const GraphicsPipelineCreateInfo<'_>, d: None<'_>,
            e: *mut Pipeline
        );
        allocate_command_buffers(a: *const CommandBufferAllocateInfo<'_>, b: *mut CommandBuffer);
        allocate_descriptor_sets(a: *const DescriptorSetAllocateInfo<'_>, b: *mut DescriptorSet);
    }
    REAL.set(Some(device.clone()));
    ash::Device::from_parts_1_3(
        device.handle(),
        table,
        device.fp_v1_1().clone(),
        device.fp_v1_2().clone(),
        device.fp_v1_3().clone(),
    )
}

/// Posing, planning and recording allocate in the first frame, in the second, which finds a hierarchy of triangles, and in
/// the first that finds its maps because the figure has halted: each has passes to leave out that none before it had, and
/// says why. Neither engine nor node makes any object once each frame in flight has been there.
#[test]
fn a_walk_allocates_nothing() {
    for technique in ["soft-shadow-map", "pcss", "traced"] {
        MADE.set(0);
        let mut gpu = opened();
        gpu.device = counting(&gpu.device);
        let mut engine = Engine::on(gpu, World::walk().unwrap(), technique);
        let mut held = Vec::new();
        for frame in 0..FRAMES {
            engine.frame(seconds(frame));
            let bytes = engine.gpu.allocator.generate_report().total_allocated_bytes;
            held.push((MADE.get(), engine.shadows.node.object_count(), bytes));
        }
        engine.rest();
        println!(
            "{technique}: allocations {:?}, objects and bytes {:?}",
            engine.allocations, held[1]
        );
        assert!(held[0].0 > 100 && engine.allocations[0] > 0, "nothing is counted");
        // Each slot has a copy of its own for the pixels, made for its first frame.
        assert!(held[1..].iter().all(|now| *now == held[1]), "{technique}: {held:?}");
        let first_halted = (1..FRAMES).find(|&n| seconds(n) == seconds(n - 1));
        let later = (2..FRAMES).filter(|&frame| Some(frame) != first_halted);
        let taken: u64 = later.map(|frame| engine.allocations[frame]).sum();
        assert_eq!(taken, 0, "{technique}: {:?}", engine.allocations);
        engine.finish();
    }
}
