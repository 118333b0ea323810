//! What was measured, one JSON line each, written as it comes.
//!
//! The file begins with what the run is: options, commit, device. Rows follow, and behind the rows of
//! each group a line that says it is whole. A run that is killed, or whose disk fills, leaves a file
//! whose whole lines are all good; a torn last line is cut off, and groups without their end are
//! measured again. A file of another run is set aside, never written over.

use crate::Problem;
use antumbra::truth::ErrorSummary;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// What a run is; runs that differ in any of it do not share rows.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Header {
    pub command: String,
    /// git's commit, with `-dirty` and a hash of the program where the tree has changes.
    pub commit: String,
    pub driver: String,
    /// Whether the run is the quick one.
    pub quick: bool,
    /// Width and height of the views.
    pub extent: [u32; 2],
    /// Rays a pixel of the traced truth.
    pub truth_rays: u32,
    /// Names, sizes and dates of the scenes of one's own.
    pub scenes: Vec<String>,
}

/// The errors of an image, in visible fractions.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    #[serde(flatten)]
    pub summary: ErrorSummary,
    /// The mean of the same pixels' |error|, weighed by the light's unshadowed irradiance there; none in rows of runs
    /// that did not measure it.
    #[serde(default)]
    pub seen_error: Option<f64>,
    /// How still points stay, where a camera moves.
    #[serde(flatten, default)]
    pub changes: Option<Box<Changes>>,
    /// Mean FLIP of the shaded images, 0..1; none where the pixels are no picture.
    pub flip: Option<f64>,
    /// The standard error of one penumbra pixel of the truth; 0 where it is exact.
    pub truth_noise: f64,
    /// What the truth's noise alone would add up to in the summary's `mean_abs_error`.
    pub noise_floor: f64,
}

/// How much the visible fractions of still points change from a frame to the next, as `stability` defines them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Changes {
    /// How many pairs of a point in one frame and in the next there are.
    pub pairs: usize,
    pub change_mean: f64,
    /// The 99th and the 99.9th percentile.
    pub change_p99: f64,
    pub change_p999: f64,
    pub change_worst: f64,
    pub truth_change_mean: f64,
    pub truth_change_p99: f64,
    pub truth_change_p999: f64,
    pub truth_change_worst: f64,
    pub error_change_mean: f64,
    pub error_change_p99: f64,
    pub error_change_p999: f64,
    pub error_change_worst: f64,
}

/// The times of a frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Times {
    /// First quartile, median and third quartile of submit to fence, or of tracing, in ms.
    pub frame_ms: [f64; 3],
    /// How many frames those are of; the warm-up is not counted.
    pub frames: usize,
    /// Median ms of each pass by timestamps; empty where there are none.
    pub passes: Vec<(String, f64)>,
    /// Median µs of recording.
    pub record_us: f64,
    /// The memory of the node, 0 for what runs on the processor.
    pub gpu_bytes: u64,
}

/// How a row ended.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    Measured {
        errors: Errors,
        times: Times,
    },
    /// The crate does not have the technique yet.
    #[default]
    NotThere,
    /// It was tried and failed, for this reason.
    Failed(String),
}

/// One row of the report.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Which study it belongs to: `matrix`, or the sweep's name.
    pub study: String,
    pub scene: String,
    /// The light's name: small, medium, large.
    pub light: String,
    /// The light's width and height in metres; 0 of a sun, which has an angle and no size.
    pub light_m: [f64; 2],
    pub triangles: usize,
    /// Width and height of the image.
    pub extent: [u32; 2],
    /// Whether the node was lent the normals of triangles.
    #[serde(default)]
    pub normals: bool,
    /// The technique's name, as on a command line.
    pub technique: String,
    /// The curve that the row is a point of.
    pub curve: String,
    /// The settings, as words of a command line.
    pub settings: String,
    /// The value that is swept; its meaning is the study's.
    pub x: f64,
    pub outcome: Outcome,
}

impl Row {
    /// Errors and times, where it was measured.
    pub fn measured(&self) -> Option<(&Errors, &Times)> {
        match &self.outcome {
            Outcome::Measured { errors, times } => Some((errors, times)),
            _ => None,
        }
    }

    /// Mean |error|, where it was measured.
    pub fn mean(&self) -> Option<f64> {
        Some(self.measured()?.0.summary.mean_abs_error)
    }

    /// Mean |error| weighed by unshadowed irradiance, where it was measured.
    pub fn seen(&self) -> Option<f64> {
        self.measured()?.0.seen_error
    }

