//! What every candidate did in every view of the report: its error, and its time on the device that measured it.

use super::likeness::PARTS;
use super::{CANDIDATES, Likeness};
use std::sync::OnceLock;

/// `cargo bench --bench accuracy_cost -- --choices` measures it and `--write-choices` copies it here.
const TEXT: &str = include_str!("table.csv");

/// The columns of the text.
pub const COLUMNS: &str = "scene,light,triangles,size,penumbra,edges,layers,both,open,contact,technique,settings,\
                           error,noise,maps_ms,pixels_ms";

/// What the line begins with that tells what a small frame took: milliseconds of its maps, and of its pixels.
pub const PROBE: &str = "probe";

/// The pixels of each view.
pub const PIXELS: f64 = 512.0 * 384.0;

/// What one candidate did in one view.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measured {
    /// The mean error over shadow and penumbra, a visible fraction, less what the truth's own noise makes of it.
    pub error: f64,
    /// Milliseconds of the passes in light space.
    pub maps_ms: f64,
    /// Milliseconds of the passes at [`PIXELS`] pixels.
    pub pixels_ms: f64,
}

/// A scene under a light.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Scene and light.
    pub name: [String; 2],
    /// What of it decides errors.
    pub likeness: Likeness,
    /// Triangles of its occluders.
    pub triangles: f64,
    /// In the order of [`CANDIDATES`].
    pub measured: Vec<Measured>,
}

/// All views.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// In the order in which they were measured.
    pub views: Vec<View>,
    /// What a small frame took on the same device, by which others are compared with it.
    pub probe: Measured,
}

impl Table {
    /// The project's own, read at its first use.
    pub fn own() -> &'static Self {
        static OWN: OnceLock<Table> = OnceLock::new();
        OWN.get_or_init(|| Self::read(TEXT))
    }

    /// Reads a table; lines that are no measurement of a candidate are left out, as are views that lack one.
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
            let Some((name, likeness, triangles, candidate, measured)) = row(&cells) else {
                left_out.push(format!("line {number}: {line}"));
                continue;
            };
            if views.last().is_none_or(|v| v.name != name) {
                views.push(View { name, likeness, triangles, measured: Vec::new() });
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
        (Self { views, probe }, left_out)
    }

    /// The same without one scene, to see what the others say of it.
    pub fn without(&self, scene: &str) -> Self {
        let others = self.views.iter().filter(|v| v.name[0] != scene);
        Self { views: others.cloned().collect(), probe: self.probe }
    }
}

type Row = ([String; 2], Likeness, f64, usize, Measured);

fn row(cells: &[&str]) -> Option<Row> {
    let number = |i: usize| cells.get(i)?.parse::<f64>().ok();
    let mut parts = [0.0; PARTS.len()];
    for (i, part) in parts.iter_mut().enumerate() {
        *part = number(3 + i)?;
    }
    let (technique, words) = (*cells.get(10)?, *cells.get(11)?);
    let candidate = CANDIDATES.iter().position(|c| c.technique == technique && c.words == words)?;
    let measured = Measured {
        error: (number(12)? - number(13)?).max(0.0),
        maps_ms: number(14)?,
        pixels_ms: number(15)?,
    };
    let name = [cells.first()?.to_string(), cells.get(1)?.to_string()];
    Some((name, Likeness::from_parts(parts), number(2)?, candidate, measured))
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
