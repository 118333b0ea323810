//! What Atty 2006 found, and whether it holds here, in a sentence made of the rows.
//!
//! Each finding is a law of a curve, and each law is applied to every object that was swept. It holds
//! where it holds for all of them; the sentence says what was measured either way.

use crate::report::once;
use crate::stats::{exponent, jaggedness, line, rising};
use crate::store::Row;
use crate::sweeps;

/// A finding of the paper beside what was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    pub figure: &'static str,
    pub claim: &'static str,
    pub verdict: Verdict,
    pub sentence: String,
}

/// Whether a finding holds here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// For every object.
    Holds,
    /// For some objects.
    InPart,
    /// For none.
    Refuted,
    /// The sweep was not measured.
    Unmeasured,
}

/// Above this many texels a side the paper finds no improvement.
const ENOUGH: f64 = 200.0;

/// What still counts as flat: the share of the error at [`ENOUGH`] that more texels may gain.
const FLAT: f64 = 0.1;

/// Two sides count as alike where they differ by less than this, in visible fractions.
const ALIKE: f64 = 5e-4;

/// Lights up to this side, in metres, are the paper's points: the error is all at the rim.
const POINT_LIGHT: f64 = 0.05;

/// What was swept of one object.
struct Swept<'a> {
    rows: &'a [Row],
    study: &'static str,
    scene: &'a str,
}

/// A curve: x against some measure, in the order of x.
type Points = Vec<(f64, f64)>;

impl Swept<'_> {
    fn curve(&self, name: &str, of: fn(&Row) -> Option<f64>) -> Points {
        let wanted = |r: &&Row| r.study == self.study && r.scene == self.scene && r.curve == name;
        let own = self.rows.iter().filter(wanted);
        let mut points: Points = own.filter_map(|r| Some((r.x, of(r)?))).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        points
    }

    fn errors(&self, name: &str) -> Points {
        self.curve(name, Row::mean)
    }

    fn times(&self, name: &str) -> Points {
        self.curve(name, Row::ms)
    }
}

/// Whether a law holds of an object, and a phrase of what was measured.
type Judged = Option<(bool, String)>;

/// The objects of a study, in the rows' order.
pub fn scenes<'a>(rows: &'a [Row], study: &str) -> Vec<&'a str> {
    once(rows.iter().filter(|r| r.study == study).map(|r| r.scene.as_str()))
}

/// Applies a law to each object.
fn apply(rows: &[Row], study: &'static str, law: fn(&Swept) -> Judged) -> (Verdict, String) {
    let of = |scene| law(&Swept { rows, study, scene }).map(|(holds, text)| (scene, holds, text));
    let judged: Vec<_> = scenes(rows, study).into_iter().filter_map(of).collect();
    let verdict = match (judged.iter().any(|t| t.1), judged.iter().all(|t| t.1)) {
        _ if judged.is_empty() => Verdict::Unmeasured,
        (_, true) => Verdict::Holds,
        (true, false) => Verdict::InPart,
        (false, false) => Verdict::Refuted,
    };
    let phrases: Vec<_> = judged
        .iter()
        .map(|(scene, holds, text)| format!("{scene}: {text}{}", if *holds { "" } else { " (no)" }))
        .collect();
    (verdict, if phrases.is_empty() { "not measured".into() } else { phrases.join("; ") })
}

const TWO: &str = sweeps::SIDES[1].0;
const ONE: &str = sweeps::SIDES[0].0;

/// A fraction as percent.
fn percent(fraction: f64) -> String {
    format!("{:.2} %", 100.0 * fraction)
}

