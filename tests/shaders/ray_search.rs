//! The searches of ray marching alone, on maps and rays of all kinds, against a walk over every texel.

use antumbra::stages::nbuffer::twin::Values;
use antumbra::stages::nbuffer::{Kind, Levels};
use antumbra::techniques::ray_march::twin::{Column, Place, bounds_of, meets};
use antumbra_harness::{ComputeProgram, HeadlessDevice, HostBuffer};
use antumbra_tests::compile::try_compile;
use antumbra_tests::device;
use ash::vk;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

/// Rays a map.
const RAYS: usize = 2048;

/// What stands on a map.
#[derive(Clone, Copy, Debug)]
enum Field {
    /// Few texels with something, anywhere.
    Dust,
    /// A bumpy surface with matter below it.
    Hills,
    /// Sheets and thin plates that lean.
    Plates,
    /// Two layers of blocks.
    Blocks,
}

/// A column of a field, by four random numbers and its place.
fn column(field: Field, [a, b, c, d]: [f32; 4], x: u32, y: u32, side: u32) -> Column<f32> {
    let at = |i: u32| i as f32 / side as f32;
    let (u, v) = (at(x), at(y));
    match field {
        Field::Dust if a < 0.02 => [0.3 + 0.6 * b, 0.3 + 0.6 * b * c, 0.0, 0.0],
        Field::Dust => [0.0; 4],
        Field::Hills => {
            let top = 0.4 + 0.2 * (7.0 * u).sin() * (5.0 * v).cos() + 0.02 * a;
            [top, (0.2 + 0.05 * b).min(top - 0.01), 0.0, 0.0]
        }
        Field::Plates if (x / 9 + y / 7).is_multiple_of(2) => {
            let top = 0.3 + 0.4 * u;
            [top, top - 0.4 / side as f32, 0.0, 0.0]
        }
        Field::Plates if a < 0.3 => [0.5, 0.5, 0.25 + 0.1 * b, 0.25],
        Field::Plates => [0.0; 4],
        Field::Blocks => {
            let first = if (x / 5 + 2 * (y / 5)).is_multiple_of(3) { [0.7, 0.6] } else { [0.0; 2] };
            let second = if (x / 6 + y / 6).is_multiple_of(2) {
                [0.4 + 0.01 * c, 0.3 * d]
            } else {
                [0.0; 2]
            };
            match (first, second) {
                ([0.0, _], [top, bottom]) => [top, bottom, 0.0, 0.0],
                ([top, bottom], [second, end]) => [top, bottom, second, end],
            }
        }
    }
}

/// The piece of matter between the two of a column: of most columns with two.
fn between([_, end, second, _]: Column<f32>, n: f32) -> [f32; 2] {
    let gap = end - second;
    match second > 0.0 && n < 0.7 {
        true => [second + gap * (0.3 + 0.6 * n), second + gap * 0.3],
        false => [0.0; 2],
    }
}

/// One ray: where its receiver is, its plane, its slope, where it begins and ends; as the shader takes it.
#[derive(Clone, Copy, Debug)]
struct Case {
    words: [f32; 12],
}

impl Case {
    fn place(&self) -> Place {
        let [x, y, w, n_x, n_y, n_0, c, margin, ..] = self.words.map(f64::from);
        Place { t: [x, y], w, n: [n_x, n_y], n_0, c, margin }
    }
}

fn cases(side: u32) -> impl Strategy<Value = Case> {
    let side = side as f32;
    let t = -0.1 * side..1.1 * side;
    // Shallow and steep ones, along rows and columns too.
    let slope = prop_oneof![3 => -4.0 * side..4.0 * side, 1 => -8.0f32..8.0, 1 => Just(0.0f32)];
    let plane = prop_oneof![
        1 => Just([0.0f32, 0.0, 1.0, 0.0]),
        1 => (-0.5..0.5f32, -0.5..0.5f32, -1.0..1.0f32, -2.0..1.0f32)
            .prop_map(move |(x, y, z, c)| [x / side, y / side, z, c]),
    ];
    (t.clone(), t, 0.0..0.6f32, plane, slope.clone(), slope, 0.0..0.3f32, 0.1..1.0f32).prop_map(
        |(x, y, w, [n_x, n_y, n_0, c], g_x, g_y, start, length)| Case {
            words: [x, y, w, n_x, n_y, n_0, c, 0.01, g_x, g_y, start, start + length],
        },
    )
}

