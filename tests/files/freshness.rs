//! The committed SPIR-V is what the GLSL compiles to, and a reader finds the way through the GLSL: each file says where
//! it is entered, and no module is made of more than a few files.
//!
//! `ANTUMBRA_WRITE_SPIRV=1 cargo test --workspace --test files freshness` writes it anew.

use antumbra_tests::compile::{
    committed, glsl_names, glsl_root, spirv_root, to_bytes, try_compile,
};
use antumbra_tests::headers;
use antumbra_tests::permutations::{modules, modules_by};
use std::collections::BTreeMap;
use std::path::Path;

type Modules = BTreeMap<String, Vec<u8>>;

/// One line for each module that is missing, left over or different.
fn differences(compiled: &Modules, committed: &Modules) -> Vec<String> {
    let left_over = committed.keys().filter(|name| !compiled.contains_key(*name));
    let left_over = left_over.map(|name| {
        format!("spirv/{name}.spv has no glsl/{name}, and no line in glsl/permutations.txt")
    });
    let others = compiled.iter().filter_map(|(name, bytes)| match committed.get(name) {
        None => Some(format!("spirv/{name}.spv is missing")),
        Some(old) if old != bytes => Some(format!("spirv/{name}.spv is not what the GLSL gives")),
        Some(_) => None,
    });
    left_over.chain(others).collect()
}

fn write(compiled: &Modules, committed: &Modules) {
    for (name, bytes) in compiled.iter().filter(|(name, bytes)| committed.get(*name) != Some(bytes))
    {
        let path = spirv_root().join(format!("{name}.spv"));
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, bytes).unwrap();
        println!("wrote spirv/{name}.spv");
    }
    for name in committed.keys().filter(|name| !compiled.contains_key(*name)) {
        std::fs::remove_file(spirv_root().join(format!("{name}.spv"))).unwrap();
        println!("removed spirv/{name}.spv");
    }
}

#[test]
fn committed_modules_are_what_the_glsl_compiles_to() {
    assert!(glsl_root().join("common/light_space.glsl").exists(), "looked in {:?}", glsl_root());
    let compile = |module: antumbra_tests::permutations::Module| {
        let bytes = to_bytes(&module.compile().words);
        (module.name, bytes)
    };
    let compiled: Modules = modules().into_iter().map(compile).collect();
    if std::env::var("ANTUMBRA_WRITE_SPIRV").is_ok_and(|value| value == "1") {
        write(&compiled, &committed());
    }
    let stale = differences(&compiled, &committed());
    assert!(
        stale.is_empty(),
        "{}\nrun: ANTUMBRA_WRITE_SPIRV=1 cargo test --workspace --test files freshness",
        stale.join("\n")
    );
}

#[test]
fn a_stale_a_missing_and_a_left_over_module_are_each_named() {
    let modules = |pairs: &[(&str, u8)]| -> Modules {
        pairs.iter().map(|(name, byte)| ((*name).to_owned(), vec![*byte])).collect()
    };
    let compiled = modules(&[("a.comp", 1), ("b.comp", 2), ("c.comp", 3)]);
    assert!(differences(&compiled, &compiled).is_empty());
    let found = differences(&compiled, &modules(&[("a.comp", 1), ("b.comp", 9), ("d.comp", 4)]));
    assert_eq!(found.len(), 3, "{found:?}");
    assert!(found[0].contains("d.comp.spv has no glsl/d.comp, and no line in"));
    assert!(found[1].contains("b.comp.spv is not"));
    assert!(found[2].contains("c.comp.spv is missing"));
}

/// What the list of permutations makes of two files, one of which is not in it.
fn listed(list: &str) -> Result<Vec<String>, Vec<String>> {
    let shaders = ["a/one.comp".to_owned(), "a/two.frag".to_owned()];
    let text = |_: &str| "#ifdef COLOR\nvec4(FIRST)\n".to_owned();
    Ok(modules_by(list, &shaders, text)?.into_iter().map(|module| module.name).collect())
}

#[test]
fn a_line_makes_a_module_and_a_file_without_one_is_one() {
    assert_eq!(listed("").unwrap(), ["a/one.comp", "a/two.frag"]);
    let two = "# Comment.\n\na/two.frag - FIRST=0\na/two.frag  lower_color  COLOR FIRST=16\n";
    assert_eq!(listed(two).unwrap(), ["a/one.comp", "a/two.frag", "a/two_lower_color.frag"]);
    // A file with lines is not compiled by itself.
    assert_eq!(listed("a/one.comp rows\n").unwrap(), ["a/one_rows.comp", "a/two.frag"]);
}

#[test]
fn a_line_without_a_file_or_with_an_unknown_define_is_named() {
    let problems = |list: &str| listed(list).unwrap_err().join("\n");
    let found = problems("\na/three.comp - COLOR\n");
    assert_eq!(found, "glsl/permutations.txt:2: there is no shader glsl/a/three.comp");
    let found = problems("a/one.comp - COLOUR FIRST=2\n");
    assert!(found.contains("txt:1: COLOUR is not in glsl/a/one.comp"), "{found}");
    assert!(!found.contains("FIRST"), "{found}");
    let found = problems("a/one.comp any\na/one.comp any COLOR\n");
    assert!(found.contains("txt:2: spirv/a/one_any.comp.spv is made by another"), "{found}");
    assert!(problems("a/one.comp\n").contains("txt:1: a line is"));
}

