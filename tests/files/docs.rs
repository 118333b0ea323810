//! What docs/embedding.md says in tables is what the code does, and what deny.toml allows is what is used.

mod pages;
#[path = "docs/words.rs"]
mod words;

use antumbra::graph::{Owner, Shape};
use antumbra::{Description, NormalEncoding, Normals, frame};
use antumbra_tests::example::root;
use ash::vk;

fn page() -> String {
    std::fs::read_to_string(root().join("docs/embedding.md")).unwrap()
}

/// The cells of the table row that begins with this cell.
fn row(page: &str, first: &str) -> Vec<String> {
    let start = format!("| {first}");
    let line = page.lines().find(|l| l.starts_with(&start));
    let line = line.unwrap_or_else(|| panic!("no row begins with {first}"));
    line.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect()
}

#[test]
fn the_table_of_images_is_the_graphs() {
    let page = page();
    let description = Description {
        mask_format: Some(vk::Format::R8_UNORM),
        normals: Some(Normals {
            format: vk::Format::R16G16_SNORM,
            encoding: NormalEncoding::OctahedralSigned,
        }),
        occluder_maps: Some(vk::Format::D32_SFLOAT),
        lent_visibility: true,
        ..Description::new([64, 48])
    };
    let graph = frame::full_graph(&description);
    let mut found = 0;
    for index in 0..graph.resources().len() {
        let id = graph.id(index);
        let resource = graph.resource(id);
        if resource.owner == Owner::Transient {
            continue;
        }
        found += 1;
        let cells = row(&page, &format!("`{}`", resource.name));
        for access in graph.uses_of(id) {
            let usage = format!("{:?}", access.image_usage());
            let stage = format!("{:?}", access.scope().stage);
            let layout = format!("{:?}", access.scope().layout);
            assert_eq!(cells[3], usage, "{}", resource.name);
            assert!(cells[4].ends_with(&stage), "{}: {stage}", resource.name);
            assert_eq!(access.writes(), cells[4].starts_with("written"), "{}", resource.name);
            let expected = if access.writes() { layout.as_str() } else { "the host's" };
            assert_eq!(cells[5], expected, "{}", resource.name);
        }
    }
    let rows = page.lines().skip_while(|l| !l.starts_with("| image |")).skip(2);
    assert_eq!(rows.take_while(|l| l.starts_with('|')).count(), found, "a row too many");
}

#[test]
fn the_table_of_memory_is_the_graphs() {
    let page = page();
    for (column, extent) in [(2, [640, 480]), (3, [1920, 1080])] {
        let graph = frame::full_graph(&Description::new(extent));
        let mut found = 0;
        for (index, resource) in graph.resources().iter().enumerate() {
            let used = graph.uses_of(graph.id(index)).next().is_some();
            if resource.owner == Owner::Imported || !used {
                continue;
            }
            found += 1;
            let bytes = match resource.shape {
                Shape::Buffer { bytes } => bytes,
                Shape::Image { format, width, height, layers } => {
                    assert_eq!(layers, None);
                    assert!(matches!(format, vk::Format::R32_SFLOAT | vk::Format::D32_SFLOAT));
                    u64::from(width) * u64::from(height) * 4
                }
            };
            let cells = row(&page, &format!("`{}`", resource.name));
            let cells = if resource.name == "visibility" {
                row(&page, "`visibility` (unless lent)")
            } else {
                cells
            };
            assert_eq!(cells[column], bytes.to_string(), "{} at {extent:?}", resource.name);
        }
        let rows = page.lines().skip_while(|l| !l.starts_with("| resource |")).skip(2);
        assert_eq!(rows.take_while(|l| l.starts_with('|')).count(), found, "a row too many");
    }
}

/// The version that a manifest asks for of a crate.
fn asked(manifest: &str, name: &str) -> String {
    let text = std::fs::read_to_string(root().join(manifest)).unwrap();
    let line = text.lines().find(|l| l.starts_with(&format!("{name} = ")));
    let line = line.unwrap_or_else(|| panic!("{manifest} does not name {name}"));
    let version = line.split_once("version = ").map_or(line, |(_, rest)| rest);
    version.split('"').nth(1).unwrap().to_owned()
}

