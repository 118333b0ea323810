//! Shader modules, which pipelines need only while they are made.

use crate::HeadlessDevice;
use antumbra::Error;
use ash::vk;

/// A module that goes away with its owner.
pub(crate) struct ShaderModule<'d> {
    device: &'d HeadlessDevice,
    module: vk::ShaderModule,
}

impl<'d> ShaderModule<'d> {
    /// Loads SPIR-V; errors call it by `name`.
    ///
    /// # Errors
    /// [`Error::Vulkan`] where the driver refuses.
    pub fn new(device: &'d HeadlessDevice, spirv: &[u32], name: &str) -> Result<Self, Error> {
        let create = vk::ShaderModuleCreateInfo::default().code(spirv);
        // SAFETY: the device lives; the words are the caller's to get right, as for any shader.
        let module = unsafe { device.device().create_shader_module(&create, None) }
            .map_err(Error::vulkan(format!("loading {name}")))?;
        Ok(Self { device, module })
    }

    /// The stage of a pipeline that begins at the module's `main`.
    pub fn stage(&self, stage: vk::ShaderStageFlags) -> vk::PipelineShaderStageCreateInfo<'_> {
        vk::PipelineShaderStageCreateInfo::default().stage(stage).module(self.module).name(c"main")
    }
}

impl Drop for ShaderModule<'_> {
    fn drop(&mut self) {
        // SAFETY: made by this device, destroyed once; no pipeline is being made of it any more.
        unsafe { self.device.device().destroy_shader_module(self.module, None) };
    }
}
