//! Tables in the documentation, each between two marks.

use crate::Problem;
use std::path::{Path, PathBuf};

/// A page of docs/ with a table of the bench's.
pub struct Page {
    /// The table's name in the page's marks.
    name: &'static str,
    /// The file in --out that the run writes the table to.
    table: &'static str,
    /// The page under the project's root.
    page: &'static str,
    /// The options beside `--write-docs` that copy it.
    options: &'static str,
    /// What the page begins as, where there is none.
    title: &'static str,
}

/// Milliseconds for so much error.
pub const HEADLINE: Page = Page {
    name: "headline",
    table: "headline.md",
    page: "docs/accuracy.md",
    options: "",
    title: "# What accuracy costs\n\n",
};

/// Over what range errors stay what they are.
pub const ENVELOPE: Page = Page {
    name: "envelope",
    table: "envelope.md",
    page: "docs/envelope.md",
    options: "--envelope ",
    title: "# The envelope\n\n",
};

/// Lights, occluders, receivers and numbers at their limits.
pub const HARD_CASES: Page = Page {
    name: "hard cases",
    table: "hard_cases.md",
    page: "docs/hard_cases.md",
    options: "--hard-cases ",
    title: "# Hard cases\n\n",
};

impl Page {
    /// The lines that the table stands between.
    fn marks(&self) -> [String; 2] {
        let Self { name, options, .. } = self;
        let command = format!("cargo bench --bench accuracy_cost -- {options}--write-docs");
        [format!("<!-- {name}: written by {command} -->"), format!("<!-- /{name} -->")]
    }
}

/// The page with the table between its marks, which are added at the end where they are missing.
///
/// # Errors
/// One mark without the other, or both in the wrong order.
pub fn with_table(of: &Page, page: &str, table: &str) -> Result<String, Problem> {
    let [begin, end] = &of.marks();
    let block = format!("{begin}\n{}\n{end}", table.trim());
    match (page.find(begin), page.find(end)) {
        (Some(from), Some(to)) if from < to => {
            Ok(format!("{}{block}{}", &page[..from], &page[to + end.len()..]))
        }
        (None, None) => {
            let page = if page.is_empty() { of.title } else { page };
            Ok(format!("{}\n\n{block}\n", page.trim_end()))
        }
        _ => Err(format!(
            "the table's marks must be\n{begin}\n{end}\nin this order, or both missing"
        )
        .into()),
    }
}

/// Copies a run's table from its folder into the page under the project's root, and says where that is.
pub fn copy(of: &Page, out: &Path, root: &Path) -> Result<PathBuf, Problem> {
    let (table, path) = (out.join(of.table), root.join(of.page));
    let table = std::fs::read_to_string(&table)
        .map_err(|e| format!("{}: {e}; run the bench first", table.display()))?;
    let page = match std::fs::read_to_string(&path) {
        Ok(page) => page,
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => String::new(),
        Err(e) => return Err(Problem::of(path.display())(e)),
    };
    let page = with_table(of, &page, &table).map_err(Problem::of(path.display()))?;
    std::fs::write(&path, page).map_err(Problem::of(path.display()))?;
    Ok(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_replaces_the_one_before_and_nothing_else() {
        let first = with_table(&HEADLINE, "", "| a |").unwrap();
        assert!(first.starts_with("# What accuracy costs\n") && first.contains("| a |"));
        let around = first.replace("# What", "# Before\n\n# What") + "After.\n";
        let second = with_table(&HEADLINE, &around, "| b |").unwrap();
        assert_eq!(second, around.replace("| a |", "| b |"));
        assert_eq!(with_table(&HEADLINE, &second, "| b |").unwrap(), second);
        assert!(with_table(&HEADLINE, &second.replace(&HEADLINE.marks()[1], ""), "| c |").is_err());
    }
}
