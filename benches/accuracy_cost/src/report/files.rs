//! The rows for programs: JSON and CSV of the same columns.

use super::Report;
use crate::Problem;
use crate::store::{Outcome, Row};
use serde_json::{Map, Value, json};

/// One row's columns, in order. What was not measured has no value.
fn columns(report: &Report, row: &Row) -> Vec<(&'static str, Value)> {
    let (status, reason) = match &row.outcome {
        Outcome::Measured { .. } => ("measured", ""),
        Outcome::NotThere => ("not there yet", ""),
        Outcome::Failed(why) => ("failed", why.as_str()),
    };
    let measured = row.measured();
    let e = |of: &dyn Fn(&crate::store::Errors) -> Value| measured.map_or(Value::Null, |m| of(m.0));
    let t = |of: &dyn Fn(&crate::store::Times) -> Value| measured.map_or(Value::Null, |m| of(m.1));
    vec![
        ("study", json!(row.study)),
        ("scene", json!(row.scene)),
        ("light", json!(row.light)),
        ("light_width_m", json!(row.light_m[0])),
        ("light_height_m", json!(row.light_m[1])),
        ("technique", json!(row.technique)),
        ("curve", json!(row.curve)),
        ("settings", json!(row.settings)),
        ("x", json!(row.x)),
        ("status", json!(status)),
        ("reason", json!(reason)),
        ("mean_abs_error", e(&|e| json!(e.mean_abs_error))),
        ("rmse", e(&|e| json!(e.rmse))),
        ("p99", e(&|e| json!(e.p99))),
        ("worst", e(&|e| json!(e.worst))),
        ("bias", e(&|e| json!(e.bias))),
        ("pixels", e(&|e| json!(e.pixels))),
        ("penumbra_pixels", e(&|e| json!(e.penumbra_pixels))),
        ("penumbra_mean", e(&|e| json!(e.penumbra_mean))),
        ("false_umbra", e(&|e| json!(e.false_umbra))),
        ("false_light", e(&|e| json!(e.false_light))),
        ("lit_pixels", e(&|e| json!(e.lit_pixels))),
        ("lit_error", e(&|e| json!(e.lit_error))),
        ("flip", e(&|e| json!(e.flip))),
        ("truth_noise", e(&|e| json!(e.truth_noise))),
        ("noise_floor", e(&|e| json!(e.noise_floor))),
        ("frame_ms", t(&|t| json!(t.frame_ms[1]))),
        ("frame_ms_q1", t(&|t| json!(t.frame_ms[0]))),
        ("frame_ms_q3", t(&|t| json!(t.frame_ms[2]))),
        ("frames", t(&|t| json!(t.frames))),
        ("record_us", t(&|t| json!(t.record_us))),
        ("gpu_bytes", t(&|t| json!(t.gpu_bytes))),
        ("triangles", json!(row.triangles)),
        ("width", json!(row.extent[0])),
        ("height", json!(row.extent[1])),
        ("driver", json!(report.header.driver)),
        ("commit", json!(report.header.commit)),
    ]
}

/// The passes' times.
fn passes(row: &Row) -> Map<String, Value> {
    let all = row.measured().map(|m| m.1.passes.as_slice()).unwrap_or_default();
    all.iter().map(|(name, ms)| (name.clone(), json!(ms))).collect()
}

/// Rows measured and failed, and apart from them what the crate does not have yet.
pub fn json(report: &Report) -> Result<String, Problem> {
    let object = |row: &Row| {
        let mut map: Map<String, Value> =
            columns(report, row).into_iter().map(|(k, v)| (k.to_string(), v)).collect();
        map.insert("passes_ms".into(), Value::Object(passes(row)));
        Value::Object(map)
    };
    let (missing, rows): (Vec<&Row>, Vec<&Row>) =
        report.rows.iter().partition(|r| r.outcome == Outcome::NotThere);
    let missing: Vec<Value> = missing
        .into_iter()
        .map(|r| json!({ "study": r.study, "technique": r.technique, "settings": r.settings, "scene": r.scene, "light": r.light }))
        .collect();
    let whole = json!({
        "run": report.header,
        "rows": rows.into_iter().map(object).collect::<Vec<_>>(),
        "not_there": missing,
        "left_out": report.left_out,
    });
    serde_json::to_string_pretty(&whole).map_err(Problem::of("accuracy_cost.json"))
}

/// The rows measured and failed. Without any, the head alone.
pub fn csv(report: &Report) -> Result<String, Problem> {
    let text = |value: Value| match value {
        Value::Null => String::new(),
        Value::String(text) => text,
        other => other.to_string(),
    };
    let line = |row: &Row| -> Vec<String> {
        let passes = passes(row).into_iter().map(|(k, v)| format!("{k}={v:.4}"));
        let passes = passes.collect::<Vec<_>>().join(" ");
        columns(report, row).into_iter().map(|c| text(c.1)).chain([passes]).collect()
    };
    let names = columns(report, &Row::default()).into_iter().map(|c| c.0.to_string());
    let rows = report.rows.iter().filter(|r| r.outcome != Outcome::NotThere);
    csv_of(std::iter::once(names.chain(["passes_ms".into()]).collect()).chain(rows.map(line)))
}

/// Lines of cells as CSV.
pub fn csv_of(lines: impl IntoIterator<Item = Vec<String>>) -> Result<String, Problem> {
    let mut csv = csv::WriterBuilder::new().flexible(true).from_writer(Vec::new());
    lines.into_iter().try_for_each(|line| csv.write_record(line)).map_err(Problem::of("CSV"))?;
    let bytes = csv.into_inner().map_err(Problem::of("CSV"))?;
    String::from_utf8(bytes).map_err(Problem::of("CSV"))
}

#[cfg(test)]
mod tests {
    use super::super::tests::{rows, with};
    use super::*;

    #[test]
    fn the_csv_has_the_columns_that_programs_rely_on_and_as_many_cells_in_each_row() {
        let text = with(&rows(), csv).unwrap();
        let head = text.lines().next().unwrap();
        let columns = "scene technique settings mean_abs_error rmse p99 worst bias frame_ms driver";
        for column in columns.split(' ') {
            assert!(head.split(',').any(|c| c == column), "{column}");
        }
        assert_eq!(text.lines().count(), 4);
        let count = head.split(',').count();
        // No cell of the first row holds a comma; the driver's quotes are doubled.
        let row = text.lines().nth(1).unwrap();
        assert_eq!(row.split(',').count(), count);
        assert!(row.contains("\"a \"\"driver\"\"\""));
        assert!(text.contains("\"torn, \"\"quoted\"\" & <broken>\""));
    }
}
