//! GLSL to SPIR-V, and where both are kept.

use glslang::include::{IncludeHandler, IncludeResult, IncludeType};
use glslang::{Compiler, CompilerOptions, ShaderInput, ShaderSource, ShaderStage};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The extensions of files that are whole shaders; other files are only included.
const STAGES: [(&str, ShaderStage); 3] = [
    ("comp", ShaderStage::Compute),
    ("frag", ShaderStage::Fragment),
    ("vert", ShaderStage::Vertex),
];

/// The folder of the GLSL sources; includes are relative to it.
pub fn glsl_root() -> PathBuf {
    repository().join("glsl")
}

/// The folder of the committed modules: `spirv/a/b.comp.spv` comes from `glsl/a/b.comp`, or as
/// [`crate::permutations`] has it.
pub fn spirv_root() -> PathBuf {
    repository().join("spirv")
}

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("tests/ is in the repository").into()
}

/// A module and the files that it was made of.
pub struct Compiled {
    /// SPIR-V 1.0.
    pub words: Vec<u32>,
    /// Every file that was included, in the order in which they were read.
    pub included: Vec<String>,
}

/// What is defined before a text: names, with a value where they have one.
pub type Defines<'a> = [(&'a str, Option<&'a str>)];

/// Compiles source text to SPIR-V 1.0 for Vulkan 1.0.
///
/// The stage comes from `name`'s extension. No debug information, so the words depend on nothing
/// but the text and what it includes. `#include "common/x.glsl"` is relative to [`glsl_root`].
///
/// # Errors
/// The compiler's log, with `name`.
pub fn try_compile(name: &str, source: &str) -> Result<Vec<u32>, String> {
    Ok(try_compile_with(name, source, &[])?.words)
}

/// As [`try_compile`], with names defined as `#define` does.
///
/// # Errors
/// The compiler's log, with `name`.
pub fn try_compile_with(name: &str, source: &str, defines: &Defines) -> Result<Compiled, String> {
    let extension = name.rsplit('.').next().unwrap_or_default();
    let stage =
        STAGES.iter().find(|(known, _)| *known == extension).map(|(_, stage)| *stage).ok_or_else(
            || format!("{name}: not a shader (its name ends in .comp, .frag or .vert)"),
        )?;
    let compiler = Compiler::acquire().ok_or("glslang does not start")?;
    let source = ShaderSource::from(source);
    let mut includes = Includes { problem: None, files: Vec::new() };
    let compiled = ShaderInput::new(
        &source,
        stage,
        &CompilerOptions::default(), // GLSL, Vulkan 1.0, SPIR-V 1.0
        Some(defines),
        Some(&mut includes),
    )
    .and_then(|input| compiler.create_shader(input))
    .and_then(|shader| shader.compile());
    match compiled {
        Ok(words) => Ok(Compiled { words, included: includes.files }),
        Err(error) => {
            let include = includes.problem.map(|p| format!("\n{p}")).unwrap_or_default();
            Err(format!("{name}: {error}{include}"))
        }
    }
}

/// Compiles one file under [`glsl_root`], named relative to it.
///
/// # Panics
/// With the file and the compiler's log, if it does not compile.
pub fn compile_file(name: &str, defines: &Defines) -> Compiled {
    let path = glsl_root().join(name);
    let source =
        std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("glsl/{name}: {error}"));
    try_compile_with(name, &source, defines).unwrap_or_else(|log| panic!("glsl/{log}"))
}

/// The names of all whole shaders, relative to [`glsl_root`] with forward slashes, sorted.
pub fn shader_names() -> Vec<String> {
    files(&glsl_root()).into_iter().filter(|name| is_shader(name)).collect()
}

/// The names of all GLSL files, whole shaders and others, in the same way.
pub fn glsl_names() -> Vec<String> {
    let all = files(&glsl_root()).into_iter();
    all.filter(|name| is_shader(name) || name.ends_with(".glsl")).collect()
}

/// Whether a file is a whole shader, by its extension.
pub fn is_shader(name: &str) -> bool {
    STAGES.iter().any(|(extension, _)| name.ends_with(&format!(".{extension}")))
}

/// Every committed module by its shader's name.
///
/// # Panics
/// If a file cannot be read.
pub fn committed() -> BTreeMap<String, Vec<u8>> {
    let root = spirv_root();
    files(&root)
        .into_iter()
        .filter_map(|file| Some((file.strip_suffix(".spv")?.to_owned(), root.join(&file))))
        .map(|(name, path)| {
            let bytes = std::fs::read(path);
            let bytes = bytes.unwrap_or_else(|error| panic!("spirv/{name}.spv: {error}"));
            (name, bytes)
        })
        .collect()
}

/// SPIR-V words as the bytes of a `.spv` file, little-endian.
pub fn to_bytes(words: &[u32]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_le_bytes()).collect()
}

/// All files under `root`, relative to it with forward slashes, sorted.
fn files(root: &Path) -> Vec<String> {
    fn walk(folder: &Path, prefix: &str, found: &mut Vec<String>) {
        let Ok(entries) = std::fs::read_dir(folder) else { return };
        for entry in entries {
            let entry = entry.unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
            let name = format!("{prefix}{}", entry.file_name().to_string_lossy());
            if entry.path().is_dir() {
                walk(&entry.path(), &format!("{name}/"), found);
            } else {
                found.push(name);
            }
        }
    }
    let mut found = Vec::new();
    walk(root, "", &mut found);
    found.sort();
    found
}

/// Reads includes, and remembers which, and the first that could not be read: glslang's own message
/// for it does not say why.
struct Includes {
    problem: Option<String>,
    files: Vec<String>,
}

impl IncludeHandler for Includes {
    fn include(
        &mut self,
        _kind: IncludeType,
        name: &str,
        includer: &str,
        _depth: usize,
    ) -> Option<IncludeResult> {
        match std::fs::read_to_string(glsl_root().join(name)) {
            Ok(data) => {
                if !self.files.iter().any(|file| file == name) {
                    self.files.push(name.into());
                }
                Some(IncludeResult { name: name.into(), data })
            }
            Err(error) => {
                let by = if includer.is_empty() { "the shader" } else { includer };
                let problem = format!("glsl/{name}, included by {by}: {error}");
                self.problem.get_or_insert(problem);
                None
            }
        }
    }
}