struct Machine {
    windows: HostBuffer,
    between: HostBuffer,
    rays: HostBuffer,
    hits: HostBuffer,
    program: ComputeProgram,
}

const MOST: u32 = 200;

impl Machine {
    fn new(device: &HeadlessDevice) -> Self {
        let storage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let buffer = |name, words: usize| {
            HostBuffer::with_data(device, name, &vec![0u32; words], storage).unwrap()
        };
        let most = [Kind::NBuffer, Kind::Thirds, Kind::Mip]
            .map(|kind| Levels { map: MOST, kind }.texels() as usize);
        let windows = buffer("windows", 4 * most.into_iter().max().unwrap());
        let between = buffer("between", 2 * (MOST * MOST) as usize);
        let rays = buffer("rays", 12 * RAYS);
        let hits = buffer("hits", RAYS);
        let source = "#version 450\n#extension GL_GOOGLE_include_directive : require\n\
            layout(local_size_x = 64) in;\n\
            #define SEARCH\n\
            #include \"ray_march/column.glsl\"\n\
            layout(set = 0, binding = 0, std430) readonly buffer Windows { vec4 windows[]; };\n\
            layout(set = 0, binding = 1, std430) readonly buffer Rays { vec4 rays[]; };\n\
            layout(set = 0, binding = 2, std430) buffer Hits { uint hits[]; };\n\
            layout(set = 0, binding = 3, std430) readonly buffer Between { vec2 between[]; };\n\
            layout(push_constant) uniform Push { int map; int kind; int linear; } push;\n\
            bool seen(vec2 t, float w) { return false; }\n\
            vec2 middle_at(ivec2 p) { return between[p.y * push.map + p.x]; }\n\
            vec4 held_at(Levels l, int level, ivec2 node) {\n\
                ivec3 p = place_of(l, level, node);\n\
                return windows[(p.z * l.map + p.y) * l.map + p.x];\n\
            }\n\
            void main() {\n\
                uint i = gl_GlobalInvocationID.x;\n\
                vec4 a = rays[3u * i];\n\
                vec4 b = rays[3u * i + 1u];\n\
                vec4 c = rays[3u * i + 2u];\n\
                Place p = Place(a.xy, a.z, vec2(a.w, b.x), b.y, b.z, b.w);\n\
                Ray ray = over_map(p, Ray(c.xy, c.z, c.w), push.map);\n\
                float s;\n\
                int turns = TURNS;\n\
                bool hit = ray.start <= ray.end && (push.linear != 0\n\
                    ? search_linear(p, ray, Levels(push.map, push.kind), s)\n\
                    : search_hierarchical(p, ray, Levels(push.map, push.kind), false, turns, s));\n\
                hits[i] = uint(hit);\n\
            }\n";
        let spirv = try_compile("search.comp", source).unwrap_or_else(|log| panic!("{log}"));
        let buffers = [&windows, &rays, &hits, &between];
        let program = ComputeProgram::new(device, &spirv, 12, &buffers).unwrap();
        Self { windows, between, rays, hits, program }
    }