    /// Median ms of a frame, where it was measured.
    pub fn ms(&self) -> Option<f64> {
        Some(self.measured()?.1.frame_ms[1])
    }
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Line {
    Run(Header),
    Row {
        group: String,
        row: Box<Row>,
    },
    /// A group is whole with its last `rows` rows, and took this many seconds.
    Whole {
        group: String,
        rows: usize,
        seconds: f64,
    },
}

/// The contents of a file.
#[derive(Default)]
struct Contents {
    header: Option<Header>,
    rows: BTreeMap<String, Vec<Row>>,
    /// The groups that are whole, in the order they were measured.
    whole: Vec<String>,
}

impl Contents {
    fn take(&mut self, line: Line) {
        match line {
            Line::Run(header) => self.header = Some(header),
            Line::Row { group, row } => self.rows.entry(group).or_default().push(*row),
            Line::Whole { group, rows, .. } => {
                // Rows before those are of a run that was killed in the middle of the group.
                let all = self.rows.entry(group.clone()).or_default();
                if let Some(torn) = all.len().checked_sub(rows) {
                    all.drain(..torn);
                    self.whole.push(group);
                }
            }
        }
    }

    /// The contents of a file's whole lines, without groups that are not whole, and how many bytes they take.
    fn read(text: &[u8]) -> (Self, usize) {
        let (mut contents, mut good) = (Self::default(), 0);
        for line in text.split_inclusive(|b| *b == b'\n').filter(|line| line.ends_with(b"\n")) {
            good += line.len();
            // A line that is whole and still not understood costs its group, which is measured again.
            serde_json::from_slice(line).into_iter().for_each(|line| contents.take(line));
        }
        contents.rows.retain(|group, _| contents.whole.contains(group));
        (contents, good)
    }
}

/// The file and what is in it.
pub struct Store {
    file: File,
    path: PathBuf,
    contents: Contents,
}

impl Store {
    /// Opens the file of a run, or begins it.
    pub fn open(path: &Path, header: &Header) -> Result<Self, Problem> {
        let problem = Problem::of::<std::io::Error>(path.display());
        let text = if path.exists() { std::fs::read(path).map_err(&problem)? } else { Vec::new() };
        let (mut contents, mut good) = Contents::read(&text);
        let same = contents.header.as_ref() == Some(header);
        if !same && good > 0 {
            std::fs::rename(path, path.with_extension("earlier.jsonl")).map_err(&problem)?;
        }
        if !same {
            (contents, good) = (Contents::default(), 0);
        }
        let open = OpenOptions::new().create(true).truncate(false).write(true).open(path);
        let mut file = open.map_err(&problem)?;
        file.set_len(good as u64).and_then(|()| file.seek(SeekFrom::End(0))).map_err(&problem)?;
        let mut store = Self { file, path: path.into(), contents };
        if !same {
            store.write(&Line::Run(header.clone()))?;
        }
        Ok(store)
    }

    /// The run that a file is of, and its whole groups' rows in the order they were measured.
    pub fn read(path: &Path) -> Result<(Header, Vec<Row>), Problem> {
        let text = std::fs::read(path).map_err(Problem::of(path.display()))?;
        let mut contents = Contents::read(&text).0;
        let none = || format!("{}: no run is in it", path.display());
        let header = contents.header.ok_or_else(none)?;
        let rows = contents.whole.iter().filter_map(|g| contents.rows.remove(g)).flatten();
        Ok((header, rows.collect()))
    }

    fn write(&mut self, line: &Line) -> Result<(), Problem> {
        let problem = Problem::of::<std::io::Error>(self.path.display());
        let text = serde_json::to_string(line).map_err(|e| problem(e.into()))? + "\n";
        self.file.write_all(text.as_bytes()).map_err(&problem)?;
        // A killed program loses nothing that was written; a machine that stops may.
        self.file.sync_data().map_err(&problem)
    }

    /// Whether the group is there, whole.
    pub fn has(&self, group: &str) -> bool {
        self.contents.whole.iter().any(|whole| whole == group)
    }

    /// Adds a whole group's rows.
    pub fn add(&mut self, group: &str, rows: Vec<Row>, seconds: f64) -> Result<(), Problem> {
        let whole = Line::Whole { group: group.into(), rows: rows.len(), seconds };
        let line = |row| Line::Row { group: group.into(), row: Box::new(row) };
        rows.into_iter().map(line).chain([whole]).try_for_each(|line| {
            self.write(&line)?;
            self.contents.take(line);
            Ok(())
        })
    }

