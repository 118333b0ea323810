//! N-buffers: bounds or means over any window of a map, in a handful of fetches.
//!
//! ```text
//!   level 0        level 1          level 2           a window of 6 texels
//!   ·  ·  ·  ·     ┌──┬  ·  ·  ·    ┌─────┐· ·  ·     ┌────┬─┬────┐  four overlapping
//!   ·  ·  ·  ·     ├──┼──┐ ·  ·     │     │           │  a │ │ b  │  windows of level 2
//!   ·  ·  ·  ·     ·  └──┘ ·  ·     │     │ …         ├────┼─┼────┤  hold exactly it
//!   the map        2×2 at every     4×4 at every      │  c │ │ d  │
//!                  texel            texel             └────┴─┴────┘
//! ```
//! Level k holds the least, the largest or the mean over the 2^k × 2^k texels of a window that begins at each texel
//! (Décoret 2005), one or more values a texel; each level combines four values of the level before it. Two variants of
//! the query need less memory: powers of three instead of two (Curtis 2009 section 5.1), and mip pyramids, where a
//! window needs up to four nodes that hold up to 16 times as many texels as the window.
//!
//! **Borders.** Décoret's windows begin at their texel and stick out of the map at one end; Curtis 2009 section 3.5
//! centres them so that they hold more near the borders. Here every window lies within the map: level k has n + 1 −
//! 2^k of them a side, for a map of any side n, and a window across the border is moved inside. It then still holds
//! its part of the map, at no level less than a centred one, and takes less time to make: 0.6 of that of full levels
//! at 256 texels a side.
//!
//! **Memory.** The map and its levels are the layers of one image array, all of them as large as the map; mip levels
//! lie side by side in a second one. In storage buffers levels could be as small as they are, but a CPU that stands in
//! for a GPU reads four channels from an image five times faster: on lavapipe four reads and a write take 57 ns from
//! buffers and 8.5 ns from an image, and making the levels 11 to 18 ns a value. A shader that only copies a texel
//! takes 6 to 7.5 ns there, and the memory alone 1.6 to 2.6.
//!
//! `glsl/nbuffer/levels.glsl` leaves the type of a value to the including shader. The least of a channel is minus the
//! largest of its negative, so that one `max` of a `vec4` makes all four of a technique's bounds.

pub mod twin;

use crate::knob::choices;

/// The kind of windows of the levels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kind {
    /// 2^k × 2^k texels, one beginning at every texel.
    #[default]
    NBuffer,
    /// 3^k × 3^k texels, one beginning at every texel.
    Thirds,
    /// 2^k × 2^k texels, side by side.
    Mip,
}

choices! { Kind: "n-buffer" => NBuffer, "thirds" => Thirds, "mip" => Mip }

impl Kind {
    /// The kind's number in shaders.
    pub fn code(self) -> i32 {
        match self {
            Self::NBuffer => 0,
            Self::Thirds => 1,
            Self::Mip => 2,
        }
    }
}

/// The layout of a map's levels in memory (`levels.glsl`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Levels {
    /// The map's side in texels, 1 to 4096.
    pub map: u32,
    /// The kind of windows.
    pub kind: Kind,
}

impl Levels {
    /// A window's side in texels.
    pub fn window(&self, level: u32) -> u32 {
        match self.kind {
            Kind::Thirds => 3u32.pow(level),
            Kind::NBuffer | Kind::Mip => 1 << level,
        }
    }

    /// The number of windows along a side of a level.
    pub fn side(&self, level: u32) -> u32 {
        match self.kind {
            Kind::Mip => ((self.map - 1) >> level) + 1,
            Kind::NBuffer | Kind::Thirds => self.map + 1 - self.window(level),
        }
    }

    /// The last level's number.
    pub fn top(&self) -> u32 {
        match self.kind {
            Kind::NBuffer => self.map.ilog2(),
            Kind::Thirds => self.map.ilog(3),
            Kind::Mip => self.map.next_power_of_two().ilog2(),
        }
    }

    /// The layers of an image array as large as the map that hold the map and all its levels.
    pub fn layers(&self) -> u32 {
        match self.kind {
            Kind::NBuffer | Kind::Thirds => self.top() + 1,
            Kind::Mip => self.top().min(1) + 1,
        }
    }

    /// The texel and the layer at which such an array keeps a node.
    pub fn place(&self, level: u32, [x, y]: [u32; 2]) -> [u32; 3] {
        match self.kind {
            Kind::NBuffer | Kind::Thirds => [x, y, level],
            Kind::Mip if level < 2 => [x, y, level],
            Kind::Mip => {
                let above = (2..level).map(|k| self.map.next_power_of_two() >> k).sum::<u32>();
                [x + self.side(1), y + above, 1]
            }
        }
    }

    /// The index of that texel in a list of the array's texels: layer by layer, each row by row.
    pub fn index(&self, level: u32, node: [u32; 2]) -> usize {
        let [x, y, layer] = self.place(level, node).map(|i| i as usize);
        let side = self.map as usize;
        (layer * side + y) * side + x
    }

    /// The number of texels of that array, the map's own among them.
    pub fn texels(&self) -> u64 {
        u64::from(self.map).pow(2) * u64::from(self.layers())
    }

    /// The level whose windows cover a window of `side` texels.
    pub fn covering(&self, side: u32) -> u32 {
        match self.kind {
            Kind::NBuffer => side.ilog2(),
            Kind::Thirds => side.ilog(3),
            Kind::Mip => side.next_power_of_two().ilog2(),
        }
    }
}
