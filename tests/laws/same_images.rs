//! The images of every technique, to the bit: what is moved or renamed changes none of them.
//!
//! `tests/laws/same_images.txt` records a hash and a mean visible fraction for each device and case. A device that it
//! records must give the same hashes; any other device must give the same means, to [`TOLERANCE`].
//!
//! `ANTUMBRA_WRITE_IMAGES=1 cargo test --workspace --test laws same_images` writes the lines of the device at hand anew
//! and keeps those of other devices.

// What the driver calls its version is queried from Vulkan itself.
#![allow(unsafe_code)]

use antumbra::scene::generate;
use antumbra_harness::{HeadlessDevice, View};
use antumbra_tests::device;
use antumbra_tests::example::root;
use antumbra_tests::measure::{Setup, model};
use ash::vk;
use fnv::FnvHasher;
use std::collections::BTreeSet;
use std::fmt::{self, Display, Formatter};
use std::hash::Hasher;
use std::io::Write;
use std::path::PathBuf;
use std::str::FromStr;

/// Each technique by its defaults, and by settings that run other shaders or other paths through them.
const TECHNIQUES: [&str; 16] = [
    "hard",
    "hard map=512",
    "pcss",
    "pcss classify=off taps=32",
    "many-lights",
    "many-lights samples=16 seed=0 map=128",
    "back-projection",
    "back-projection map=128",
    "soft-shadow-map map=256",
    "soft-shadow-map receivers=map accumulate=blend map=256",
    "ray-march",
    "ray-march layers=3 search=linear",
    "occlusion-textures",
    "occlusion-textures prefilter=n-buffer combine=product",
    "linear-light",
    "linear-light across=edges",
];

/// How far the mean visible fraction of an image may lie from that of a device with other hashes. Drivers place
/// edges differently in the last digits: lavapipe and SwiftShader are up to 6.7e-4 apart.
const TOLERANCE: f64 = 1e-3;

/// The visible fractions of one case. The words are a technique's name and its settings, as in `pcss taps=32`.
fn visibility(device: &HeadlessDevice, setup: &Setup, words: &str) -> Vec<f32> {
    let mut stage = setup.stage(device, &format!("technique={words}"));
    setup.visibility(&mut stage)
}

/// Renders every case.
fn render(device: &HeadlessDevice) -> Vec<Line> {
    let key = device_key(device);
    let cards = generate::stacked_cards(generate::square_light(0.4).unwrap());
    let models = ["bunny", "suzanne"].map(|name| (name, model(name)));
    let extent = [160, 120];
    let real = models.iter().map(|(name, scene)| {
        let view = View::of(&scene.camera.unwrap(), extent);
        (*name, Setup { scene, view, extent, window: None, occluders_seen: true })
    });
    let mut lines = Vec::new();
    for (scene, setup) in real.chain([("cards", Setup::ground(&cards, 2.2, 128))]) {
        for words in TECHNIQUES {
            let image = visibility(device, &setup, words);
            let (device, scene, technique) = (key.clone(), scene.into(), words.into());
            lines.push(Line { device, scene, technique, hash: hash(&image), mean: mean(&image) });
        }
    }
    lines
}

fn hash(image: &[f32]) -> u64 {
    let mut hasher = FnvHasher::default();
    image.iter().for_each(|v| hasher.write(&v.to_bits().to_le_bytes()));
    hasher.finish()
}

fn mean(image: &[f32]) -> f64 {
    image.iter().map(|v| f64::from(*v)).sum::<f64>() / image.len() as f64
}

/// What decides the bits: the device, its driver's version, and the CPU where the driver compiles for it.
fn device_key(device: &HeadlessDevice) -> String {
    let properties = device.properties();
    let version = properties.driver_version;
    let [major, minor, patch] =
        [version >> 22, vk::api_version_minor(version), vk::api_version_patch(version)];
    let info = driver_info(device);
    let driver = format!("{}, driver {major}.{minor}.{patch} {info}", device.name());
    let driver = driver.trim_end();
    match properties.device_type {
        vk::PhysicalDeviceType::CPU => format!("{driver}, {}", cpu_key()),
        _ => driver.into(),
    }
}

