//! The rows for programs: JSON and CSV of the same columns.

use super::Report;
use crate::Problem;
use crate::store::{Outcome, Row};
use serde_json::{Map, Value, json};

/// The columns of accuracy_cost.csv but for the last, the passes' times.
const COLUMNS: &str = "study scene light light_width_m light_height_m technique curve settings x status reason \
                       mean_abs_error seen_error rmse p99 worst bias pixels penumbra_pixels penumbra_mean false_umbra false_light \
                       lit_pixels lit_error flip truth_noise noise_floor pairs change_mean change_p99 \
                       change_p999 change_worst truth_change_mean truth_change_p99 truth_change_p999 \
                       truth_change_worst error_change_mean error_change_p99 error_change_p999 \
                       error_change_worst frame_ms frame_ms_q1 frame_ms_q3 frames \
                       record_us gpu_bytes triangles normals width height driver commit";

/// One row's values by their columns, null where nothing was measured.
fn values(report: &Report, row: &Row) -> Map<String, Value> {
    let (status, reason) = match &row.outcome {
        Outcome::Measured { .. } => ("measured", ""),
        Outcome::NotThere => ("not there yet", ""),
        Outcome::Failed(why) => ("failed", why.as_str()),
    };
    let whole = json!({
        "row": row,
        "own": {
            "light_width_m": row.light_m[0], "light_height_m": row.light_m[1],
            "width": row.extent[0], "height": row.extent[1],
            "status": status, "reason": reason,
            "driver": report.header.driver, "commit": report.header.commit,
        },
        "errors": row.measured().map(|m| m.0),
        "times": row.measured().map(|m| m.1),
        "quartiles": row.measured().map(|m| m.1.frame_ms).map(|[q1, median, q3]| {
            json!({ "frame_ms": median, "frame_ms_q1": q1, "frame_ms_q3": q3 })
        }),
    });
    let value = |column: &str| {
        let parts = ["own", "row", "quartiles", "errors", "times"];
        parts.iter().find_map(|part| whole[part].get(column)).cloned().unwrap_or_default()
    };
    COLUMNS.split_whitespace().map(|column| (column.into(), value(column))).collect()
}

/// The passes' times.
fn passes(row: &Row) -> Map<String, Value> {
    let all = row.measured().map(|m| m.1.passes.as_slice()).unwrap_or_default();
    all.iter().map(|(name, ms)| (name.clone(), json!(ms))).collect()
}

/// Rows measured and failed, and apart from them what the crate does not have yet.
pub fn json(report: &Report) -> Result<String, Problem> {
    let object = |row: &Row| {
        let mut map = values(report, row);
        map.insert("passes_ms".into(), Value::Object(passes(row)));
        Value::Object(map)
    };
    let (missing, rows): (Vec<&Row>, Vec<&Row>) =
        report.rows.iter().partition(|r| r.outcome == Outcome::NotThere);
    let missing: Vec<Value> = missing
        .into_iter()
        .map(|r| {
            let Row { study, technique, settings, scene, light, .. } = r;
            json!({ "study": study, "technique": technique, "settings": settings, "scene": scene, "light": light })
        })
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
        let mut values = values(report, row);
        let cell = |column| text(values.remove(column).unwrap_or_default());
        COLUMNS.split_whitespace().map(cell).chain([passes]).collect()
    };
    let names = COLUMNS.split_whitespace().map(String::from);
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
        let columns = "scene technique settings mean_abs_error seen_error rmse p99 worst bias frame_ms driver";
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