/// The paper's figure, what it says there, and the study and the law that tell.
type Claim = (&'static str, &'static str, &'static str, fn(&Swept) -> Judged);

/// In the paper's order.
const CLAIMS: [Claim; 10] = [
    ("Fig. 17", "More than about 200² texels bring no improvement.", sweeps::SIDE, flat),
    (
        "Fig. 17",
        "Two sides are better than one, but for the card, where they are equal.",
        sweeps::SIDE,
        sides,
    ),
    (
        "Fig. 17",
        "The aligned card's curve has spikes, where the others' have none.",
        sweeps::SIDE,
        spikes,
    ),
    ("Fig. 18", "Point lights aside, the error grows with the light.", sweeps::LIGHT, grows),
    ("Fig. 19", "The error is least under the light.", sweeps::LATERAL, under),
    ("Fig. 20", "The error grows towards the light.", sweeps::VERTICAL, towards),
    ("Fig. 21", "Time is linear in the number of polygons.", sweeps::POLYGONS, polygons),
    ("Fig. 22", "Time is proportional to the map's pixels, N².", sweeps::SIDE, pixels),
    ("Fig. 24a", "Time grows with the light.", sweeps::LIGHT, time_and_light),
    (
        "Fig. 24b",
        "Small lights want large maps; under large ones a small map does as well.",
        sweeps::LIGHT,
        small_maps,
    ),
];

/// All findings.
pub fn findings(rows: &[Row]) -> Vec<Finding> {
    let finding = |(figure, claim, study, law)| {
        let (verdict, sentence) = apply(rows, study, law);
        Finding { figure, claim, verdict, sentence }
    };
    CLAIMS.map(finding).into()
}

fn flat(swept: &Swept) -> Judged {
    let points = swept.errors(TWO);
    let mean = |points: Vec<f64>| {
        (!points.is_empty()).then(|| points.iter().sum::<f64>() / points.len() as f64)
    };
    let part = |keep: &dyn Fn(f64) -> bool| {
        mean(points.iter().filter(|p| keep(p.0)).map(|p| p.1).collect())
    };
    let near = part(&|n| (0.75 * ENOUGH..=1.25 * ENOUGH).contains(&n))?;
    let beyond = part(&|n| n > 1.5 * ENOUGH)?;
    let text = format!("{} around N = 200, {} above 300", percent(near), percent(beyond));
    Some((beyond > near * (1.0 - FLAT) - ALIKE, text))
}

fn sides(swept: &Swept) -> Judged {
    let one = swept.errors(ONE);
    let two = swept.errors(TWO);
    let gains: Vec<f64> = one.iter().zip(&two).map(|(a, b)| a.1 - b.1).collect();
    let most = gains.iter().fold(0.0, |m: f64, g| m.max(g.abs()));
    let better = gains.iter().filter(|g| **g > 0.0).count();
    let mean = gains.iter().sum::<f64>() / gains.len().max(1) as f64;
    if swept.scene == "card" {
        return Some((most <= ALIKE, format!("differ by {} at most", percent(most))));
    }
    let text =
        format!("better at {better} of {} sizes, by {:.2} points", gains.len(), 100.0 * mean);
    (!gains.is_empty()).then_some((better == gains.len(), text))
}

fn spikes(swept: &Swept) -> Judged {
    let jagged = |scene: &str| {
        let errors = Swept { scene, ..*swept }.errors(TWO);
        jaggedness(&errors.iter().map(|p| p.1).collect::<Vec<_>>())
    };
    let own = jagged(swept.scene)?;
    let holds = swept.scene == "card" || own < 0.5 * jagged("card")?;
    Some((holds, format!("neighbours are off a straight line by {:.0} %", 100.0 * own)))
}

/// The ends of a curve of errors in a phrase, whether it rises, and by how much in all.
fn rise(points: &[(f64, f64)]) -> Option<(bool, f64, String)> {
    let ((x0, first), (x1, last)) = (*points.first()?, *points.last()?);
    let order = rising(points)?;
    let (from, to) = (percent(first), percent(last));
    let text = format!("{from} at {x0} m to {to} at {x1} m (τ = {order:.2})");
    Some((order > 0.5, last - first, text))
}

fn grows(swept: &Swept) -> Judged {
    let mut points = swept.errors(TWO);
    points.retain(|p| p.0 > POINT_LIGHT);
    rise(&points).map(|(rises, _, text)| (rises, text))
}

fn under(swept: &Swept) -> Judged {
    let points = swept.errors(TWO);
    let least = points.iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let reach = points.iter().map(|p| p.0.abs()).fold(0.0, f64::max);
    let text = format!("least ({}) at {} m of ±{reach} m", percent(least.1), least.0);
    Some((least.0.abs() <= 0.5 * reach, text))
}

fn towards(swept: &Swept) -> Judged {
    rise(&swept.errors(TWO)).map(|(rises, gain, text)| (rises && gain > 0.0, text))
}

fn polygons(swept: &Swept) -> Judged {
    let points = swept.times(TWO);
    let line = line(&points)?;
    let text = format!(
        "{:.1} ms + {:.2} ms a thousand, R² = {:.3}",
        line.base,
        1000.0 * line.slope,
        line.r2
    );
    Some((line.r2 > 0.95 && line.slope > 0.0, text))
}

fn pixels(swept: &Swept) -> Judged {
    let points = swept.times(TWO);
    let all = exponent(&points)?;
    let squares: Vec<_> = points.iter().map(|p| (p.0 * p.0, p.1)).collect();
    let line = line(&squares)?;
    let text = format!("grows as N^{all:.1}; straight in N² with R² = {:.3}", line.r2);
    Some((line.r2 > 0.95, text))
}

fn time_and_light(swept: &Swept) -> Judged {
    let points = swept.times(TWO);
    let (first, last) = (points.first()?, points.last()?);
    let text = format!("{:.1} ms at {} m to {:.1} ms at {} m", first.1, first.0, last.1, last.0);
    Some((rising(&points)? > 0.5, text))
}

fn small_maps(swept: &Swept) -> Judged {
    let small = swept.errors("N = 64");
    let large = swept.errors("N = 256");
    let ratio = |i: usize| Some(small.get(i)?.1 / large.get(i)?.1);
    let (first, last) = (ratio(0)?, ratio(small.len().checked_sub(1)?)?);
    let text = format!(
        "N = 64 has {first:.1} times the error of N = 256 under {} m, {last:.1} times under {} m",
        small[0].0,
        small[small.len() - 1].0
    );
    Some((last < first && last < 1.25, text))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::tests::row;

    fn swept(study: &str, scene: &str, name: &str, points: &[(f64, f64)]) -> Vec<Row> {
        let one = |&(x, error): &(f64, f64)| {
            let (study, scene) = (study.to_string(), scene.to_string());
            Row { study, scene, ..row(name, x, x, error) }
        };
        points.iter().map(one).collect()
    }

    fn verdict(rows: &[Row], figure: &str, part: &str) -> Verdict {
        let all = findings(rows);
        all.into_iter().find(|f| f.figure == figure && f.claim.contains(part)).unwrap().verdict
    }

    #[test]
    fn nothing_measured_is_no_verdict() {
        let none = |f: &Finding| f.verdict == Verdict::Unmeasured && f.sentence == "not measured";
        assert!(findings(&[]).iter().all(none));
    }

    #[test]
    fn a_flat_curve_is_flat_and_a_falling_one_is_not() {
        let n = |i: u32| f64::from(40 + i * 20);
        let flat: Vec<_> = (0..19).map(|i| (n(i), if i < 6 { 0.05 } else { 0.03 })).collect();
        let falling: Vec<_> = (0..19).map(|i| (n(i), 4.0 / n(i))).collect();
        let rows = swept(sweeps::SIDE, "bunny", TWO, &flat);
        assert_eq!(verdict(&rows, "Fig. 17", "200"), Verdict::Holds);
        let rows = swept(sweeps::SIDE, "bunny", TWO, &falling);
        assert_eq!(verdict(&rows, "Fig. 17", "200"), Verdict::Refuted);
        // The object that differs is named.
        let both = [swept(sweeps::SIDE, "card", TWO, &flat), rows].concat();
        let finding = &findings(&both)[0];
        assert_eq!(finding.verdict, Verdict::InPart);
        assert!(finding.sentence.contains("(no)"), "{}", finding.sentence);
    }

    #[test]
    fn two_sides_must_be_better_but_for_the_card() {
        let points = |error: f64| [(64.0, error), (128.0, error)];
        let pair = |scene, one, two| {
            let one = swept(sweeps::SIDE, scene, ONE, &points(one));
            [one, swept(sweeps::SIDE, scene, TWO, &points(two))].concat()
        };
        assert_eq!(verdict(&pair("bunny", 0.03, 0.02), "Fig. 17", "Two"), Verdict::Holds);
        assert_eq!(verdict(&pair("bunny", 0.02, 0.03), "Fig. 17", "Two"), Verdict::Refuted);
        assert_eq!(verdict(&pair("card", 0.02, 0.02), "Fig. 17", "Two"), Verdict::Holds);
        assert_eq!(verdict(&pair("card", 0.03, 0.02), "Fig. 17", "Two"), Verdict::Refuted);
    }

    #[test]
    fn growth_least_and_lines_are_seen() {
        let light = [(0.01, 0.09), (0.1, 0.01), (0.4, 0.02), (1.0, 0.03)];
        let rows = swept(sweeps::LIGHT, "bunny", TWO, &light);
        assert_eq!(verdict(&rows, "Fig. 18", ""), Verdict::Holds);
        let lateral = [(-1.0, 0.03), (0.0, 0.01), (1.0, 0.02)];
        let rows = swept(sweeps::LATERAL, "bunny", TWO, &lateral);
        assert_eq!(verdict(&rows, "Fig. 19", ""), Verdict::Holds);
        let edge = [(-1.0, 0.01), (0.0, 0.02), (1.0, 0.03)];
        let rows = swept(sweeps::LATERAL, "bunny", TWO, &edge);
        assert_eq!(verdict(&rows, "Fig. 19", ""), Verdict::Refuted);
        // `row` gives a time of x ms: a straight line.
        let triangles = [(1e3, 0.0), (1e4, 0.0), (1e5, 0.0)];
        let rows = swept(sweeps::POLYGONS, "sphere", TWO, &triangles);
        assert_eq!(verdict(&rows, "Fig. 21", ""), Verdict::Holds);
    }
}