/// The driver's version in its own words, which Vulkan 1.2 brings; lavapipe's number is 0.0.1 in every release.
fn driver_info(device: &HeadlessDevice) -> String {
    if device.properties().api_version < vk::API_VERSION_1_2 {
        return String::new();
    }
    let mut driver = vk::PhysicalDeviceDriverProperties::default();
    let mut properties = vk::PhysicalDeviceProperties2::default().push_next(&mut driver);
    let (instance, physical_device) = (device.instance(), device.physical_device());
    // SAFETY: the physical device is this instance's, and has Vulkan 1.2.
    unsafe { instance.get_physical_device_properties2(physical_device, &mut properties) };
    driver.driver_info_as_c_str().unwrap_or_default().to_string_lossy().into_owned()
}

/// The CPU's vendor and family, which decide what approximate reciprocals and roots are, and its instruction sets.
fn cpu_key() -> String {
    let cpuinfo = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let value = |name: &str| {
        let fields = cpuinfo.lines().filter_map(|line| line.split_once(':'));
        let mut values = fields.filter(|(field, _)| field.trim() == name);
        values.next().map_or("unknown", |(_, value)| value.trim())
    };
    let cpu = format!("{} family {}", value("vendor_id"), value("cpu family"));
    format!("{} {cpu}{}", std::env::consts::ARCH, instruction_sets())
}

#[cfg(target_arch = "x86_64")]
fn instruction_sets() -> String {
    let sets = [
        (" sse4.1", std::is_x86_feature_detected!("sse4.1")),
        (" avx", std::is_x86_feature_detected!("avx")),
        (" avx2", std::is_x86_feature_detected!("avx2")),
        (" fma", std::is_x86_feature_detected!("fma")),
        (" f16c", std::is_x86_feature_detected!("f16c")),
        (" avx512f", std::is_x86_feature_detected!("avx512f")),
    ];
    sets.iter().filter(|(_, there)| *there).map(|(name, _)| *name).collect()
}

#[cfg(not(target_arch = "x86_64"))]
fn instruction_sets() -> String {
    String::new()
}

/// One line of the table: what a device made of a case.
#[derive(Clone, Debug, PartialEq)]
struct Line {
    device: String,
    scene: String,
    technique: String,
    hash: u64,
    mean: f64,
}

impl Line {
    fn is_of_case(&self, other: &Self) -> bool {
        self.scene == other.scene && self.technique == other.technique
    }
}

impl Display for Line {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self { device, scene, technique, hash, mean } = self;
        write!(f, "{device} | {scene} | {technique} | {hash:016x} | {mean:.9}")
    }
}

impl FromStr for Line {
    type Err = String;

    fn from_str(line: &str) -> Result<Self, String> {
        let fields: Vec<_> = line.split(" | ").collect();
        let [device, scene, technique, hash, mean] = fields[..] else {
            return Err(format!("not device | scene | technique | hash | mean: {line}"));
        };
        let (device, scene, technique) = (device.into(), scene.into(), technique.into());
        let hash = u64::from_str_radix(hash, 16).map_err(|e| format!("{e} in {line}"))?;
        let mean = mean.parse().map_err(|e| format!("{e} in {line}"))?;
        Ok(Self { device, scene, technique, hash, mean })
    }
}

/// What the table begins with.
const HEAD: &str = "\
# What tests/laws/same_images.rs compares images with:
# device | scene | technique and settings | FNV-1a hash of the image's bits | mean visible fraction
";

fn path() -> PathBuf {
    root().join("tests/laws/same_images.txt")
}

/// Reads the table; one that is not there has no lines.
fn table() -> Vec<Line> {
    let text = std::fs::read_to_string(path()).unwrap_or_default();
    let lines = text.lines().filter(|line| !line.is_empty() && !line.starts_with('#'));
    lines.map(|line| line.parse().unwrap_or_else(|e| panic!("{}: {e}", path().display()))).collect()
}

/// Replaces the lines of the rendered device, and sorts by device.
fn replaced(table: &[Line], rendered: &[Line]) -> Vec<Line> {
    let others = table.iter().filter(|line| rendered.iter().all(|r| r.device != line.device));
    let mut lines: Vec<Line> = others.chain(rendered).cloned().collect();
    lines.sort_by(|a, b| a.device.cmp(&b.device));
    lines
}

