//! Which modules there are: the whole shaders under `glsl/`, and for some of them the permutations that
//! `glsl/permutations.txt` lists.

use crate::compile::{Compiled, compile_file, glsl_root, shader_names};
use std::collections::BTreeSet;

/// The list's path under `glsl/`.
const LIST: &str = "permutations.txt";

/// One module: the file it is compiled from, and what is defined before the file's text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Module {
    /// Its path under `spirv/` without `.spv`.
    pub name: String,
    /// The file under `glsl/`.
    pub file: String,
    /// Names, with a value where they have one.
    pub defines: Vec<(String, Option<String>)>,
}

impl Module {
    /// The module, and every file that was read for it.
    ///
    /// # Panics
    /// With the file and the compiler's log, if it does not compile.
    pub fn compile(&self) -> Compiled {
        let defines: Vec<_> =
            self.defines.iter().map(|(name, value)| (name.as_str(), value.as_deref())).collect();
        compile_file(&self.file, &defines)
    }

    /// From a line of the list, without comments.
    fn parse(line: &str) -> Result<Self, String> {
        let mut words = line.split_whitespace();
        let (Some(file), Some(suffix)) = (words.next(), words.next()) else {
            return Err("a line is a file, a suffix and what is defined".into());
        };
        let Some((stem, extension)) = file.rsplit_once('.') else {
            return Err(format!("{file} has no extension"));
        };
        let name = match suffix {
            "-" => file.to_owned(),
            _ => format!("{stem}_{suffix}.{extension}"),
        };
        let defines = words.map(|word| match word.split_once('=') {
            Some((name, value)) => (name.to_owned(), Some(value.to_owned())),
            None => (word.to_owned(), None),
        });
        Ok(Self { name, file: file.to_owned(), defines: defines.collect() })
    }
}

/// The modules of these whole shaders, by the text of a list; `text_of` says what a file and all that it
/// includes consist of.
///
/// # Errors
/// Each line that is wrong, with its number: a file that does not exist, a define that nothing there asks for, a
/// module that another line or file makes already.
pub fn modules_by(
    list: &str,
    shaders: &[String],
    text_of: impl Fn(&str) -> String,
) -> Result<Vec<Module>, Vec<String>> {
    let mut modules: Vec<Module> = Vec::new();
    let mut problems = Vec::new();
    let lines = list.lines().enumerate().map(|(i, line)| (i + 1, line.trim()));
    for (number, line) in lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#')) {
        let mut problem = |text: String| problems.push(format!("glsl/{LIST}:{number}: {text}"));
        let module = match Module::parse(line) {
            Ok(module) => module,
            Err(text) => {
                problem(text);
                continue;
            }
        };
        if !shaders.contains(&module.file) {
            problem(format!("there is no shader glsl/{}", module.file));
            continue;
        }
        let text = text_of(&module.file);
        let words: BTreeSet<&str> =
            text.split(|c: char| !c.is_alphanumeric() && c != '_').collect();
        for (name, _) in module.defines.iter().filter(|(name, _)| !words.contains(name.as_str())) {
            problem(format!("{name} is not in glsl/{}, nor in what it includes", module.file));
        }
        let itself = module.name != module.file && shaders.contains(&module.name);
        if itself || modules.iter().any(|other| other.name == module.name) {
            problem(format!("spirv/{}.spv is made by another line or file", module.name));
        }
        modules.push(module);
    }
    if !problems.is_empty() {
        return Err(problems);
    }
    let alone = |file: &&String| !modules.iter().any(|module| module.file == **file);
    let alone = shaders.iter().filter(alone).map(|file| Module {
        name: file.clone(),
        file: file.clone(),
        defines: Vec::new(),
    });
    let mut all: Vec<Module> = alone.collect();
    all.extend(modules);
    all.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(all)
}

/// Every module that `spirv/` must hold, sorted by name.
///
/// # Panics
/// With all that is wrong in the list, or with a file that cannot be read.
pub fn modules() -> Vec<Module> {
    let list = read(LIST);
    let text = |file: &str| closure(file).iter().map(|file| code(&read(file))).collect();
    modules_by(&list, &shader_names(), text).unwrap_or_else(|all| panic!("{}", all.join("\n")))
}

/// A file under `glsl/` and all that it includes, directly or not, whatever is defined.
///
/// # Panics
/// With a file that cannot be read.
pub fn closure(file: &str) -> Vec<String> {
    let mut found = vec![file.to_owned()];
    let mut next = 0;
    while let Some(file) = found.get(next) {
        let text = read(file);
        let includes = text.lines().filter_map(|line| line.strip_prefix("#include \""));
        for name in includes.filter_map(|rest| rest.split('"').next()) {
            if !found.iter().any(|known| known == name) {
                found.push(name.to_owned());
            }
        }
        next += 1;
    }
    found
}

/// A text without its comments.
fn code(text: &str) -> String {
    text.lines().map(|line| line.split("//").next().unwrap_or_default().to_owned() + "\n").collect()
}

/// A file under `glsl/`.
///
/// # Panics
/// With its path, if it cannot be read.
pub fn read(file: &str) -> String {
    std::fs::read_to_string(glsl_root().join(file))
        .unwrap_or_else(|error| panic!("glsl/{file}: {error}"))
}
