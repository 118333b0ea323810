//! What came of every pipeline, family by family, from processes that compile them.

use crate::families::Family;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A shader as the compiler left it.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Shader {
    /// The modules of its pipeline, by their paths under `spirv/`.
    pub modules: Vec<String>,
    /// The driver's name of its stage, such as "Compute Shader".
    pub stage: String,
    /// The driver's figures by name.
    pub figures: BTreeMap<String, u64>,
}

impl Shader {
    /// A figure; 0 where the driver does not have it.
    pub fn figure(&self, name: &str) -> u64 {
        self.figures.get(name).copied().unwrap_or(0)
    }

    /// Waves of 64 that a SIMD holds of it at once.
    pub fn waves(&self) -> u64 {
        self.figure(WAVES)
    }

    /// Vector registers that went to memory.
    pub fn spilled(&self) -> u64 {
        self.figure("Spilled VGPRs")
    }

    /// Bytes of code.
    pub fn code(&self) -> u64 {
        self.figure("Code size")
    }

    /// Cycles of one wave by the compiler's model.
    pub fn latency(&self) -> u64 {
        self.figure("Latency")
    }

    /// The module of this stage.
    pub fn module(&self) -> &str {
        let of_stage = match self.stage.as_str() {
            "Fragment Shader" => ".frag",
            "Vertex Shader" => ".vert",
            _ => ".comp",
        };
        let module = self.modules.iter().find(|module| module.ends_with(of_stage));
        module.map_or("", String::as_str)
    }
}

/// RADV's name of the figure.
const WAVES: &str = "Subgroups per SIMD";

/// What came of all pipelines for a family.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Compiled {
    /// The driver and its version.
    pub driver: String,
    /// The shaders, one for each that differs in module or figures.
    pub shaders: Vec<Shader>,
}

/// The option of the program that compiles for the family of its environment and prints a [`Compiled`].
pub const HERE: &str = "--compile-here";

/// Compiles every pipeline for a family in a process of the program `gpu`.
///
/// # Errors
/// A sentence where RADV is not installed, does not know the family, or fails.
pub fn compile_for(program: &Path, family: &Family) -> Result<Compiled, String> {
    let icd = radv().ok_or(
        "RADV, a GPU's compiler, is not installed (Debian: mesa-vulkan-drivers); no shader was compiled with it",
    )?;
    let output = Command::new(program)
        .arg(HERE)
        .env("RADV_FORCE_FAMILY", family.name)
        .env("MESA_SHADER_CACHE_DISABLE", "true")
        .env("VK_DRIVER_FILES", &icd)
        .env("VK_ICD_FILENAMES", &icd)
        .env_remove("VK_ADD_DRIVER_FILES")
        .env_remove("VK_INSTANCE_LAYERS")
        .output()
        .map_err(|e| format!("{}: {e}", program.display()))?;
    let said = String::from_utf8_lossy(&output.stderr);
    let last =
        said.lines().rev().find(|line| !line.trim().is_empty()).unwrap_or("nothing was said");
    if !output.status.success() {
        return Err(format!("RADV compiles nothing for {}: {last}", family.name));
    }
    let mut compiled: Compiled = serde_json::from_slice(&output.stdout)
        .map_err(|e| format!("what was compiled for {} cannot be read: {e}", family.name))?;
    // RADV of Mesa 22.3 counts the waves of RDNA for two SIMDs. The smallest shaders have as many as a SIMD holds.
    let most = compiled.shaders.iter().map(Shader::waves).max().unwrap_or(0);
    for waves in compiled.shaders.iter_mut().filter_map(|s| s.figures.get_mut(WAVES)) {
        *waves = *waves * family.waves / most.max(1);
    }
    Ok(compiled)
}

/// RADV's description for the Vulkan loader; `None` where it is not installed.
fn radv() -> Option<PathBuf> {
    let home = std::env::var("HOME").unwrap_or_default();
    let user = format!("{home}/.local/share");
    [user.as_str(), "/etc", "/usr/local/share", "/usr/share"].iter().find_map(|folder| {
        let files = std::fs::read_dir(Path::new(folder).join("vulkan/icd.d")).ok()?;
        let mut found = files.filter_map(|file| Some(file.ok()?.path()));
        found.find(|path| {
            let name = path.file_name().map(|name| name.to_string_lossy().into_owned());
            name.is_some_and(|name| name.starts_with("radeon_icd") && name.ends_with(".json"))
        })
    })
}
