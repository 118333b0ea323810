//! The error and time of every candidate in every view of the report, as measured on one device.

use super::shafts::shaft_work;
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
    /// The mean error of the visible fraction over the pixels in shadow and penumbra, 0 to 1, less the noise of the
    /// truth.
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

/// One candidate over all views.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Over {
    /// The largest error.
    pub worst: f64,
    /// The geometric mean of the pixels' times over [`shaft_work`], milliseconds.
    pub pixels_ms: f64,
}

impl Over {
    fn of(views: &[View], candidate: usize) -> Self {
        let measured = || views.iter().map(|v| (v, &v.measured[candidate]));
        let log = |(v, m): (&View, &Measured)| (m.pixels_ms / v.shaft_work()).ln();
        let mean = measured().map(log).sum::<f64>() / views.len().max(1) as f64;
        let worst = measured().map(|(_, m)| m.error).fold(0.0, f64::max);
        Self { worst, pixels_ms: mean.exp() }
    }
}

impl View {
    /// [`shaft_work`] of the view.
    pub(super) fn shaft_work(&self) -> f64 {
        shaft_work(&self.features)
    }
}

/// The measurements of all views.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// The views, in the order in which they were measured.
    pub views: Vec<View>,
    /// The times of a small frame on the same device, to which those of other devices are compared.
    pub probe: Measured,
    /// Each candidate over all views, in the order of [`CANDIDATES`].
    pub(super) over: Vec<Over>,
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
        Self::parse(text).0
    }

    /// A table, and what was left out of it: lines with their numbers, and views.
    fn parse(text: &str) -> (Self, Vec<String>) {
        let mut views: Vec<View> = Vec::new();
        let mut probe = Measured { error: 0.0, maps_ms: 1.0, pixels_ms: 1.0 };
        let mut left_out = Vec::new();
        for (number, line) in (1..).zip(text.lines()).filter(|(_, line)| *line != COLUMNS) {
            let cells: Vec<&str> = line.split(',').collect();
            if let [PROBE, maps, pixels] = cells[..]
                && let (Ok(maps_ms), Ok(pixels_ms)) = (maps.parse(), pixels.parse())
            {
                probe = Measured { maps_ms, pixels_ms, ..probe };
                continue;
            }
            let Some((name, features, triangles, candidate, measured)) = row(&cells) else {
                left_out.push(format!("line {number}: {line}"));
                continue;
            };
            if views.last().is_none_or(|v| v.name != name) {
                views.push(View { name, features, triangles, measured: Vec::new() });
            }
            match views.last_mut() {
                Some(view) if view.measured.len() == candidate => view.measured.push(measured),
                _ => left_out.push(format!("line {number}, out of its place: {line}")),
            }
        }
        let (views, torn): (Vec<View>, Vec<View>) =
            views.into_iter().partition(|v| v.measured.len() == CANDIDATES.len());
        left_out
            .extend(torn.iter().map(|v| format!("{}, which lacks candidates", v.name.join(", "))));
        (Self::of(views, probe), left_out)
    }

    /// The table without the views of one scene, to predict that scene from the others.
    pub fn without(&self, scene: &str) -> Self {
        let others = self.views.iter().filter(|v| v.name[0] != scene);
        Self::of(others.cloned().collect(), self.probe)
    }

    fn of(views: Vec<View>, probe: Measured) -> Self {
        let over = (0..CANDIDATES.len()).map(|candidate| Over::of(&views, candidate)).collect();
        Self { views, probe, over }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_of_the_committed_table_is_read() {
        let (table, left_out) = Table::parse(TEXT);
        assert!(left_out.is_empty(), "{left_out:#?}");
        assert!(!table.views.is_empty() && table.probe.maps_ms != 1.0);
    }

    #[test]
    fn a_line_that_cannot_be_read_is_named_with_its_number() {
        let lines: Vec<&str> = TEXT.lines().collect();
        let names = |changed: Vec<&str>| Table::parse(&changed.join("\n")).1.join("\n");
        let mut torn = lines.clone();
        torn[3] = "card,small,torn";
        assert!(names(torn).starts_with("line 4: card,small,torn\n"));
        let mut swapped = lines.clone();
        swapped.swap(3, 4);
        assert!(names(swapped).starts_with("line 4, out of its place: "));
        assert!(names(lines[..lines.len() - 1].to_vec()).ends_with("which lacks candidates"));
    }
}
