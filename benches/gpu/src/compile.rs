//! Compiles every pipeline that nodes may have on the device of this process.

use crate::compiled::{Compiled, Shader};
use crate::device::NullDevice;
use antumbra::gpu::{Pipelines, SharedLayouts};
use antumbra_harness::descriptions::every_row;
use ash::vk;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Compiles the pipelines of [`every_row`], with the layouts and formats of nodes.
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
    let mut shaders: BTreeMap<_, Vec<String>> = BTreeMap::new();
    for (words, description) in every_row() {
        let pipelines = Pipelines::new(&host, &description).map_err(|e| format!("{words}: {e}"))?;
        for made in pipelines.each() {
            let told = device.told(made.pipeline).map_err(|e| format!("{}: {e}", made.pass))?;
            for (stage, figures) in told {
                let figures: BTreeMap<String, u64> = figures.into_iter().collect();
                let modules: Vec<String> = made.modules.iter().map(ToString::to_string).collect();
                let passes = shaders.entry((modules, stage, figures)).or_default();
                if !passes.iter().any(|pass| pass == made.pass) {
                    passes.push(made.pass.to_owned());
                }
            }
        }
        pipelines.destroy();
    }
    let shaders = shaders.into_iter().map(|((modules, stage, figures), passes)| Shader {
        passes,
        modules,
        stage,
        figures,
    });
    Ok(Compiled { device: device.name, driver: device.driver, shaders: shaders.collect() })
}
