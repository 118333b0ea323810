//! Tables of what was measured.

use std::path::{Path, PathBuf};

/// A named table.
#[derive(Default)]
pub struct Table {
    name: &'static str,
    columns: Vec<&'static str>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// An empty table.
    pub fn new(name: &'static str) -> Self {
        Self { name, ..Self::default() }
    }

    /// Sets and prints the columns' names, which are parted by bars.
    pub fn head(&mut self, columns: &'static str) {
        self.columns = columns.split('|').collect();
        println!("\n== {}", self.name);
        println!("{}", self.columns.iter().map(|c| format!(" {c:>13}")).collect::<String>());
    }

    /// Adds and prints a row, whose cells are parted by bars.
    pub fn row(&mut self, cells: impl AsRef<str>) {
        let cells: Vec<_> = cells.as_ref().split('|').map(|c| c.trim().to_string()).collect();
        assert_eq!(cells.len(), self.columns.len(), "{}: {cells:?}", self.name);
        println!("{}", cells.iter().map(|c| format!(" {c:>13}")).collect::<String>());
        self.rows.push(cells);
    }

    /// Writes the table into a folder as CSV, the driver in front; where.
    pub fn write(&self, folder: &Path, driver: &str) -> PathBuf {
        std::fs::create_dir_all(folder).unwrap();
        let path = folder.join(format!("{}.csv", self.name));
        let mut csv = csv::Writer::from_path(&path).unwrap();
        csv.write_record(std::iter::once("driver").chain(self.columns.iter().copied())).unwrap();
        for row in &self.rows {
            csv.write_record(std::iter::once(driver).chain(row.iter().map(String::as_str)))
                .unwrap();
        }
        csv.flush().unwrap();
        path
    }
}
