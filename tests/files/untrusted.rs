//! glTF files from strangers: hundreds of thousands of broken ones, the same in each run, and those that
//! are made to take the loader's memory, its stack or its time. docs/untrusted_input.md has what is
//! promised of them.

mod hostile;
mod images;
mod json;
mod parts;
mod seed;
mod streams;

use allocation_counter::measure;
use antumbra::scene::{Scene, from_gltf, from_gltf_bytes};
use antumbra_harness::whole;
use antumbra_tests::example::{folder, root};
use antumbra_tests::skip;
use json::{Json, break_text};
use parts::Parts;
use seed::{Random, Seed};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The most bytes of memory that loading takes for each byte of a file and its buffers, and beside
/// that; `from_gltf` states both, and `hostile` measures them.
const BYTES_PER_BYTE: u64 = 256;
const BYTES_BESIDE: u64 = 1 << 20;

/// Opens a file that is as long as this with its buffers, within its share of the memory; says what of
/// it was taken at once.
fn within_memory<T>(bytes: usize, open: impl FnOnce() -> T) -> (T, u64) {
    within(BYTES_PER_BYTE * bytes as u64 + BYTES_BESIDE, bytes, open)
}

/// Opens a file of so many bytes within so much memory.
fn within<T>(allowed: u64, bytes: usize, open: impl FnOnce() -> T) -> (T, u64) {
    let mut opened = None;
    let most = measure(|| opened = Some(open())).bytes_max;
    assert!(most <= allowed, "{most} bytes of memory for {bytes} bytes of file");
    (opened.unwrap(), most)
}

/// How many files are broken with the same random sequence, one after the other.
const CHUNK: usize = 500;

/// What came of broken files.
#[derive(Default)]
struct Outcome {
    files: usize,
    loaded: usize,
    /// Without numbers and what they quote, to count kinds.
    sentences: BTreeSet<String>,
}

impl Outcome {
    fn add(&mut self, opened: Result<(), String>) {
        self.files += 1;
        match opened {
            Ok(()) => self.loaded += 1,
            Err(sentence) => {
                let unquoted: String = sentence.split('"').step_by(2).collect();
                self.sentences.insert(unquoted.replace(|c: char| c.is_ascii_digit(), ""));
            }
        }
    }
}

/// Writes a file out when what is done with it panics.
struct Kept<'a>(&'a [u8], String);

impl Drop for Kept<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            let path = std::env::temp_dir().join(&self.1);
            match std::fs::write(&path, self.0) {
                Ok(()) => eprintln!("the file is {}", path.display()),
                Err(problem) => eprintln!("the file cannot be kept: {problem}"),
            }
        }
    }
}

/// Opens files broken from a seed, on all cores. Both outcomes must be common, or the changes test
/// nothing.
fn break_it(seed: &Seed, files: usize, kinds: usize) {
    whole::open(&seed.whole()).unwrap();
    let next = AtomicUsize::new(0);
    let all = Mutex::new(Outcome::default());
    let work = || {
        let mut own = Outcome::default();
        loop {
            let chunk = next.fetch_add(1, Ordering::Relaxed);
            if chunk * CHUNK >= files {
                break;
            }
            let mut random = Random::new(chunk as u64);
            for i in 0..CHUNK.min(files - chunk * CHUNK) {
                let file = seed.broken(&mut random);
                let _kept = Kept(&file, format!("broken-{chunk}-{i}-{}", seed.name));
                let allowed = BYTES_PER_BYTE * file.len() as u64 + BYTES_BESIDE;
                let open = || whole::open(&file).map(drop);
                own.add(within(allowed + images::room(&file), file.len(), open).0);
            }
        }
        let mut all = all.lock().unwrap();
        all.files += own.files;
        all.loaded += own.loaded;
        all.sentences.extend(own.sentences);
    };
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(work);
        }
    });
    let Outcome { files: opened, loaded, sentences } = all.into_inner().unwrap();
    println!("{}: {loaded} of {opened} load, {} kinds of sentences", seed.name, sentences.len());
    assert_eq!(opened, files);
    assert!(loaded > files / 20 && loaded < files / 2, "{loaded} of {files} files load");
    assert!(sentences.len() >= kinds, "only these problems were met: {sentences:#?}");
}

fn seeds(folder: &str) -> Vec<Seed> {
    let mut paths: Vec<PathBuf> = std::fs::read_dir(root().join(folder))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    paths.sort();
    paths.iter().filter_map(|path| Seed::read(path)).collect()
}

#[test]
fn small_files_broken_in_two_hundred_thousand_ways() {
    let seeds = seeds("fuzz/seeds");
    assert_eq!(seeds.len(), 5);
    for seed in &seeds {
        // A stream has fewer sentences of its own, and an image none that refuses the file.
        let is_stream = ["draco", "meshopt", "textures"].iter().any(|of| seed.name.contains(of));
        let (files, kinds) = if is_stream { (50_000, 100) } else { (100_000, 200) };
        break_it(seed, files, kinds);
    }
}