fn write(lines: &[Line]) {
    let lines: String = lines.iter().map(|line| format!("{line}\n")).collect();
    std::fs::write(path(), format!("{HEAD}{lines}")).unwrap();
}

/// One sentence for each rendered case that is not as its own device's lines record it, each case that is not
/// recorded, and each recorded one that is not rendered.
fn differences_to_the_bit(recorded: &[&Line], rendered: &[Line]) -> Vec<String> {
    let left_over = recorded.iter().filter(|line| !rendered.iter().any(|r| r.is_of_case(line)));
    let left_over = left_over.map(|line| {
        format!("{}, {}: recorded, but no case of the test", line.scene, line.technique)
    });
    let others = rendered.iter().filter_map(|r| {
        let case = format!("{}, {}", r.scene, r.technique);
        match recorded.iter().find(|line| r.is_of_case(line)) {
            None => Some(format!("{case}: not recorded")),
            Some(line) if line.hash == r.hash => None,
            Some(line) => Some(format!(
                "{case}: hash {:016x}, recorded {:016x}; mean visible fraction {:.9}, recorded {:.9}, {:+.1e} apart",
                r.hash,
                line.hash,
                r.mean,
                line.mean,
                r.mean - line.mean
            )),
        }
    });
    others.chain(left_over).collect()
}

/// One sentence for each rendered case whose mean is too far from what another device recorded, and each that no
/// device has recorded.
fn differences_of_means(recorded: &[Line], rendered: &[Line]) -> Vec<String> {
    let mut found = Vec::new();
    for r in rendered {
        let case = format!("{}, {}", r.scene, r.technique);
        let lines: Vec<_> = recorded.iter().filter(|line| r.is_of_case(line)).collect();
        if lines.is_empty() {
            found.push(format!("{case}: not recorded by any device"));
        }
        // What is no number is near nothing.
        let near = |line: &Line| (line.mean - r.mean).abs() <= TOLERANCE;
        found.extend(lines.iter().filter(|line| !near(line)).map(|line| {
            format!(
                "{case}: mean visible fraction {:.9}; {:.9} on {}, {:+.1e} apart",
                r.mean,
                line.mean,
                line.device,
                r.mean - line.mean
            )
        }));
    }
    found
}

/// The largest distance between a rendered mean and a recorded one of the same case.
fn farthest(recorded: &[Line], rendered: &[Line]) -> f64 {
    let pairs = rendered.iter().flat_map(|r| {
        recorded.iter().filter(|line| r.is_of_case(line)).map(|line| (line.mean - r.mean).abs())
    });
    pairs.fold(0.0, f64::max)
}

fn records(table: &[Line], device: &str) -> bool {
    table.iter().any(|line| line.device == device)
}

/// All that differs from the table: to the bit where it records the device, and by the means where it does not.
fn differences(table: &[Line], rendered: &[Line]) -> Vec<String> {
    let key = &rendered[0].device;
    if records(table, key) {
        let own: Vec<_> = table.iter().filter(|line| line.device == *key).collect();
        return differences_to_the_bit(&own, rendered);
    }
    differences_of_means(table, rendered)
}

