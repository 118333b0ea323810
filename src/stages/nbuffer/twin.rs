//! The CPU twin of `glsl/nbuffer/levels.glsl`, for any type of value and any way to combine two.

use super::{Kind, Levels};

/// A map's values and those of its levels.
#[derive(Clone, Debug)]
pub struct Values<V> {
    /// The layout of the levels.
    pub levels: Levels,
    /// Level 0 and then each level's values, row by row.
    pub of_level: Vec<Vec<V>>,
}

impl<V: Copy> Values<V> {
    /// Builds every level of a square map, which is given row by row: `combine` makes one value of the values of a
    /// window's parts (fewer than four where the window sticks out of the map).
    pub fn new(levels: Levels, map: Vec<V>, combine: impl Fn(&[V]) -> V) -> Self {
        let fan = if levels.kind == Kind::Thirds { 3 } else { 2 };
        let mut of_level = vec![map];
        for level in 1..=levels.top() {
            let (apart, times) = match levels.kind {
                Kind::Mip => (1, 2),
                Kind::NBuffer | Kind::Thirds => (levels.window(level - 1), 1),
            };
            let end = levels.side(level - 1);
            let finer = &of_level[level as usize - 1];
            let side = levels.side(level);
            let mut values = Vec::with_capacity((side * side) as usize);
            let mut parts = Vec::with_capacity((fan * fan) as usize);
            for y in 0..side {
                for x in 0..side {
                    let places = (0..fan * fan)
                        .map(|i| [times * x + apart * (i % fan), times * y + apart * (i / fan)])
                        .filter(|at| at.iter().all(|i| *i < end));
                    parts.clear();
                    parts.extend(places.map(|[x, y]| finer[(y * end + x) as usize]));
                    values.push(combine(&parts));
                }
            }
            of_level.push(values);
        }
        Self { levels, of_level }
    }

    /// The texels of the image array that holds the levels, layer by layer; `none` fills texels without a node.
    pub fn as_array(&self, none: V) -> Vec<V> {
        let mut texels = vec![none; self.levels.texels() as usize];
        for (level, values) in (0u32..).zip(&self.of_level) {
            let side = self.levels.side(level);
            for (i, value) in (0u32..).zip(values) {
                texels[self.levels.index(level, [i % side, i / side])] = *value;
            }
        }
        texels
    }

    /// The values of the nodes that cover a square window, which is moved into the map first.
    pub fn covering(&self, first: [i32; 2], side: u32) -> Vec<V> {
        let Levels { map, kind } = self.levels;
        let side = side.min(map);
        let first = first.map(|x| x.clamp(0, (map - side) as i32) as u32);
        let level = self.levels.covering(side);
        let along = |first: u32| -> Vec<u32> {
            match kind {
                Kind::Mip => (first >> level..=(first + side - 1) >> level).collect(),
                Kind::NBuffer | Kind::Thirds => {
                    let window = self.levels.window(level);
                    let last = first + side - window;
                    (first..last).step_by(window as usize).chain([last]).collect()
                }
            }
        };
        let (columns, row) = (along(first[0]), self.levels.side(level));
        let nodes = along(first[1]).into_iter().flat_map(|y| columns.iter().map(move |x| (*x, y)));
        nodes.map(|(x, y)| self.of_level[level as usize][(y * row + x) as usize]).collect()
    }
}
