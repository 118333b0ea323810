//! glTF in; visibility, G-buffer, pictures and a report out.
//!
//! `cargo run --release --example render -- scenes/bunny.glb --out out/bunny`

mod costs;
mod notes;
mod options;
mod output;
mod report;

use antumbra::audit::ErrorWindow;
use antumbra::auto::Auto;
use antumbra::frame::Capacity;
use antumbra::scene::{AreaLight, Camera, GltfOptions, Scene, from_gltf_as};
use antumbra::{Error, FramePlan, LightIndex, Omit, Technique, TechniqueIndex};
use antumbra_harness::shade;
use antumbra_harness::{
    FrameTimes, GBuffer, HeadlessDevice, HeadlessOptions, Stage, View, technique,
};
use image::ExtendedColorType;
use options::{Options, Stop};
use output::Files;
use report::Drawn;
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
    let animation = options.animation.as_ref().map(|(name, time)| (name.as_str(), *time));
    let of = GltfOptions {
        scene: options.part.as_deref(),
        animation,
        light_radius: options.light_radius,
        emissive: options.emissive,
    };
    let mut scene = from_gltf_as(&options.scene, &of).map_err(|e| no_gltf(&options.scene, e))?;
    for (node, role) in &options.roles {
        scene.set_role(node, *role)?;
    }
    if let Some(camera) = &options.camera {
        scene.set_camera(camera)?;
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

/// The lights that are drawn: the one that is named, or all.
fn drawn<'a>(options: &Options, scene: &'a Scene) -> Result<Vec<&'a AreaLight>, Stop> {
    let path = options.scene.display();
    let first = scene.light(options.light.as_deref()).map_err(|e| {
        // Who has no light yet wants to see one.
        let more =
            if scene.lights.is_empty() { "; README.md shows one, \"Your own scene\"" } else { "" };
        Stop::Wrong(format!("{path}: {e}{more}"))
    })?;
    match (&options.light, scene.lights.len()) {
        (Some(_), _) => Ok(vec![first]),
        (None, number) if number > MOST_LIGHTS => Err(Stop::Wrong(format!(
            "{path}: the scene has {number} lights, and one run draws {MOST_LIGHTS} at most; name one by --light"
        ))),
        (None, _) => Ok(scene.lights.iter().collect()),
    }
}

/// The most lights of a node.
const MOST_LIGHTS: usize = 64;

/// The most techniques of a node.
const MOST_TECHNIQUES: usize = 16;

/// Each light's technique, as the node has them: all different ones, and which of them each light uses. Where there are
/// more than a node may have, the rest use the first.
fn different(settings: &[Technique]) -> (Vec<Technique>, Vec<usize>) {
    let mut all: Vec<Technique> = Vec::new();
    let mut place = |technique: &Technique| {
        let known = all.iter().position(|t| t == technique);
        known.unwrap_or_else(|| match all.len() {
            MOST_TECHNIQUES => 0,
            number => {
                all.push(*technique);
                number
            }
        })
    };
    let places = settings.iter().map(&mut place).collect();
    (all, places)
}

/// A channel for each light, named by its node. A name that others have too is followed by its number among them.
fn channels(lights: &[&AreaLight], images: Vec<Vec<f32>>) -> Vec<(String, Vec<f32>)> {
    let name = |place: usize| {
        let name = &lights[place].name;
        let before = lights[..place].iter().filter(|l| l.name == *name).count();
        // Names end at a zero, and have 255 bytes at most.
        let mut bytes = 0;
        let fits = |c: &char| {
            bytes += c.len_utf8();
            bytes <= 240
        };
        let plain: String = name.chars().filter(|c| *c != '\0').take_while(fits).collect();
        match before {
            0 => plain,
            number => format!("{plain} ({})", number + 1),
        }
    };
    images.into_iter().enumerate().map(|(place, image)| (name(place), image)).collect()
}

