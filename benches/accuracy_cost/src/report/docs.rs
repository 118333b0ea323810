//! Tables in the documentation, each between two marks.

use crate::Problem;
use std::path::Path;

/// A table's place.
pub struct Place {
    /// What stands before it.
    from: &'static str,
    /// What stands behind it.
    to: &'static str,
    /// What the page begins as, where there is none.
    page: &'static str,
}

/// The headline table's.
pub const HEADLINE: Place = Place {
    from: "<!-- headline: written by cargo bench --bench accuracy_cost -- --write-docs -->",
    to: "<!-- /headline -->",
    page: "# What accuracy costs\n\n",
};

/// The table of hard cases.
pub const HARD_CASES: Place = Place {
    from: "<!-- hard cases: written by cargo bench --bench accuracy_cost -- --hard-cases --write-docs -->",
    to: "<!-- /hard cases -->",
    page: "# Hard cases\n\n",
};

/// The page with the table between its marks, which are added at the end where they are missing.
///
/// # Errors
/// A sentence where only one of the marks is there.
pub fn with_table(place: &Place, page: &str, table: &str) -> Result<String, Problem> {
    let Place { from: before, to: behind, page: start } = place;
    let block = format!("{before}\n{}\n{behind}", table.trim());
    match (page.find(before), page.find(behind)) {
        (Some(from), Some(to)) if from < to => {
            Ok(format!("{}{block}{}", &page[..from], &page[to + behind.len()..]))
        }
        (None, None) => {
            let page = if page.is_empty() { start } else { page };
            Ok(format!("{}\n\n{block}\n", page.trim_end()))
        }
        _ => Err(format!(
            "the table's marks must be\n{before}\n{behind}\nin this order, or both missing"
        )),
    }
}

/// Copies a table of a report into its place in a page.
///
/// # Errors
/// A sentence with the name of the file that cannot be read or written, or whose marks are wrong.
pub fn copy(place: &Place, table: &Path, path: &Path) -> Result<(), Problem> {
    let table = std::fs::read_to_string(table)
        .map_err(|e| format!("{}: {e}; run the bench first", table.display()))?;
    put(place, &table, path)
}

/// Puts a table into its place in a page.
///
/// # Errors
/// As [`copy`].
pub fn put(place: &Place, table: &str, path: &Path) -> Result<(), Problem> {
    let told = |e: &dyn std::fmt::Display| format!("{}: {e}", path.display());
    let page = match std::fs::read_to_string(path) {
        Ok(page) => page,
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => String::new(),
        Err(e) => return Err(told(&e)),
    };
    let page = with_table(place, &page, table).map_err(|e| told(&e))?;
    std::fs::write(path, page).map_err(|e| told(&e))
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
        assert!(with_table(&HEADLINE, &second.replace(HEADLINE.to, ""), "| c |").is_err());
    }
}
