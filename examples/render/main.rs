//! glTF in; visibility, G-buffer, pictures and a report out.
//!
//! `cargo run --release --example render -- scenes/bunny.glb --out out/bunny`

mod costs;
mod notes;
mod options;
mod output;
mod report;

use antumbra::Error;
use antumbra::Omit;
use antumbra::audit::ErrorWindow;
use antumbra::auto::Auto;
use antumbra::frame::Capacity;
use antumbra::scene::{Camera, Scene, from_gltf};
use antumbra_harness::shade;
use antumbra_harness::{
    FrameTimes, GBuffer, HeadlessDevice, HeadlessOptions, Stage, View, technique,
};
use image::ExtendedColorType;
use options::{Options, Stop};
use output::Files;
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let done = options::parse(std::env::args_os()).and_then(|options| render(&options));
    match done {
        Ok(summary) => {
            println!("{summary}");
            ExitCode::SUCCESS
        }
        Err(Stop::Help(text)) => {
            print!("{text}");
            ExitCode::SUCCESS
        }
        Err(Stop::Wrong(line)) => {
            eprintln!("{}", line.replace('\n', " "));
            ExitCode::from(2)
        }
    }
}

/// Why a file was refused; where its name does not say that it is glTF, that is why.
fn no_gltf(path: &Path, error: Error) -> Stop {
    let kind = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    match kind.as_deref() {
        Some("glb" | "gltf") => error.into(),
        _ if !path.is_file() => error.into(),
        _ => Stop::Wrong(format!("{} is no glTF; export the scene as .glb", path.display())),
    }
}

/// The scene with the overrides of the command line.
fn load(options: &Options) -> Result<Scene, Stop> {
    let mut scene = from_gltf(&options.scene).map_err(|e| no_gltf(&options.scene, e))?;
    for (node, role) in &options.roles {
        scene.set_role(node, *role)?;
    }
    if scene.triangles() == 0 {
        let path = options.scene.display();
        return Err(Stop::Wrong(format!(
            "{path}: the scene has no triangles; at least one mesh node must be drawn"
        )));
    }
    Ok(scene)
}

/// Room for a scene's triangles, an even number a mesh.
fn capacity(scene: &Scene, usual: Capacity) -> Capacity {
    let triangles = scene.triangles() + scene.instances.len();
    Capacity {
        triangles: usual.triangles.max(triangles.min(Capacity::MOST.triangles as usize) as u32),
        meshes: usual.meshes.max(scene.instances.len().min(Capacity::MOST.meshes as usize) as u32),
    }
}

fn render(options: &Options) -> Result<String, Stop> {
    let scene = load(options)?;
    let light = scene.light(options.light.as_deref()).map_err(|e| {
        // Who has no light yet wants to see one.
        let more =
            if scene.lights.is_empty() { "; README.md shows one, \"Your own scene\"" } else { "" };
        Stop::Wrong(format!("{}: {e}{more}", options.scene.display()))
    })?;
    let [width, height] = options.size;
    let aspect = f64::from(width) / f64::from(height);
    let camera = scene.camera.unwrap_or_else(|| Camera::framing(&scene, aspect));
    let view = View::perspective(&camera, options.size);

    let device = HeadlessDevice::new(&HeadlessOptions {
        validation: options.validate,
        ..Default::default()
    })?;
    // Before anything is chosen, the technique with the fewest passes.
    let few = technique("hard");
    let mut stage = Stage::new(&device, &scene, &view, options.size, few, |_| true)?;
    let mut settings = options.settings;
    let choice = match options.auto {
        None => None,
        Some(budget) => {
            let mut auto = Auto::new(budget, costs::of(&device)?);
            let choice = stage.choose(&mut auto, light)?;
            settings = choice.technique;
            Some(choice)
        }
    };
    stage.configure_with(settings, |description| {
        description.omit = options.max_error.map_or(description.omit, Omit::Below);
        description.audit = options.audit;
        description.capacity = capacity(&scene, description.capacity);
        description.normals = Some(GBuffer::NORMALS);
    })?;
    let plan = stage.plan_under(light, None)?;
    for note in notes::of(options, &scene, light, &plan, choice.as_ref()) {
        eprintln!("{note}");
    }
    // The first frame is not timed: drivers compile shaders when they first run.
    stage.run(&plan)?;
    let mut frames: Vec<FrameTimes> = Vec::new();
    let mut window = ErrorWindow::new();
    for _ in 0..options.repeat {
        frames.push(stage.run(&plan)?);
        let measured = stage.node()?.measured_error(plan.slot(), plan.light_index());
        measured.iter().for_each(|error| window.add(error));
    }

    let visibility = stage.visibility()?;
    let positions = stage.gbuffer().positions()?;
    let normals = stage.gbuffer().normals()?;
    let memory = stage.node()?.memory();
    let report = report::Report {
        device: &device,
        options,
        settings: &settings,
        choice: choice.as_ref(),
        scene: &scene,
        plan: &plan,
        frames,
        memory,
        measured: (options.audit > 0).then(|| window.error()),
    };

    let mut files = Files::default();
    files.exr_y("visibility.exr", options.size, &visibility)?;
    files.exr_rgb("position.exr", options.size, &positions)?;
    files.exr_rgb("normal.exr", options.size, &normals)?;
    let gray: Vec<u8> = visibility.iter().map(|v| (v * 255.0).round() as u8).collect();
    files.png("visibility.png", options.size, ExtendedColorType::L8, &gray)?;
    let shaded = shade::shade(light, &visibility, &positions, &normals);
    files.png("shaded.png", options.size, ExtendedColorType::Rgb8, &shaded)?;
    files.text("report.json", report.json());
    let summary = report.summary();
    if let Some(note) = notes::too_slow(options, choice.as_ref(), report.frame_ms()) {
        eprintln!("{note}");
    }

    // The device's last words count too.
    drop(stage);
    let messages = device.messages();
    if let (true, Some(first)) = (options.validate, messages.first()) {
        return Err(Stop::Wrong(format!(
            "--validate: {} validation messages, the first: {first}",
            messages.len()
        )));
    }
    files.write(&options.out)?;
    Ok(summary)
}
