//! N-buffers and what serves beside them: their levels and their windows, against a scan of the map.

use antumbra::stages::nbuffer::twin::Values;
use antumbra::stages::nbuffer::{Kind, Levels};
use antumbra_harness::{ComputeProgram, HeadlessDevice, HostBuffer};
use antumbra_tests::compile::try_compile;
use antumbra_tests::{Function, device};
use ash::vk;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

/// The largest map that is tried.
const MOST: u32 = 300;

/// Windows that are asked for of each map.
const WINDOWS: usize = 64;

/// A way to combine values: GLSL for `combine`, the twin of it, and the mean's switch.
struct Way {
    name: &'static str,
    combine: &'static str,
    of: fn(&[f32]) -> f32,
    mean: bool,
}

const WAYS: [Way; 3] = [
    Way {
        name: "least",
        combine: "return min(a, b);",
        of: |parts| parts.iter().copied().fold(f32::INFINITY, f32::min),
        mean: false,
    },
    Way {
        name: "largest",
        combine: "return max(a, b);",
        of: |parts| parts.iter().copied().fold(f32::NEG_INFINITY, f32::max),
        mean: false,
    },
    Way { name: "mean", combine: "return a + b;", of: |_| f32::NAN, mean: true },
];

/// Builds levels and asks for windows, of values of so many channels.
struct Machine<'a> {
    way: &'a Way,
    channels: usize,
    map: HostBuffer,
    levels: HostBuffer,
    windows: HostBuffer,
    results: HostBuffer,
    build: ComputeProgram,
    query: Option<ComputeProgram>,
}

impl<'a> Machine<'a> {
    fn new(device: &HeadlessDevice, way: &'a Way, channels: usize) -> Self {
        let storage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let kinds = [Kind::NBuffer, Kind::Thirds, Kind::Mip];
        let most = kinds.iter().map(|&kind| Levels { map: MOST, kind }.texels() as usize);
        let buffer = |name, words: usize| {
            HostBuffer::with_data(device, name, &vec![0u32; words], storage).unwrap()
        };
        let map = buffer("map", (MOST * MOST) as usize * channels);
        let levels = buffer("levels", most.max().unwrap() * channels);
        let windows = buffer("windows", 4 * WINDOWS);
        let results = buffer("results", WINDOWS * channels);
        let value = ["float", "vec2", "", "vec4"][channels - 1];
        let common = format!(
            "#version 450\n#extension GL_GOOGLE_include_directive : require\n\
             #define VALUE {value}\n{}\
             layout(set = 0, binding = 0, std430) readonly buffer Map {{ VALUE map_values[]; }};\n\
             layout(set = 0, binding = 1, std430) buffer Made {{ VALUE made[]; }};\n\
             #include \"nbuffer/levels.glsl\"\n\
             VALUE combine(VALUE a, VALUE b) {{ {} }}\n\
             int index_of(Levels l, int level, ivec2 node)\n\
             {{ ivec3 p = place_of(l, level, node); return (p.z * l.map + p.y) * l.map + p.x; }}\n\
             VALUE value_at(Levels l, int level, ivec2 node)\n\
             {{ return level == 0 ? map_values[node.y * l.map + node.x] : made[index_of(l, level, node)]; }}\n",
            if way.mean { "#define MEAN\n" } else { "" },
            way.combine
        );
        let build = format!(
            "{common}layout(local_size_x = 8, local_size_y = 8) in;\n\
             layout(push_constant) uniform Push {{ int map; int kind; int level; }} push;\n\
             void main() {{\n\
                 ivec2 p = ivec2(gl_GlobalInvocationID.xy);\n\
                 Levels l = Levels(push.map, push.kind);\n\
                 int side = side_of(l, push.level);\n\
                 if (p.x < side && p.y < side)\n\
                     made[index_of(l, push.level, p)] = combined(l, push.level, p);\n\
             }}\n"
        );
        let query = format!(
            "{common}layout(local_size_x = 64) in;\n\
             layout(set = 0, binding = 2, std430) readonly buffer Windows {{ ivec4 windows[]; }};\n\
             layout(set = 0, binding = 3, std430) buffer Results {{ VALUE results[]; }};\n\
             layout(push_constant) uniform Push {{ int map; int kind; }} push;\n\
             void main() {{\n\
                 uint i = gl_GlobalInvocationID.x;\n\
                 Levels l = Levels(push.map, push.kind);\n\
                 results[i] = window_value(l, windows[i].xy, windows[i].z);\n\
             }}\n"
        );
        let compile = |name: &str, source: &str| {
            try_compile(name, source).unwrap_or_else(|log| panic!("{log}"))
        };
        let build =
            ComputeProgram::new(device, &compile("build.comp", &build), 12, &[&map, &levels]);
        let buffers = [&map, &levels, &windows, &results];
        let query = (!way.mean).then(|| {
            ComputeProgram::new(device, &compile("query.comp", &query), 8, &buffers).unwrap()
        });
        let build = build.unwrap();
        Self { way, channels, map, levels, windows, results, build, query }
    }

