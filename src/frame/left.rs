//! What recorded frames have left in a node: pixels light by light, maps settings by settings.
//!
//! ```text
//!              settings 0   settings 1      a light has a layer of the visibility image;
//!   light 0  ┐                              settings have maps, which hold what the last of
//!   light 1  ├──  maps         maps         their lights has drawn
//!   light 2  ┘
//! ```
//! A host may plan every light before it records the first. A plan that counts on a light's maps would then
//! be refused, because the plans before it draw over them: so maps are not counted on while another light's
//! plan that draws them is still to be recorded.

use super::keep::{self, Keeping, Kept};

/// Which light a frame is for, and by which of the node's settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Whose {
    pub light: u32,
    pub settings: u32,
}

/// A light's layer of the visibility image.
#[derive(Clone, Copy, Debug, Default)]
struct Pixels {
    /// By which settings it was written, at which scene and view revision.
    revisions: Option<(u32, (u64, u64))>,
    /// Every one of them is lit.
    lit: bool,
}

/// The maps of one of the settings.
#[derive(Clone, Copy, Debug, Default)]
struct Maps {
    /// Whose they are, and what they are.
    of: Option<(u32, keep::Maps)>,
    /// The lights with a plan that draws them and is not recorded yet, a bit each.
    planned: u64,
}

/// What recorded frames have left in a node.
#[derive(Debug)]
pub(crate) struct Left {
    pixels: Vec<Pixels>,
    maps: Vec<Maps>,
}

impl Left {
    /// Nothing yet, for so many lights and settings.
    pub fn new(lights: u32, settings: usize) -> Self {
        Self {
            pixels: vec![Pixels::default(); lights as usize],
            maps: vec![Maps::default(); settings],
        }
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.pixels.fill(Pixels::default());
        self.maps.fill(Maps::default());
    }

    /// What a frame finds when it is recorded; nothing for a light or settings that do not exist.
    fn to(&self, whose: Whose) -> Kept {
        let Whose { light, settings } = whose;
        let pixels = self.pixels.get(light as usize).copied().unwrap_or_default();
        let maps = self.maps.get(settings as usize).copied().unwrap_or_default();
        Kept {
            maps: maps.of.filter(|of| of.0 == light).map(|of| of.1),
            pixels: pixels.revisions.filter(|by| by.0 == settings).map(|by| by.1),
            lit: pixels.lit,
        }
    }

    /// What a frame may count on when it is planned.
    pub fn for_plan(&self, whose: Whose) -> Kept {
        let kept = self.to(whose);
        let planned = self.maps.get(whose.settings as usize).map_or(0, |maps| maps.planned);
        let others = planned & !bit(whose.light);
        Kept { maps: kept.maps.filter(|_| others == 0), ..kept }
    }

    /// Notes a plan that was made.
    pub fn planned(&mut self, whose: Whose, keeping: &Keeping) {
        if let Some(maps) = self.maps.get_mut(whose.settings as usize)
            && keeping.makes_maps.is_some()
        {
            maps.planned |= bit(whose.light);
        }
    }

    /// Whether what a plan counts on is still there.
    pub fn agrees(&self, whose: Whose, keeping: &Keeping) -> bool {
        keeping.agrees(&self.to(whose))
    }

    /// Notes what a plan leaves that is being recorded.
    pub fn recorded(&mut self, whose: Whose, keeping: &Keeping) {
        let kept = keeping.behind(&self.to(whose));
        if let Some(pixels) = self.pixels.get_mut(whose.light as usize) {
            let revisions = kept.pixels.map(|pixels| (whose.settings, pixels));
            *pixels = Pixels { revisions, lit: kept.lit };
        }
        // Plans of this light that were dropped are not waited for any longer.
        self.maps.iter_mut().for_each(|maps| maps.planned &= !bit(whose.light));
        if let Some(maps) = self.maps.get_mut(whose.settings as usize)
            && keeping.makes_maps.is_some()
        {
            maps.of = kept.maps.map(|made| (whose.light, made));
        }
    }
}

/// A light's bit; a node has up to 64.
fn bit(light: u32) -> u64 {
    1u64.checked_shl(light).unwrap_or(0)
}