fn render(options: &Options) -> Result<String, Stop> {
    let scene = load(options)?;
    let lights = drawn(options, &scene)?;
    let [width, height] = options.size;
    let aspect = f64::from(width) / f64::from(height);
    let camera = scene.camera.unwrap_or_else(|| Camera::framing(&scene, aspect));
    let view = View::of(&camera, options.size);

    let device = HeadlessDevice::new(&HeadlessOptions {
        validation: options.validate,
        ..Default::default()
    })?;
    // Before anything is chosen, the technique with the fewest passes.
    let few = technique("hard");
    let mut stage = Stage::new(&device, &scene, &view, options.size, few, |_| true)?;
    let choices = match options.auto {
        None => None,
        Some(budget) => {
            let mut auto = Auto::new(budget, costs::of(&device)?);
            Some(stage.choose_all(&mut auto, &lights)?)
        }
    };
    let settings: Vec<Technique> = match &choices {
        Some(choices) => choices.iter().map(|c| c.technique).collect(),
        None => vec![options.settings; lights.len()],
    };
    let (techniques, of_light) = different(&settings);
    stage.configure_with(techniques[0], |description| {
        description.other_techniques = techniques[1..].to_vec();
        description.lights = lights.len() as u32;
        description.omit = options.max_error.map_or(description.omit, Omit::Below);
        description.audit = options.audit;
        description.capacity = capacity(&scene, description.capacity);
        description.normals = Some(GBuffer::NORMALS);
    })?;
    let plan = |(place, light): (usize, &&AreaLight)| {
        let planned = stage.plan_with(light.light, |frame| {
            frame.light_index = LightIndex(place as u32);
            frame.technique_index = TechniqueIndex(of_light[place] as u32);
        });
        planned.map_err(|e| match lights.len() {
            1 => Stop::from(e),
            _ => Stop::Wrong(format!("the light {}: {e}", light.name)),
        })
    };
    let plans: Vec<FramePlan> = lights.iter().enumerate().map(plan).collect::<Result<_, _>>()?;
    let mut drawn: Vec<Drawn> = lights
        .iter()
        .zip(&plans)
        .enumerate()
        .map(|(place, (light, plan))| Drawn {
            light,
            settings: &techniques[of_light[place]],
            choice: choices.as_ref().map(|choices| &choices[place]),
            plan,
            times: Vec::new(),
            measured: None,
        })
        .collect();
    for note in notes::of(options, &scene, &drawn) {
        eprintln!("{note}");
    }
    // The first frame is not timed: drivers compile shaders when they first run.
    stage.run_all(&plans)?;
    let mut frames: Vec<FrameTimes> = Vec::new();
    let mut windows: Vec<ErrorWindow> = plans.iter().map(|_| ErrorWindow::new()).collect();
    let mut all = ErrorWindow::new();
    for _ in 0..options.repeat {
        frames.push(stage.run_all(&plans)?);
        let node = stage.node()?;
        for (window, (drawn, plan)) in windows.iter_mut().zip(drawn.iter_mut().zip(&plans)) {
            let (slot, light) = (plan.slot(), plan.light_index());
            drawn.times.extend(node.timings(slot, light));
            if let Some(error) = node.measured_error(slot, light) {
                window.add(&error);
                all.add(&error);
            }
        }
    }
    if options.audit > 0 {
        for (drawn, window) in drawn.iter_mut().zip(&windows) {
            drawn.measured = Some(window.error());
        }
    }

    let indices = (0..lights.len()).map(|place| LightIndex(place as u32));
    let visible: Vec<Vec<f32>> =
        indices.map(|light| stage.visibility_under(light)).collect::<Result<_, _>>()?;
    let positions = stage.gbuffer().positions()?;
    let normals = stage.gbuffer().normals()?;
    let memory = stage.node()?.memory();
    let report = report::Report {
        device: &device,
        options,
        scene: &scene,
        lights: &drawn,
        frames,
        memory,
        measured: (options.audit > 0).then(|| all.error()),
    };

    let mut files = Files::default();
    files.exr_rgb("position.exr", options.size, &positions)?;
    files.exr_rgb("normal.exr", options.size, &normals)?;
    // The mean of all lights.
    let share = 255.0 / lights.len() as f32;
    let gray = |pixel: usize| (visible.iter().map(|v| v[pixel]).sum::<f32>() * share).round() as u8;
    let gray: Vec<u8> = (0..positions.len()).map(gray).collect();
    files.png("visibility.png", options.size, ExtendedColorType::L8, &gray)?;
    let lit: Vec<(&AreaLight, &[f32])> =
        lights.iter().zip(&visible).map(|(light, image)| (*light, &image[..])).collect();
    let shaded = shade::shade_all(&lit, &positions, &normals);
    files.png("shaded.png", options.size, ExtendedColorType::Rgb8, &shaded)?;
    match &visible[..] {
        [only] => files.exr_y("visibility.exr", options.size, only)?,
        _ => files.exr_named("visibility.exr", options.size, &channels(&lights, visible))?,
    }
    files.text("report.json", report.json());
    let summary = report.summary();
    if let Some(note) = notes::too_slow(options, &drawn, report.frame_ms()) {
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