#[test]
fn the_same_text_gives_the_same_words_without_paths() {
    let source = "#version 450\n#extension GL_GOOGLE_include_directive : require\n\
                  #include \"common/light_space.glsl\"\n\
                  layout(local_size_x = 1) in;\n\
                  layout(set = 0, binding = 0) buffer B { float x; };\n\
                  void main() { x = overlap(x, 1.0); }\n";
    let compile = || try_compile("made-up.comp", source).unwrap();
    let words = compile();
    assert_eq!(words, compile());
    assert_eq!(words[1], 0x0001_0000, "SPIR-V 1.0");
    let text = String::from_utf8_lossy(&to_bytes(&words)).into_owned();
    assert!(!text.contains("light_space.glsl") && !text.contains(".comp"), "a path in the module");
}

/// GLSL files that a module is made of, at most: with two Rust files, of its room, a pass is nine.
const MOST_FILES: usize = 7;

/// Whether a file is a part of what looks opacity textures up, which is the same in all modules.
fn looks_opacities_up(name: &str) -> bool {
    name.starts_with("cut_outs/") || name == "hierarchy/cut.glsl"
}

#[test]
fn no_module_is_made_of_many_files() {
    let mut table: Vec<(usize, String, Vec<String>)> = Vec::new();
    for module in modules() {
        let included = module.compile().included;
        table.push((1 + included.len(), module.name, included));
    }
    table.sort_by(|a, b| b.0.cmp(&a.0).then_with(|| a.1.cmp(&b.1)));
    for (count, name, included) in &table {
        println!("{count}  {name:<60}{}", included.join(" "));
    }
    let own = |included: &[String]| 1 + included.iter().filter(|n| !looks_opacities_up(n)).count();
    let many: Vec<_> = table.iter().filter(|(.., included)| own(included) > MOST_FILES).collect();
    assert!(many.is_empty(), "more than {MOST_FILES} files: {many:?}");
}

/// The harness's shaders are entered from no pass of the node.
fn is_the_nodes(name: &str) -> bool {
    !name.starts_with("headless/")
}

#[test]
fn every_file_says_where_it_is_entered() {
    let names = glsl_names().into_iter().filter(|name| is_the_nodes(name));
    let problems: Vec<String> = names.flat_map(|name| headers::problems(&name)).collect();
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

#[test]
fn a_header_that_is_wrong_is_named() {
    let includes = |from: &str, to: &str| from == "a/one.comp" && to == "a/two.glsl";
    let problems = |file, header| headers::problems_of(file, header, includes).join("\n");
    let entry = "// Entry of the passes a.one, a.two and a.three (src/a.rs); skip two.glsl.";
    assert_eq!(problems("a/one.comp", entry), "");
    assert_eq!(problems("a/two.glsl", "// Entered from one.comp; skip what is below."), "");
    assert_eq!(problems("b/one.comp", "// Entry of the pass b.one (src/b.rs)."), "");
    assert!(problems("a/one.comp", "#version 450").contains("does not begin with `// Entry of"));
    assert!(problems("a/one.comp", "// Entry of the pass a.one.").contains("does not begin"));
    assert!(problems("a/two.glsl", "// Two.").contains("does not begin with `// Entered from`"));
    assert!(problems("a/two.glsl", "// Entered from everywhere.").contains("does not say which"));
    let other = problems("a/two.glsl", "// Entered from one.comp and b/three.comp.");
    assert_eq!(other, "glsl/a/two.glsl says that it is entered from glsl/b/three.comp; it is not");
    let skips = "// Entry of the pass a.one (src/a.rs); skip b/four.glsl.";
    assert!(problems("a/one.comp", skips).contains("skip glsl/b/four.glsl, which it does not"));
}

#[test]
fn a_shader_that_does_not_compile_says_where() {
    let compile = try_compile;
    let log = compile("broken.comp", "#version 450\nvoid main() { nonsense; }\n").unwrap_err();
    assert!(log.contains("broken.comp") && log.contains("nonsense"), "{log}");
    let missing = "#version 450\n#extension GL_GOOGLE_include_directive : require\n\
                   #include \"common/nowhere.glsl\"\nvoid main() {}\n";
    let log = compile("missing.comp", missing).unwrap_err();
    assert!(log.contains("glsl/common/nowhere.glsl"), "{log}");
}

/// The hosts bring their own shaders, compiled beside their sources.
#[test]
fn the_hosts_modules_are_fresh_too() {
    let three = "vertex, fragment and compose";
    for (folder, count, names) in [
        ("examples/embed/shaders", 4, "vertex, fragment, compose and posing"),
        ("examples/embed_vk_graph/src/shaders", 3, three),
    ] {
        let path = glsl_root().join("..").join(folder);
        assert_eq!(check_beside(&path), count, "{folder}: {names}");
    }
}

/// Compiles each shader of a folder and compares it with the module beside it; says how many.
fn check_beside(folder: &Path) -> usize {
    let mut compiled = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if name.ends_with(".spv") {
            continue;
        }
        let source = std::fs::read_to_string(&path).unwrap();
        let bytes = to_bytes(&try_compile(&name, &source).unwrap_or_else(|log| panic!("{log}")));
        let module = folder.join(format!("{name}.spv"));
        if std::env::var("ANTUMBRA_WRITE_SPIRV").is_ok_and(|value| value == "1") {
            std::fs::write(&module, &bytes).unwrap();
        }
        let fresh = std::fs::read(&module).is_ok_and(|old| old == bytes);
        assert!(fresh, "{} is not what the GLSL gives", module.display());
        compiled += 1;
    }
    compiled
}
