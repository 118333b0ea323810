//! The report, from the rows alone.

mod charts;
mod curtis;
pub mod docs;
mod files;
mod headline;
mod html;
mod strip;
mod tables;
mod views;

use crate::Problem;
use crate::groups::MATRIX;
use crate::hard_cases::judge::Tables;
use crate::store::{Header, Outcome, Row};
use std::path::Path;

pub use charts::style;
pub use files::csv_of;
pub use headline::markdown;
pub use tables::head_of;

/// What the report is made of.
pub struct Report<'a> {
    pub header: &'a Header,
    /// Every row, in the order of the groups.
    pub rows: &'a [Row],
    /// Groups that the quick run had no time for.
    pub left_out: &'a [String],
    pub cache: &'a Path,
    /// The tables of hard cases, by the devices that they were measured on.
    pub hard_cases: &'a Tables,
}

impl Report<'_> {
    /// The rows of a study.
    fn study<'a>(&'a self, study: &'a str) -> impl Iterator<Item = &'a Row> {
        self.rows.iter().filter(move |r| r.study == study)
    }

    /// The measured rows of error against time.
    fn matrix(&self) -> impl Iterator<Item = &Row> {
        self.study(MATRIX).filter(|r| r.mean().is_some())
    }

    /// The techniques that the crate does not have yet, each once.
    fn not_there(&self) -> Vec<&str> {
        let missing = self.rows.iter().filter(|r| r.outcome == Outcome::NotThere);
        once(missing.map(|r| r.technique.as_str()))
    }
}

/// Each of some names once, in their order.
pub fn once<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut seen: Vec<&str> = Vec::new();
    for name in names {
        if !seen.contains(&name) {
            seen.push(name);
        }
    }
    seen
}

/// Writes every file of the report, each whole or not at all.
pub fn write(report: &Report, out: &Path) -> Result<(), Problem> {
    let files = [
        ("accuracy_cost.csv", files::csv(report)?),
        ("accuracy_cost.json", files::json(report)?),
        ("headline.md", markdown(report)),
        ("index.html", html::page(report)),
    ];
    write_files(out, files)
}

/// Writes files into a folder, each whole or not at all.
pub fn write_files<const N: usize>(out: &Path, files: [(&str, String); N]) -> Result<(), Problem> {
    for (name, text) in files {
        let path = out.join(name);
        let part = out.join(format!(".{name}.part"));
        let written = std::fs::write(&part, text).and_then(|()| std::fs::rename(&part, &path));
        written.map_err(|e| {
            // The room it took is better free.
            let _ = std::fs::remove_file(&part);
            Problem::of(path.display())(e)
        })?;
    }
    Ok(())
}

/// Seconds, milliseconds and microseconds with three digits that mean something.
fn ms(value: f64) -> String {
    match value {
        v if v >= 100.0 => format!("{v:.0}"),
        v if v >= 10.0 => format!("{v:.1}"),
        v => format!("{v:.2}"),
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::store::tests::row;

    pub(crate) fn rows() -> Vec<Row> {
        let mut failed = row("PCSS", 16.0, 1.0, 0.1);
        failed.outcome = Outcome::Failed("torn, \"quoted\" & <broken>".into());
        let mut missing = row("ray march", 4.0, 1.0, 0.1);
        missing.technique = "ray-march".into();
        missing.outcome = Outcome::NotThere;
        vec![
            row("soft shadow map", 64.0, 10.0, 0.04),
            row("soft shadow map", 256.0, 40.0, 0.015),
            failed,
            missing,
        ]
    }

    pub(crate) fn with<T>(rows: &[Row], of: impl FnOnce(&Report) -> T) -> T {
        let header = Header {
            command: "cargo bench".into(),
            commit: "abc".into(),
            driver: "a \"driver\"".into(),
            ..Header::default()
        };
        let left_out = ["light size: bunny".to_string()];
        let cache = Path::new("/nowhere");
        of(&Report {
            header: &header,
            rows,
            left_out: &left_out,
            cache,
            hard_cases: &Tables::new(),
        })
    }

    #[test]
    fn every_file_is_written_and_says_what_failed_and_what_is_not_there() {
        let out = std::env::temp_dir().join(format!("antumbra-report-{}", std::process::id()));
        std::fs::create_dir_all(&out).unwrap();
        with(&rows(), |report| write(report, &out)).unwrap();
        let page = std::fs::read_to_string(out.join("index.html")).unwrap();
        assert!(page.contains("&lt;broken&gt;") && !page.contains("<broken>"));
        assert!(page.contains("ray-march") && page.contains("light size: bunny"));
        // Self-contained: nothing is fetched.
        for address in ["http://", "https://", "src=\"/", "@import", "<script src"] {
            assert!(!page.contains(address), "{address}");
        }
        let json: serde_json::Value =
            serde_json::from_slice(&std::fs::read(out.join("accuracy_cost.json")).unwrap())
                .unwrap();
        assert_eq!(json["rows"].as_array().unwrap().len(), 3);
        assert_eq!(json["rows"][1]["mean_abs_error"], 0.015);
        assert_eq!(json["not_there"][0]["technique"], "ray-march");
        assert_eq!(json["rows"][2]["status"], "failed");
        let problem = with(&rows(), |report| write(report, Path::new("/nowhere"))).unwrap_err();
        assert!(problem.0.contains("/nowhere"));
    }
}