    /// Builds every level of a map of `side` texels.
    fn build(&mut self, levels: Levels, map: &[f32]) {
        self.map.write(map).unwrap();
        for level in 1..=levels.top() {
            let push = [levels.map as i32, levels.kind.code(), level as i32];
            let groups = levels.side(level).div_ceil(8);
            self.build.run(bytemuck::cast_slice(&push), [groups, groups, 1]).unwrap();
        }
    }

    /// One channel of the levels, as the device made them, beside the twin's.
    fn check_levels(&self, levels: Levels, map: &[f32]) {
        let made: Vec<f32> = self.levels.read();
        for channel in 0..self.channels {
            let own = map.iter().skip(channel).step_by(self.channels).copied().collect();
            let fan = if levels.kind == Kind::Thirds { 9.0 } else { 4.0 };
            let twin = if self.way.mean {
                Values::new(levels, own, |parts| {
                    parts[1..].iter().fold(parts[0], |sum, v| sum + v) / fan
                })
            } else {
                Values::new(levels, own, self.way.of)
            };
            for level in 1..=levels.top() {
                let side = levels.side(level);
                for (y, x) in (0..side).flat_map(|y| (0..side).map(move |x| (y, x))) {
                    let at = levels.index(level, [x, y]);
                    let device = made[at * self.channels + channel];
                    let expected = twin.of_level[level as usize][(y * side + x) as usize];
                    // Up to nine numbers below 1,040 in another order.
                    let off = (device - expected).abs();
                    assert!(
                        device == expected || self.way.mean && off <= 9.0 * 1040.0 * f32::EPSILON,
                        "{} of {levels:?}, level {level}, node ({x}, {y}): {device}, not {expected}",
                        self.way.name
                    );
                }
            }
        }
    }

    /// The windows' values by the device.
    fn windows(&mut self, levels: Levels, windows: &[[i32; 3]]) -> Vec<f32> {
        let words: Vec<i32> = windows.iter().flat_map(|&[x, y, side]| [x, y, side, 0]).collect();
        self.windows.write(&words).unwrap();
        let push = [levels.map as i32, levels.kind.code()];
        let query = self.query.as_ref().unwrap();
        query.run(bytemuck::cast_slice(&push), [WINDOWS as u32 / 64, 1, 1]).unwrap();
        self.results.read()
    }
}

/// What a scan finds of one channel in a part of the map: first column and row, then the ones behind the last.
fn scanned(
    side: usize,
    map: &[f32],
    channels: usize,
    part: [i32; 4],
    channel: usize,
    way: &Way,
) -> f32 {
    let [x0, y0, x1, y1] = part.map(|i| i as usize);
    let mut inside = Vec::with_capacity((x1 - x0) * (y1 - y0));
    for y in y0..y1 {
        let row = &map[(y * side + x0) * channels..(y * side + x1) * channels];
        inside.extend(row.iter().skip(channel).step_by(channels));
    }
    (way.of)(&inside)
}

/// A window, moved into the map whole.
fn inside(map: u32, window: [i32; 3]) -> [i32; 4] {
    let n = map as i32;
    let side = window[2].min(n);
    let [x, y] = [window[0], window[1]].map(|i| i.clamp(0, n - side));
    [x, y, x + side, y + side]
}

/// The part of the map that the nodes of a mip pyramid hold around a window.
fn around(levels: Levels, window: [i32; 3]) -> [i32; 4] {
    let n = levels.map as i32;
    let [x0, y0, x1, y1] = inside(levels.map, window);
    let level = levels.covering((x1 - x0) as u32);
    let down = |i: i32| i >> level << level;
    let up = |i: i32| (((i >> level) + 1) << level).min(n);
    [down(x0), down(y0), up(x1 - 1), up(y1 - 1)]
}