#[test]
fn every_technique_gives_the_recorded_images() {
    let device = device();
    let rendered = render(&device);
    let plain: Vec<_> = rendered.iter().filter(|r| !(0.01..0.99).contains(&r.mean)).collect();
    assert!(plain.is_empty(), "images with hardly a shadow, or with little else: {plain:#?}");
    for scene in ["bunny", "suzanne", "cards"] {
        let of = rendered.iter().filter(|r| r.scene == scene);
        let distinct: BTreeSet<u64> = of.map(|r| r.hash).collect();
        assert_eq!(distinct.len(), TECHNIQUES.len(), "{scene}: two settings, and one image");
    }
    if std::env::var("ANTUMBRA_WRITE_IMAGES").is_ok_and(|value| value == "1") {
        write(&replaced(&table(), &rendered));
        println!("wrote the lines of {}", rendered[0].device);
    }
    let table = table();
    let key = &rendered[0].device;
    if !records(&table, key) {
        // The harness shows what is printed only where a test fails.
        let _ = writeln!(
            std::io::stderr(),
            "same_images compares means alone, to {TOLERANCE:.0e}, and no bits: its table has no lines of {key}; the \
             farthest mean is {:.1e} from a recorded one",
            farthest(&table, &rendered)
        );
    }
    let differences = differences(&table, &rendered);
    assert!(
        differences.is_empty(),
        "{} of {} images are not those of tests/laws/same_images.txt on {key}:\n{}\nwhere they are meant to differ, run: \
         ANTUMBRA_WRITE_IMAGES=1 cargo test --workspace --test laws same_images",
        differences.len(),
        rendered.len(),
        differences.join("\n")
    );
    // The recorded devices hold the tolerance that others are held to.
    println!("the farthest means of two devices are {:.1e} apart", farthest(&table, &table));
    let apart = differences_of_means(&table, &table);
    assert!(apart.is_empty(), "recorded devices are too far apart:\n{}", apart.join("\n"));
}

/// A line for the tests below.
fn line(device: &str, technique: &str, hash: u64, mean: f64) -> Line {
    Line { device: device.into(), scene: "cards".into(), technique: technique.into(), hash, mean }
}

#[test]
fn every_wrong_hash_is_found_on_a_recorded_device() {
    // Means do not matter there: the bits do.
    let table = [line("a", "hard", 1, 0.5), line("a", "pcss", 2, 0.5), line("b", "hard", 7, 0.5)];
    assert!(differences(&table, &table[..2]).is_empty());
    let wrong = [line("a", "hard", 7, 0.5), line("a", "pcss", 3, 0.25)];
    let found = differences(&table, &wrong);
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(found[0].contains("cards, hard: hash 0000000000000007, recorded 0000000000000001"));
    assert!(found[1].contains("cards, pcss") && found[1].contains("-2.5e-1 apart"), "{found:?}");
    let found = differences(&table, &[line("a", "hard", 1, 0.5), line("a", "ray-march", 4, 0.5)]);
    assert_eq!(
        found,
        ["cards, ray-march: not recorded", "cards, pcss: recorded, but no case of the test"]
    );
}

#[test]
fn every_wrong_mean_is_found_on_another_device() {
    let table = [line("a", "hard", 1, 0.5), line("b", "hard", 2, 0.5 + 0.5 * TOLERANCE)];
    let on_another = |technique, mean| differences(&table, &[line("c", technique, 3, mean)]);
    assert!(on_another("hard", 0.5).is_empty());
    let found = on_another("hard", 0.5 - 0.75 * TOLERANCE);
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].contains(" on b, "), "{found:?}");
    assert_eq!(on_another("hard", 0.5 - 1.5 * TOLERANCE).len(), 2);
    assert_eq!(on_another("hard", f64::NAN).len(), 2);
    assert_eq!(on_another("pcss", 0.5), ["cards, pcss: not recorded by any device"]);
}

#[test]
fn what_is_written_is_read_and_other_devices_keep_their_lines() {
    let table = [line("a", "hard", 1, 0.5), line("b", "hard", 2, 0.123_456_789)];
    for line in &table {
        assert_eq!(line.to_string().parse::<Line>().unwrap(), *line);
    }
    "a | cards | hard | 1".parse::<Line>().unwrap_err();
    let anew = line("a", "pcss", u64::MAX, 0.5);
    assert_eq!(replaced(&table, std::slice::from_ref(&anew)), [anew, table[1].clone()]);
}

/// One bit of one pixel is enough, also in the sign of a zero.
#[test]
fn the_hash_is_of_every_bit() {
    // FNV-1a of no bytes is its offset basis, and of one zero byte that times its prime.
    assert_eq!(hash(&[]), 0xcbf2_9ce4_8422_2325);
    let image = [0.0, 0.25, 1.0];
    assert_eq!(hash(&image), hash(&image.clone()));
    assert_ne!(hash(&image), hash(&[-0.0, 0.25, 1.0]));
    assert_ne!(hash(&image), hash(&[0.0, 0.25_f32.next_up(), 1.0]));
    assert_ne!(hash(&image), hash(&[0.25, 0.0, 1.0]));
}