#[test]
fn the_projects_models_broken_in_five_thousand_ways() {
    let seeds = seeds("scenes");
    assert_eq!(seeds.len(), 5);
    for seed in &seeds {
        break_it(seed, 1_000, 100);
    }
}

#[test]
#[should_panic(expected = "a normal of length")]
fn a_scene_that_is_not_whole_is_noticed() {
    let mut scene = whole::open(&seeds("fuzz/seeds")[0].whole()).unwrap();
    scene.meshes[0].normals[0] = [0.0; 3];
    whole::check(&scene);
}

#[test]
#[should_panic(expected = "bytes of memory for")]
fn memory_beyond_the_bound_is_noticed() {
    within_memory(10, || vec![0_u8; BYTES_BESIDE as usize + 2561]);
}

/// What is in the memory at once is at most `BYTES_PER_BYTE` for a byte of the file, whatever it is.
#[test]
fn memory_is_a_multiple_of_the_files_length() {
    for (what, change) in hostile::FILES {
        let mut parts = Parts::default();
        change(&mut parts);
        let file = parts.file();
        let _kept = Kept(&file, "hostile".into());
        let (opened, most) = within_memory(file.len(), || {
            let scene = from_gltf_bytes(&file, Path::new("file"));
            scene.map(|scene| scene.triangles()).map_err(|error| error.to_string())
        });
        let times = most as f64 / file.len() as f64;
        println!("{what}: {} bytes, {times:.0} times that, {opened:?}", file.len());
        // All but one are good files, so that all of each is read.
        assert_eq!(opened.is_err(), what == hostile::REFUSED, "{what}: {opened:?}");
    }
}

/// What a thread may have: musl's own default.
const LITTLE_STACK: usize = 128 << 10;