/// Every side from 1 to 300, each kind, of 1, 2 and 4 channels in turn; the least of each, the largest and the
/// mean of some. Of the sides a third on a slow driver.
#[test]
fn levels_and_windows_are_what_a_scan_finds() {
    let device = device();
    let mut runner = TestRunner::deterministic();
    // They are the same shaders at every side.
    let thinned = if device.leaves_to_others("two of three sides of n-buffers") { 3 } else { 1 };
    for (nth, way) in WAYS.iter().enumerate() {
        for channels in [1, 2, 4] {
            let mut machine = Machine::new(&device, way, channels);
            let mut tightness = [0.0f64; 3];
            // All sides over the three numbers of channels; fewer where only the way is another.
            let apart = if nth == 0 { 3 } else { 15 } * thinned;
            let first = 1 + [1, 2, 4].iter().position(|c| *c == channels).unwrap() as u32;
            for map in (first..=MOST).step_by(apart) {
                let count = (map * map) as usize * channels;
                let words = prop::collection::vec(-1e3..1e3f32, 257);
                let random = words.new_tree(&mut runner).unwrap().current();
                let values: Vec<f32> =
                    (0..count).map(|i| random[i * 7919 % 257] + (i % 31) as f32).collect();
                let side = map as i32;
                // Few large ones, which take the scan its time.
                let sides = prop_oneof![7 => 1..24.min(side + 8), 1 => 1..side + 8];
                let window = (-8..side + 8, -8..side + 8, sides);
                let windows = prop::collection::vec(window, WINDOWS);
                let windows: Vec<_> = windows.new_tree(&mut runner).unwrap().current();
                let windows: Vec<_> = windows.into_iter().map(|(x, y, s)| [x, y, s]).collect();
                let found_in = |part: [i32; 4], channel: usize| {
                    scanned(map as usize, &values, channels, part, channel, way)
                };
                // Of each window's channels; n-buffers and thirds hold the same.
                let exact: Vec<f32> = windows
                    .iter()
                    .filter(|_| !way.mean)
                    .flat_map(|&window| (0..channels).map(move |c| (inside(map, window), c)))
                    .map(|(part, channel)| found_in(part, channel))
                    .collect();
                for (kind_nth, kind) in
                    [Kind::NBuffer, Kind::Thirds, Kind::Mip].into_iter().enumerate()
                {
                    let levels = Levels { map, kind };
                    machine.build(levels, &values);
                    // All of the levels where that is quick, or the first time.
                    if map % 24 < 3 {
                        machine.check_levels(levels, &values);
                    }
                    if way.mean {
                        continue;
                    }
                    let results = machine.windows(levels, &windows);
                    for (i, &window) in windows.iter().enumerate() {
                        for channel in 0..channels {
                            let found = results[i * channels + channel];
                            let expected = if kind == Kind::Mip {
                                let part @ [x0, y0, x1, y1] = around(levels, window);
                                let s = f64::from(window[2].min(side));
                                tightness[kind_nth] += f64::from((x1 - x0) * (y1 - y0)) / (s * s);
                                found_in(part, channel)
                            } else {
                                tightness[kind_nth] += 1.0;
                                exact[i * channels + channel]
                            };
                            assert_eq!(found, expected, "{} of {levels:?}, {window:?}", way.name);
                        }
                    }
                }
            }
            let asked = f64::from(MOST) / apart as f64 * (WINDOWS * channels) as f64;
            if nth == 0 {
                println!(
                    "{channels} channels: texels held for each that was asked for: n-buffer {:.2}, \
                     thirds {:.2}, mip {:.2}",
                    tightness[0] / asked,
                    tightness[1] / asked,
                    tightness[2] / asked
                );
            }
        }
    }
}

/// Where nodes are kept: the shader's formula against sums, in the array and each in a place of its own.
#[test]
fn every_node_has_a_place_of_its_own() {
    let kinds = [Kind::NBuffer, Kind::Thirds, Kind::Mip];
    for map in (1..=300).chain([511, 512, 513]) {
        for kind in kinds {
            let levels = Levels { map, kind };
            let mut taken = vec![false; levels.texels() as usize];
            for level in 0..=levels.top() {
                let side = levels.side(level);
                for (y, x) in (0..side).flat_map(|y| (0..side).map(move |x| (y, x))) {
                    let [px, py, layer] = levels.place(level, [x, y]);
                    assert!(px < map && py < map && layer < levels.layers(), "{levels:?}, {level}");
                    let at = levels.index(level, [x, y]);
                    assert!(!std::mem::replace(&mut taken[at], true), "{levels:?}, {level}");
                }
            }
        }
    }
    let glue = "ivec4 described(int map, int kind, int level) { Levels l = Levels(map, kind); \
                return ivec4(side_of(l, level), place_of(l, level, ivec2(level))) + top_of(l); }";
    let mut function =
        Function::new("nbuffer/levels.glsl", "ivec4 described(int map, int kind, int level)")
            .glue(glue);
    for map in (1..=300).chain([511, 512, 513, 1000, 1024, 2047, 2048, 2187, 4095, 4096]) {
        for kind in kinds {
            for level in 0..=(Levels { map, kind }).top() {
                function = function.case((map, kind.code(), level));
            }
        }
    }
    function
        .bits(move |x| {
            let kind = kinds[x[1] as usize];
            let levels = Levels { map: x[0], kind };
            let [px, py, layer] = levels.place(x[2], [x[2]; 2]);
            [levels.side(x[2]), px, py, layer].map(|i| i + levels.top()).to_vec()
        })
        .check(&device());
}
