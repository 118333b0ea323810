//! The headline table in the documentation, between two marks.

use crate::Problem;
use std::path::Path;

/// What the table stands between.
const FROM: &str =
    "<!-- headline: written by cargo bench --bench accuracy_cost -- --write-docs -->";
const TO: &str = "<!-- /headline -->";

/// What the page begins as, where there is none.
const PAGE: &str = "# What accuracy costs\n\n";

/// The page with the table between its marks, which are added at the end where they are missing.
///
/// # Errors
/// A sentence where only one of the marks is there.
pub fn with_table(page: &str, table: &str) -> Result<String, Problem> {
    let block = format!("{FROM}\n{}\n{TO}", table.trim());
    match (page.find(FROM), page.find(TO)) {
        (Some(from), Some(to)) if from < to => {
            Ok(format!("{}{block}{}", &page[..from], &page[to + TO.len()..]))
        }
        (None, None) => {
            let page = if page.is_empty() { PAGE } else { page };
            Ok(format!("{}\n\n{block}\n", page.trim_end()))
        }
        _ => {
            Err(format!("the table's marks must be\n{FROM}\n{TO}\nin this order, or both missing"))
        }
    }
}

/// Copies a report's headline table into the page.
///
/// # Errors
/// A sentence with the name of the file that cannot be read or written, or whose marks are wrong.
pub fn copy(table: &Path, path: &Path) -> Result<(), Problem> {
    let told = |e: &dyn std::fmt::Display| format!("{}: {e}", path.display());
    let table = std::fs::read_to_string(table)
        .map_err(|e| format!("{}: {e}; run the bench first", table.display()))?;
    let page = match std::fs::read_to_string(path) {
        Ok(page) => page,
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => String::new(),
        Err(e) => return Err(told(&e)),
    };
    let page = with_table(&page, &table).map_err(|e| told(&e))?;
    std::fs::write(path, page).map_err(|e| told(&e))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_replaces_the_one_before_and_nothing_else() {
        let first = with_table("", "| a |").unwrap();
        assert!(first.starts_with("# What accuracy costs\n") && first.contains("| a |"));
        let around = first.replace("# What", "# Before\n\n# What") + "After.\n";
        let second = with_table(&around, "| b |").unwrap();
        assert_eq!(second, around.replace("| a |", "| b |"));
        assert_eq!(with_table(&second, "| b |").unwrap(), second);
        assert!(with_table(&second.replace(TO, ""), "| c |").is_err());
    }
}