#[test]
fn the_versions_are_the_manifests() {
    let readme = std::fs::read_to_string(root().join("README.md")).unwrap();
    for page in [page(), readme] {
        let cells = row(&page, "0.1 ");
        let version = asked("Cargo.toml", "version");
        assert!(version.starts_with(&format!("{}.", cells[0])), "{version}");
        let needed = ["ash", "gpu-allocator", "glam", "rust-version"];
        for (cell, name) in cells[1..].iter().zip(needed) {
            assert_eq!(*cell, asked("Cargo.toml", name), "{name}");
        }
    }
    let hosts = format!(
        "vk-graph {}, wgpu {}",
        asked("examples/embed_vk_graph/Cargo.toml", "vk-graph"),
        asked("examples/embed_wgpu/Cargo.toml", "wgpu")
    );
    assert_eq!(row(&page(), "0.1 ")[5], hosts);
}

/// Lines that are code: no comment, no blank, no import.
fn glue(path: &str) -> usize {
    let text = std::fs::read_to_string(root().join(path)).unwrap();
    let mut import = false;
    let code = |line: &&str| {
        let line = line.trim();
        import |= line.starts_with("use ");
        let counts = !import && !line.is_empty() && !line.starts_with("//");
        import &= !line.ends_with(';');
        counts
    };
    text.lines().filter(code).count()
}

#[test]
fn the_hosts_glue_is_counted() {
    let page = page();
    for (host, path) in [
        ("`embed`", "examples/embed/shadows.rs"),
        ("`embed_vk_graph`", "examples/embed_vk_graph/src/shadows.rs"),
        ("`embed_wgpu`", "examples/embed_wgpu/src/shadows.rs"),
    ] {
        let lines = glue(path);
        println!("{path}: {lines}");
        assert_eq!(row(&page, host)[1], lines.to_string(), "{path}");
    }
}

/// Without cargo deny, what it says of licences, for the packages that this platform builds.
#[test]
fn the_licences_are_those_that_deny_toml_allows() {
    let deny = std::fs::read_to_string(root().join("deny.toml")).unwrap();
    let (_, list) = deny.split_once("\nallow = [").unwrap();
    let allowed: Vec<&str> =
        list.split(']').next().unwrap().split('"').skip(1).step_by(2).collect();
    assert!(allowed.contains(&"MIT"));
    let metadata = metadata();
    let mut used: Vec<&str> = Vec::new();
    let packages = metadata["packages"].as_array().unwrap();
    for package in packages.iter().filter(|package| package["source"].is_string()) {
        let licence = package["license"].as_str().unwrap_or("none").replace('/', " OR ");
        // In parentheses, if anything, are the alternatives of one part.
        for part in licence.split(" AND ") {
            let mut either = part.trim_matches(['(', ')']).split(" OR ").map(str::trim);
            let known = either.find_map(|one| allowed.iter().find(|known| **known == one));
            let known = known.unwrap_or_else(|| panic!("{} is under {licence}", package["name"]));
            used.push(known);
        }
    }
    assert!(packages.len() > 50, "{} packages", packages.len());
    for licence in allowed {
        assert!(used.contains(&licence), "{licence} is allowed, and nothing is under it");
    }
}

/// What cargo knows of all packages of this platform, which are here, or it could not have built this.
fn metadata() -> serde_json::Value {
    let host = std::process::Command::new("rustc").arg("-vV").output().unwrap().stdout;
    let host = String::from_utf8(host).unwrap();
    let host = host.lines().find_map(|line| line.strip_prefix("host: ")).unwrap();
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".into());
    let output = std::process::Command::new(cargo)
        .args([
            "metadata",
            "--format-version=1",
            "--offline",
            "--locked",
            "--filter-platform",
            host,
        ])
        .current_dir(root())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}
