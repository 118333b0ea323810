//! The table for people: a row a case, a column a technique.

use super::judge::{Row, Tables, Verdict};
use super::techniques;
use crate::report::head_of;
use maud::{Markup, html};
use std::fmt::Write as _;

/// Rows of one case, in the order of the techniques.
fn cases(rows: &[Row]) -> impl Iterator<Item = &[Row]> {
    rows.chunk_by(|a, b| a.limit == b.limit && a.case == b.case)
}

/// A visible fraction or an error, in as few digits as tell it.
fn digits(x: f64) -> String {
    match x.abs() {
        0.0 => "0".into(),
        1.0 => format!("{x:.0}"),
        size if size < 1e-3 => format!("{x:.0e}"),
        size if size < 0.1 => format!("{x:.3}"),
        _ => format!("{x:.2}"),
    }
}

/// The worst pixel's error and what it may be.
fn cell(row: &Row) -> String {
    let (worst, bound) = (digits(row.worst), digits(row.worst_bound));
    match row.verdict {
        Verdict::Held => format!("{worst} ≤ {bound}"),
        Verdict::Known(_) => format!("{worst} †"),
        Verdict::Broken => format!("**{worst} > {bound}**"),
        Verdict::Mended(_) => format!("**{worst} ≤ {bound}, said to be more**"),
    }
}

/// How many rows there are, and how many of them each verdict has.
pub fn counts(rows: &[Row]) -> String {
    let count = |keep: fn(&Verdict) -> bool| rows.iter().filter(|row| keep(&row.verdict)).count();
    let known = count(|v| matches!(v, Verdict::Known(_)));
    let not_fractions: usize = rows.iter().map(|row| row.not_fractions).sum();
    format!(
        "{} cases, {} rows: {} within their bounds, {known} known to be beyond, {} broken; {not_fractions} pixels \
         that are no number between 0 and 1",
        cases(rows).count(),
        rows.len(),
        count(|v| *v == Verdict::Held),
        rows.len() - known - count(|v| *v == Verdict::Held),
    )
}

/// The known faults: why, and of which cases and techniques, each once.
fn faults<'a>(rows: impl Iterator<Item = &'a Row>) -> Vec<(String, String)> {
    let mut faults: Vec<(String, String)> = Vec::new();
    for row in rows {
        if let Verdict::Known(why) = &row.verdict {
            let place = format!("{}: {} ({})", row.limit, row.case, row.technique);
            match faults.iter_mut().find(|(known, _)| known == why) {
                Some((_, places)) if places.contains(&place) => {}
                Some((_, places)) => *places += &format!("; {place}"),
                None => faults.push((why.clone(), place)),
            }
        }
    }
    faults
}

/// The tables in Markdown.
pub fn markdown(tables: &Tables) -> String {
    let mut out = String::new();
    for (driver, rows) in tables {
        out += &of_driver(rows, driver);
    }
    out += "Why the bounds are what they are:\n\n";
    for held in techniques::ALL {
        let _ = writeln!(out, "* `{}`: {}.", held.words, held.why);
    }
    out += "\n† Known faults, which the tests demand to show:\n\n";
    for (why, places) in faults(tables.values().flatten()) {
        let _ = writeln!(out, "* {why}: {places}.");
    }
    out
}

fn of_driver(rows: &[Row], driver: &str) -> String {
    let mut out = format!("## {driver}\n\n{}.\n\n| | truth |", counts(rows));
    for held in techniques::ALL {
        let _ = write!(out, " {} |", held.name);
    }
    out += "\n|---|---|";
    out += &"---|".repeat(techniques::ALL.len());
    out.push('\n');
    for case in cases(rows) {
        let [least, most] = case[0].expected.map(digits);
        let expected = if least == most { least } else { format!("{least} to {most}") };
        let _ = write!(out, "| {}: {} | {expected} |", case[0].limit, case[0].case);
        for row in case {
            let _ = write!(out, " {} |", cell(row));
        }
        out.push('\n');
    }
    out.push('\n');
    out
}

/// The table in HTML, every row with its reason.
pub fn html(rows: &[Row], driver: &str) -> Markup {
    html! {
        p { (driver) ": " (counts(rows)) "." }
        table.n {
            (head_of(["case", "technique", "truth", "mean", "≤", "seen", "worst", "≤", "verdict", "why"]))
            @for row in rows {
                @let (class, verdict, why) = match &row.verdict {
                    Verdict::Held => ("yes", "held", &row.why),
                    Verdict::Known(why) => ("part", "known fault", why),
                    Verdict::Broken => ("no", "broken", &row.why),
                    Verdict::Mended(why) => ("no", "mended", why),
                };
                tr {
                    td { (row.limit) ": " (row.case) } td { (row.technique) }
                    td { (digits(row.expected[0])) " to " (digits(row.expected[1])) }
                    @for error in [row.mean, row.mean_bound, row.seen, row.worst, row.worst_bound] { td { (digits(error)) } }
                    td { span class=(class) { (verdict) } } td { (why) }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hard_cases::cases::Limit;

    fn row(technique: &str, verdict: Verdict) -> Row {
        Row {
            limit: Limit::Light,
            case: "1 & 2".into(),
            technique: technique.into(),
            expected: [0.0, 1.0],
            mean_bound: 0.1,
            worst_bound: 0.25,
            why: "because".into(),
            mean: 0.05,
            seen: 0.04,
            worst: 0.0004,
            outside: 0.0,
            not_fractions: 0,
            verdict,
        }
    }

    #[test]
    fn what_is_broken_stands_out_and_what_is_known_says_why() {
        let rows = [
            row("a", Verdict::Held),
            row("b", Verdict::Known("of its model".into())),
            row("c", Verdict::Broken),
            row("d", Verdict::Mended("of old".into())),
        ];
        let counted =
            "1 cases, 4 rows: 1 within their bounds, 1 known to be beyond, 2 broken; 0 pixels";
        assert!(counts(&rows).starts_with(counted), "{}", counts(&rows));
        let text = markdown(&Tables::from([("a driver".into(), rows.to_vec())]));
        assert!(text.starts_with("## a driver\n\n1 cases"), "{text}");
        for part in [
            "| light: 1 & 2 | 0 to 1 | 4e-4 ≤ 0.25 | 4e-4 † | **4e-4 > 0.25** |",
            "* of its model: light: 1 & 2 (b).",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
        let page = html(&rows, "a <driver>").into_string();
        assert!(page.contains("a &lt;driver&gt;") && page.contains("1 &amp; 2"), "{page}");
    }
}