#[test]
fn deep_files_need_no_deep_stack() {
    const DEEP: usize = 100_000;
    let deep = |open: &str, close: &str| format!("{}0{}", open.repeat(DEEP), close.repeat(DEEP));
    let mut files = Vec::new();
    for (open, close) in [("[", "]"), (r#"{"children":"#, "}"), ("[", ""), (r#"{"a":"#, "")] {
        let unread = format!(r#","textures":{}"#, deep(open, close));
        let extras = format!(r#"{{"mesh":0,"extras":{}}}"#, deep(open, close));
        let nodes = deep(open, close);
        files.push(Parts { other: unread.clone(), ..Parts::default() });
        files.push(Parts { nodes: extras, ..Parts::default() });
        files.push(Parts { nodes, ..Parts::default() });
        // Where a material cuts, textures are read, and what is wrong with them is a note.
        let cut = format!(r#"{unread},"materials":[{{"alphaMode":"BLEND"}}]"#);
        let meshes = parts::mesh(r#"{"attributes":{"POSITION":0},"indices":1,"material":0}"#);
        files.push(Parts { other: cut, meshes, ..Parts::default() });
    }
    // Each node the only child of the one before: this one loads.
    let links: String = (1..DEEP).map(|i| format!(r#"{{"children":[{i}]}},"#)).collect();
    files.push(Parts { nodes: format!(r#"{links}{{"mesh":0}}"#), ..Parts::default() });
    let open_all = move || {
        let opened: Vec<_> = files.iter().map(|parts| whole::open(&parts.file())).collect();
        let loaded: Vec<bool> = opened.iter().map(Result::is_ok).collect();
        // Of what is not read it is enough that it is closed; the rest is too deep, and the last no depth.
        let unread = [true, false, false, true];
        let never = [false; 4];
        assert_eq!(loaded, [&unread[..], &unread, &never, &never, &[true]].concat());
    };
    let thread = std::thread::Builder::new().stack_size(LITTLE_STACK).spawn(open_all).unwrap();
    thread.join().unwrap();
}

/// The bound is for strangers: models that somebody made take less than twice their length.
#[test]
fn models_take_little_more_than_they_are_long() {
    for seed in seeds("scenes") {
        let file = seed.whole();
        let (scene, most) = within_memory(file.len(), || whole::open(&file));
        println!("{}: {:.1} times", seed.name, most as f64 / file.len() as f64);
        assert!(scene.is_ok() && most < 2 * file.len() as u64, "{most} for {}", file.len());
    }
}

/// A file that names another over and over, however it writes the name, reads it once.
#[test]
fn memory_is_a_multiple_of_the_buffers_length_too() {
    const BUFFERS: usize = 1000;
    let folder = folder("buffers");
    let mut parts = Parts::default();
    parts.bin.resize(parts::LONG, 0);
    let length = parts.bin.len();
    std::fs::write(folder.join("0.bin"), &parts.bin).unwrap();
    // A primitive for each buffer, which looks at its first three positions.
    let primitive = |i| format!(r#"{{"attributes":{{"POSITION":{i}}}}}"#);
    let view = |i| format!(r#"{{"buffer":{i},"byteLength":36}}"#);
    let buffer = |i| format!(r#"{{"byteLength":{length},"uri":"{}0.bin"}}"#, "./".repeat(i % 50));
    let text = format!(
        r#"{{"asset":{{"version":"2.0"}},"nodes":[{{"mesh":0}}],"meshes":[{}],"accessors":[{}],
        "bufferViews":[{}],"buffers":[{}]}}"#,
        parts::mesh(&parts::listed(BUFFERS, primitive)),
        parts::listed(BUFFERS, |i| format!("{{{}}}", parts::vectors(i, 3))),
        parts::listed(BUFFERS, view),
        parts::listed(BUFFERS, buffer),
    );
    let path = folder.join("scene.gltf");
    std::fs::write(&path, &text).unwrap();
    let (scene, most) = within_memory(text.len() + length, || from_gltf(&path));
    assert_eq!(scene.unwrap().triangles(), BUFFERS);
    // More than a few times, and it would have been read more than once.
    assert!(most < 3 * length as u64, "{most} bytes of memory for {length}");
    std::fs::remove_dir_all(&folder).unwrap();
}

/// Where Debian's package assimp-testmodels puts them.
const MODELS: &str = "/usr/share/assimp/models";

/// How many of them load at least: 28 of the 53 of version 5.2.5. The others are broken on purpose, of glTF 1.0, or
/// without a triangle.
const LOAD: usize = 28;

/// The glTF files in a folder and those in it, in order.
fn gltf_files(folder: &Path, found: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    let mut paths: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    paths.sort();
    for path in paths {
        if path.is_dir() {
            gltf_files(&path, found);
        } else if path.extension().is_some_and(|e| e == "gltf" || e == "glb") {
            found.push(path);
        }
    }
}

/// Real exporters' files and files that broke another importer, as they are and broken.
/// `ANTUMBRA_GLTF_MODELS` names another folder.
#[test]
fn models_of_other_makers() {
    /// About how many bytes are opened of each model in all.
    const OPENED: usize = 2 << 20;
    let named = std::env::var_os("ANTUMBRA_GLTF_MODELS");
    let least = if named.is_some() { 1 } else { LOAD };
    let folder = named.map_or(MODELS.into(), PathBuf::from);
    let mut paths = Vec::new();
    gltf_files(&folder, &mut paths);
    if paths.is_empty() {
        return skip(&format!(
            "{} has no glTF files; apt-get install assimp-testmodels",
            folder.display()
        ));
    }
    let (mut whole_ones, mut broken_ones) = (Outcome::default(), Outcome::default());
    let check = |opened: Result<Scene, antumbra::Error>| {
        let checked = opened.map(|scene| {
            whole::check(&scene);
        });
        let checked = checked.map_err(|e| e.to_string());
        checked.inspect_err(|sentence| whole::check_sentence(sentence))
    };
    for path in &paths {
        let beside: usize = std::fs::read_dir(path.parent().unwrap())
            .unwrap()
            .map(|entry| entry.unwrap().metadata().unwrap().len() as usize)
            .sum();
        let room = |file: &[u8]| BYTES_PER_BYTE * beside as u64 + BYTES_BESIDE + images::room(file);
        let file = std::fs::read(path).unwrap();
        let opened = within(room(&file), beside, || from_gltf(path)).0;
        let notes = opened.as_ref().map_or(&[][..], |scene| &scene.notes);
        notes.iter().for_each(|note| println!("{}: {note}", path.display()));
        let opened = check(opened);
        match &opened {
            Ok(()) => println!("{}: it loads", path.display()),
            Err(sentence) => println!("{sentence}"),
        }
        whole_ones.add(opened);
        let mut random = Random::new(file.len() as u64);
        let seed = Seed::read(path);
        // Of those with buffers in files of their own.
        let json =
            serde_json::from_slice(&file).map(|v: serde_json::Value| Json::new(v.to_string()));
        for _ in 0..(OPENED / file.len().max(1)).clamp(10, 500) {
            let broken = match (&seed, &json) {
                (Some(seed), _) => seed.broken(&mut random),
                (None, Ok(json)) if random.below(4) > 0 => json.changed(1, &mut random),
                _ => {
                    let mut text = file.clone();
                    break_text(&mut text, &mut random);
                    text
                }
            };
            let _kept = Kept(&broken, "broken-model".into());
            let open = || from_gltf_bytes(&broken, path);
            let allowed = room(&broken) + BYTES_PER_BYTE * broken.len() as u64;
            broken_ones.add(check(within(allowed, beside + broken.len(), open).0));
        }
    }
    let loaded = whole_ones.loaded;
    for (what, outcome) in [("as they are", whole_ones), ("broken", broken_ones)] {
        println!("{what}: {} of {} load", outcome.loaded, outcome.files);
    }
    assert!(loaded >= least, "{loaded} models of {} load, not {least}", folder.display());
}
