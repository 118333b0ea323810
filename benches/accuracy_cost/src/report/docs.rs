//! Tables in the documentation, each between two marks.

use crate::Problem;
use std::path::{Path, PathBuf};

/// A page of docs/ with a table of the bench's.
pub struct Page {
    /// Where the run writes the table, in --out.
    pub table: &'static str,
    /// The page, under the project's root.
    pub page: &'static str,
    /// What the table stands between.
    marks: [&'static str; 2],
    /// What the page begins as, where there is none.
    title: &'static str,
}

/// Milliseconds for so much error.
pub const HEADLINE: Page = Page {
    table: "headline.md",
    page: "docs/accuracy.md",
    marks: [
        "<!-- headline: written by cargo bench --bench accuracy_cost -- --write-docs -->",
        "<!-- /headline -->",
    ],
    title: "# What accuracy costs\n\n",
};

/// Over what range errors stay what they are.
pub const ENVELOPE: Page = Page {
    table: "envelope.md",
    page: "docs/envelope.md",
    marks: [
        "<!-- envelope: written by cargo bench --bench accuracy_cost -- --envelope --write-docs -->",
        "<!-- /envelope -->",
    ],
    title: "# The envelope\n\n",
};

/// Lights, occluders, receivers and numbers at their limits.
pub const HARD_CASES: Page = Page {
    table: "hard_cases.md",
    page: "docs/hard_cases.md",
    marks: [
        "<!-- hard cases: written by cargo bench --bench accuracy_cost -- --hard-cases --write-docs -->",
        "<!-- /hard cases -->",
    ],
    title: "# Hard cases\n\n",
};

/// The page with the table between its marks, which are added at the end where they are missing.
pub fn with_table(of: &Page, page: &str, table: &str) -> Result<String, Problem> {
    let [begin, end] = of.marks;
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
        )),
    }
}

/// Copies a run's table from its folder into the page under the project's root, and says where that is.
pub fn copy(of: &Page, out: &Path, root: &Path) -> Result<PathBuf, Problem> {
    let (table, path) = (out.join(of.table), root.join(of.page));
    let told = |e: &dyn std::fmt::Display| format!("{}: {e}", path.display());
    let table = std::fs::read_to_string(&table)
        .map_err(|e| format!("{}: {e}; run the bench first", table.display()))?;
    let page = match std::fs::read_to_string(&path) {
        Ok(page) => page,
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => String::new(),
        Err(e) => return Err(told(&e)),
    };
    let page = with_table(of, &page, &table).map_err(|e| told(&e))?;
    std::fs::write(&path, page).map_err(|e| told(&e))?;
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
        assert!(with_table(&HEADLINE, &second.replace(HEADLINE.marks[1], ""), "| c |").is_err());
    }
}
