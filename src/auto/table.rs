//! The error and time of every candidate in every view of the report, as measured on one device.

use super::{CANDIDATES, FEATURES, Features};
use std::sync::OnceLock;

/// The table's text, which `cargo bench --bench accuracy_cost -- --choices` measures and `--write-choices` copies here.
const TEXT: &str = include_str!("table.csv");

/// The columns of the text.
pub const COLUMNS: &str = "scene,light,triangles,size,penumbra,edges,layers,both,open,contact,technique,settings,\
                           error,noise,maps_ms,pixels_ms";

/// The first cell of the line with the times of a small frame: milliseconds of its maps, and of its pixels.
pub const PROBE: &str = "probe";

/// The number of pixels of each view's image.
pub const PIXELS: f64 = 512.0 * 384.0;

/// The error and time of one candidate in one view.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measured {
    /// The mean error of the visible fraction over the pixels in shadow and penumbra, 0 to 1, less the noise of the truth.
    pub error: f64,
    /// The time of the passes in light space, milliseconds.
    pub maps_ms: f64,
    /// The time of the passes over [`PIXELS`] pixels, milliseconds.
    pub pixels_ms: f64,
}

/// A scene of the report under one light, with the measurements of all candidates.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// The names of scene and light.
    pub name: [String; 2],
    /// The features of its situation.
    pub features: Features,
    /// The number of its occluders' triangles.
    pub triangles: f64,
    /// The measurements, in the order of [`CANDIDATES`].
    pub measured: Vec<Measured>,
}

/// The measurements of all views.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// The views, in the order in which they were measured.
    pub views: Vec<View>,
    /// The times of a small frame on the same device, to which those of other devices are compared.
    pub probe: Measured,
}

impl Table {
    /// The table that comes with the crate, read on first use.
    pub fn own() -> &'static Self {
        static OWN: OnceLock<Table> = OnceLock::new();
        OWN.get_or_init(|| Self::read(TEXT))
    }

    /// Reads a table from text. Lines that are not measurements of a candidate are left out, and so are views without
    /// measurements of all candidates.
    pub fn read(text: &str) -> Self {
        let mut views: Vec<View> = Vec::new();
        let mut probe = Measured { error: 0.0, maps_ms: 1.0, pixels_ms: 1.0 };
        for line in text.lines() {
            let cells: Vec<&str> = line.split(',').collect();
            if let [PROBE, maps, pixels] = cells[..]
                && let (Ok(maps_ms), Ok(pixels_ms)) = (maps.parse(), pixels.parse())
            {
                probe = Measured { maps_ms, pixels_ms, ..probe };
            }
            let Some((name, features, triangles, candidate, measured)) = row(&cells) else {
                continue;
            };
            if views.last().is_none_or(|v| v.name != name) {
                views.push(View { name, features, triangles, measured: Vec::new() });
            }
            if let Some(view) = views.last_mut()
                && view.measured.len() == candidate
            {
                view.measured.push(measured);
            }
        }
        views.retain(|v| v.measured.len() == CANDIDATES.len());
        Self { views, probe }
    }

    /// The table without the views of one scene, to predict that scene from the others.
    pub fn without(&self, scene: &str) -> Self {
        let others = self.views.iter().filter(|v| v.name[0] != scene);
        Self { views: others.cloned().collect(), probe: self.probe }
    }
}

type Row = ([String; 2], Features, f64, usize, Measured);

fn row(cells: &[&str]) -> Option<Row> {
    let number = |i: usize| cells.get(i)?.parse::<f64>().ok();
    let mut values = [0.0; FEATURES.len()];
    for (i, value) in values.iter_mut().enumerate() {
        *value = number(3 + i)?;
    }
    let (technique, words) = (*cells.get(10)?, *cells.get(11)?);
    let candidate = CANDIDATES.iter().position(|c| c.technique == technique && c.words == words)?;
    let measured = Measured {
        error: (number(12)? - number(13)?).max(0.0),
        maps_ms: number(14)?,
        pixels_ms: number(15)?,
    };
    let name = [cells.first()?.to_string(), cells.get(1)?.to_string()];
    Some((name, Features::from_values(values), number(2)?, candidate, measured))
}
