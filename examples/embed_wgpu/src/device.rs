//! The program's device, as wgpu creates it without any feature and with default limits.

use crate::Outcome;
use crate::raw::{self, RawImage};
use std::future::Future;
use std::pin::pin;
use std::sync::{Arc, Mutex, PoisonError};
use std::task::{Context, Poll, Waker};
use wgpu::util::{DeviceExt, TextureDataOrder};
use wgpu::{Backends, DeviceType, SubmissionIndex, TextureFormat, TextureUsages};

/// The wgpu handles that the rest of the program uses.
#[derive(Clone)]
pub struct Gpu {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    pub name: String,
    /// The first error that no call returned.
    problem: Arc<Mutex<Option<String>>>,
}

impl Gpu {
    /// Opens the Vulkan device whose name holds `$ANTUMBRA_DRIVER`, or the fastest kind there is.
    pub fn new() -> Outcome<Self> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            backends: Backends::VULKAN,
            // The same in every build; validation comes from outside, by VK_INSTANCE_LAYERS.
            flags: wgpu::InstanceFlags::empty(),
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        });
        let wanted = std::env::var("ANTUMBRA_DRIVER").unwrap_or_default().to_lowercase();
        let adapters = finish(instance.enumerate_adapters(Backends::VULKAN));
        let names: Vec<_> = adapters.iter().map(|a| a.get_info().name).collect();
        let adapter = adapters
            .into_iter()
            .filter(|a| a.get_info().name.to_lowercase().contains(&wanted))
            .min_by_key(|a| match a.get_info().device_type {
                DeviceType::DiscreteGpu => 0,
                DeviceType::IntegratedGpu => 1,
                DeviceType::VirtualGpu => 2,
                _ => 3,
            })
            .ok_or_else(|| format!("no device's name holds \"{wanted}\"; there are {names:?}"))?;
        let (device, queue) = finish(adapter.request_device(&wgpu::DeviceDescriptor::default()))?;

        let problem = Arc::new(Mutex::new(None));
        let first = Arc::clone(&problem);
        device.on_uncaptured_error(Arc::new(move |e: wgpu::Error| {
            let sentence = e.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
            first.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(sentence);
        }));
        Ok(Self { device, queue, name: adapter.get_info().name, problem })
    }

    /// An error where wgpu has found one since the start.
    pub fn check(&self) -> Outcome<()> {
        let problem = self.problem.lock().unwrap_or_else(PoisonError::into_inner);
        problem.as_ref().map_or(Ok(()), |sentence| Err(sentence.clone().into()))
    }

    /// Waits until a submission is done, and with it every one before.
    pub fn wait(&self, submission: SubmissionIndex) -> Outcome<()> {
        let until = wgpu::PollType::Wait { submission_index: Some(submission), timeout: None };
        self.device.poll(until)?;
        Ok(())
    }

    /// An encoder.
    pub fn encoder(&self, name: &str) -> wgpu::CommandEncoder {
        let create = wgpu::CommandEncoderDescriptor { label: Some(name) };
        self.device.create_command_encoder(&create)
    }

    /// A 2D texture of one level, and its only view.
    pub fn target(
        &self,
        name: &str,
        format: TextureFormat,
        extent: [u32; 2],
        usage: TextureUsages,
    ) -> Outcome<Target> {
        let texture = self.device.create_texture(&describe(name, format, extent, usage));
        Target::of(self, texture)
    }

    /// A texture of zeros that wgpu knows it has written.
    ///
    /// wgpu clears a texture that was never written before a shader's first use of it. What others
    /// write behind its back does not count: it would clear the node's first result away.
    pub fn zeroed_target(
        &self,
        name: &str,
        format: TextureFormat,
        extent: [u32; 2],
        usage: TextureUsages,
    ) -> Outcome<Target> {
        let texel = format.block_copy_size(None).ok_or("this format cannot be copied to")?;
        let zeros = vec![0; extent.iter().map(|&e| e as usize).product::<usize>() * texel as usize];
        let create = describe(name, format, extent, usage);
        let order = TextureDataOrder::LayerMajor;
        let texture = self.device.create_texture_with_data(&self.queue, &create, order, &zeros);
        Target::of(self, texture)
    }
}

fn describe(
    name: &str,
    format: TextureFormat,
    [width, height]: [u32; 2],
    usage: TextureUsages,
) -> wgpu::TextureDescriptor<'_> {
    wgpu::TextureDescriptor {
        label: Some(name),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    }
}

/// A 2D texture of one level, and its only view.
pub struct Target {
    pub texture: wgpu::Texture,
    pub view: wgpu::TextureView,
    /// Both, as Vulkan knows them.
    pub raw: RawImage,
}

impl Target {
    fn of(gpu: &Gpu, texture: wgpu::Texture) -> Outcome<Self> {
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        gpu.check()?;
        let raw = raw::image(&texture, &view)?;
        Ok(Self { texture, view, raw })
    }

    /// Width and height.
    pub fn extent(&self) -> [u32; 2] {
        [self.texture.width(), self.texture.height()]
    }
}

/// Waits for everything that was submitted when it is dropped, so that an error on the way does not
/// take memory away from frames that still run.
pub struct WaitAtEnd<'a>(pub &'a Gpu);

impl Drop for WaitAtEnd<'_> {
    fn drop(&mut self) {
        // A device that is lost runs nothing any more either.
        let _ = self.0.device.poll(wgpu::PollType::wait_indefinitely());
    }
}

/// Runs a future of wgpu's to its end. Outside of browsers they are ready at once.
fn finish<F: Future>(future: F) -> F::Output {
    let mut future = pin!(future);
    loop {
        match future.as_mut().poll(&mut Context::from_waker(Waker::noop())) {
            Poll::Ready(output) => return output,
            Poll::Pending => std::thread::yield_now(),
        }
    }
}