    fn hits(
        &mut self,
        levels: Levels,
        (columns, between): (&[Column<f32>], &[[f32; 2]]),
        rays: &[Case],
        linear: bool,
    ) -> Vec<u32> {
        let map = columns.iter().map(|c| bounds_of(*c)).collect();
        let largest = |parts: &[[f32; 4]]| {
            std::array::from_fn(|i| parts.iter().map(|p| p[i]).fold(f32::NEG_INFINITY, f32::max))
        };
        let mut made = Values::new(levels, map, largest);
        made.of_level[0] = columns.to_vec();
        self.windows.write(&made.as_array([0.0; 4])).unwrap();
        self.between.write(between.as_flattened()).unwrap();
        self.rays.write(&rays.iter().flat_map(|r| r.words).collect::<Vec<f32>>()).unwrap();
        let push = [levels.map as i32, levels.kind.code(), i32::from(linear)];
        self.program.run(bytemuck::cast_slice(&push), [(RAYS / 64) as u32, 1, 1]).unwrap();
        self.hits.read()
    }
}

/// By windows of any kind a ray is stopped exactly where the walk finds that it is, but for rays that
/// touch something by less than rounding. The linear search is that of steps, which it halves to an
/// eighth of a texel: it may be wrong about rays that come that near to a column's rim.
#[test]
fn searches_find_what_a_walk_finds() {
    let mut machine = Machine::new(&device());
    let mut runner = TestRunner::deterministic();
    for field in [Field::Dust, Field::Hills, Field::Plates, Field::Blocks] {
        let (mut stopped, mut near, mut of, mut linear_wrong) = (0, 0, 0, 0);
        for side in [1, 2, 3, 5, 8, 13, 31, 64, 100, 127, 200] {
            let texels = (side * side) as usize;
            let numbers = prop::collection::vec(prop::array::uniform4(0.0..1.0f32), texels);
            let numbers = numbers.new_tree(&mut runner).unwrap().current();
            let columns: Vec<Column<f32>> = numbers
                .iter()
                .zip(0u32..)
                .map(|(n, i)| column(field, *n, i % side, i / side, side))
                .collect();
            let pieces: Vec<[f32; 2]> =
                columns.iter().zip(&numbers).map(|(c, n)| between(*c, n[3])).collect();
            let rays = prop::collection::vec(cases(side), RAYS);
            let rays = rays.new_tree(&mut runner).unwrap().current();
            let exact: Vec<Column<f64>> = columns.iter().map(|c| c.map(f64::from)).collect();
            let exact_pieces: Vec<[f64; 2]> = pieces.iter().map(|p| p.map(f64::from)).collect();
            let exact = (&exact[..], &exact_pieces[..]);
            let walked: Vec<(bool, f64)> = rays
                .iter()
                .map(|r| {
                    let [g_x, g_y, start, end] = [8, 9, 10, 11].map(|i| f64::from(r.words[i]));
                    meets(exact, side, &r.place(), [g_x, g_y], start, end)
                })
                .collect();
            for kind in [Kind::NBuffer, Kind::Thirds, Kind::Mip] {
                let hits =
                    machine.hits(Levels { map: side, kind }, (&columns, &pieces), &rays, false);
                for ((hit, (expected, nearest)), ray) in hits.iter().zip(&walked).zip(&rays) {
                    of += 1;
                    stopped += u32::from(*expected);
                    if (*hit == 1) != *expected {
                        near += 1;
                        assert!(
                            *nearest < 2e-4,
                            "{field:?}, {side}, {kind:?}: {hit} where the walk has {expected}, by {nearest:.1e}: {ray:?}"
                        );
                    }
                }
            }
            let levels = Levels { map: side, kind: Kind::Mip };
            let hits = machine.hits(levels, (&columns, &pieces), &rays, true);
            linear_wrong += hits.iter().zip(&walked).filter(|(h, (e, _))| (**h == 1) != *e).count();
        }
        println!(
            "{field:?}: {stopped} of {of} rays are stopped; by windows {near} that touch something are \
             otherwise; linear {:.2} %",
            300.0 * linear_wrong as f64 / f64::from(of)
        );
        assert!(stopped * 50 > of && stopped * 20 < 19 * of, "rays of one kind only");
        assert!(near * 1000 < of, "{near} of {of}");
        assert!(300 * linear_wrong < 4 * of as usize, "{linear_wrong}");
    }
}
