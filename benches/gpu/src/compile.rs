//! Compiles every pipeline that nodes may have on the device of this process.

use crate::compiled::{Compiled, Shader};
use crate::device::NullDevice;
use antumbra::gpu::{Pipelines, SharedLayouts};
use antumbra_harness::descriptions::with_every_pass;
use ash::vk;
use std::collections::BTreeSet;
use std::sync::Arc;

/// Compiles the pipelines of [`with_every_pass`], with the layouts and formats of nodes.
///
/// # Errors
/// A sentence where the device cannot be opened or a pipeline cannot be made.
pub fn everything() -> Result<Compiled, String> {
    let device = NullDevice::open()?;
    let cache = vk::PipelineCacheCreateInfo::default();
    // SAFETY: the device is alive, and the cache is used as long as the process runs.
    let cache = unsafe { device.raw.create_pipeline_cache(&cache, None) }
        .map_err(|e| format!("creating the pipeline cache: {e}"))?;
    let layouts = Arc::<SharedLayouts>::default();
    let host = device.host.clone().with_pipeline_cache(cache).with_layouts(layouts);
    let mut shaders = BTreeSet::new();
    for (words, description) in with_every_pass() {
        let pipelines = Pipelines::new(&host, &description).map_err(|e| format!("{words}: {e}"))?;
        for made in pipelines.each() {
            let told = device.told(made.pipeline).map_err(|e| format!("{}: {e}", made.pass))?;
            for (stage, figures) in told {
                let modules = made.modules.iter().map(ToString::to_string).collect();
                shaders.insert(Shader { modules, stage, figures: figures.into_iter().collect() });
            }
        }
        pipelines.destroy();
    }
    Ok(Compiled { driver: device.driver, shaders: shaders.into_iter().collect() })
}