    /// The rows of these groups, in their order.
    pub fn rows<'a>(&'a self, groups: impl Iterator<Item = &'a str>) -> Vec<Row> {
        groups.filter_map(|g| self.contents.rows.get(g)).flatten().cloned().collect()
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A measured row.
    pub(crate) fn row(curve: &str, x: f64, ms: f64, error: f64) -> Row {
        let summary =
            ErrorSummary { mean_abs_error: error, pixels: 100, ..ErrorSummary::default() };
        let errors = Errors { summary, seen_error: Some(0.5 * error), ..Errors::default() };
        let times = Times { frame_ms: [ms * 0.9, ms, ms * 1.2], frames: 3, ..Times::default() };
        Row {
            study: "matrix".into(),
            scene: "card".into(),
            light: "medium".into(),
            light_m: [0.4; 2],
            triangles: 4,
            extent: [64, 48],
            normals: false,
            technique: "soft-shadow-map".into(),
            curve: curve.into(),
            settings: format!("map={x}"),
            x,
            outcome: Outcome::Measured { errors, times },
        }
    }

    fn scratch(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("antumbra-bench-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join(name);
        let _ = std::fs::remove_file(&path);
        path
    }

    #[test]
    fn a_run_resumes_with_what_was_whole() {
        let path = scratch("resumes.jsonl");
        let header = Header { commit: "abc".into(), ..Header::default() };
        let mut store = Store::open(&path, &header).unwrap();
        let whole = vec![row("one", 64.0, 1.0, 0.1), row("one", 128.0, 2.0, 0.05)];
        store.add("a", whole, 3.0).unwrap();
        // Killed in the middle of a group, and of a line.
        let torn = Box::new(row("one", 1.0, 1.0, 0.5));
        store.write(&Line::Row { group: "b".into(), row: torn }).unwrap();
        store.file.write_all(b"{\"row\":{\"group\":\"b\",\"row\":{\"stu").unwrap();
        drop(store);
        let mut store = Store::open(&path, &header).unwrap();
        assert!(store.has("a") && !store.has("b"));
        assert_eq!(store.rows(["a", "b"].into_iter()).len(), 2);
        store.add("b", vec![row("two", 1.0, 1.0, 0.25)], 1.0).unwrap();
        drop(store);
        let store = Store::open(&path, &header).unwrap();
        let curves: Vec<_> =
            store.rows(["b", "a"].into_iter()).into_iter().map(|r| r.curve).collect();
        // The row that was written before the kill is no row of the group's second telling.
        assert_eq!(curves, ["two", "one", "one"]);
        drop(store);
        let (of, rows) = Store::read(&path).unwrap();
        assert_eq!((of, rows.len()), (header, 3));
        assert!(Store::read(Path::new("/nowhere")).unwrap_err().0.contains("/nowhere"));
    }

    #[test]
    fn another_run_starts_anew_and_keeps_the_earlier_file() {
        let path = scratch("another.jsonl");
        let first = Header { commit: "abc".into(), ..Header::default() };
        Store::open(&path, &first).unwrap().add("a", vec![row("one", 1.0, 1.0, 0.1)], 1.0).unwrap();
        let second = Header { commit: "def".into(), ..first };
        let store = Store::open(&path, &second).unwrap();
        assert!(!store.has("a"));
        let earlier = std::fs::read(path.with_extension("earlier.jsonl")).unwrap();
        assert_eq!(Contents::read(&earlier).0.whole, ["a"]);
    }

    /// Rows of a walk are read as they were written, and so are those of runs that had neither seen errors nor walks.
    #[test]
    fn changes_are_kept_and_missed_by_no_older_row() {
        let mut walked = row("one view", 1.0, 1.0, 0.1);
        if let Outcome::Measured { errors, .. } = &mut walked.outcome {
            let changes = Changes { pairs: 9, change_p999: 0.25, ..Changes::default() };
            errors.changes = Some(Box::new(changes));
        }
        let read = |text: &str| serde_json::from_str::<Row>(text).unwrap();
        let text = serde_json::to_string(&walked).unwrap();
        assert_eq!(read(&text), walked);
        let older = serde_json::to_string(&row("one", 1.0, 1.0, 0.1)).unwrap();
        let older = older.replace("\"normals\":false,", "").replace("\"seen_error\":0.05,", "");
        assert!(!older.contains("normals") && !older.contains("seen_error"), "{older}");
        let (errors, _) = read(&older).measured().map(|(e, t)| (e.clone(), t.clone())).unwrap();
        assert_eq!((errors.seen_error, errors.changes), (None, None));
    }

    #[test]
    fn numbers_that_json_cannot_hold_are_no_trap() {
        let mut wrong = row("one", 1.0, 1.0, f64::NAN);
        wrong.x = f64::INFINITY;
        let path = scratch("nan.jsonl");
        let header = Header::default();
        let mut store = Store::open(&path, &header).unwrap();
        store.add("a", vec![wrong], 1.0).unwrap();
        store.add("b", vec![row("one", 1.0, 1.0, 0.1)], 1.0).unwrap();
        // serde_json writes null for them, which is no number: that group alone is not whole.
        let store = Store::open(&path, &header).unwrap();
        assert!(!store.has("a") && store.has("b"));
    }
}
