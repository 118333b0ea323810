//! Rows of numbers, and what is read off them.

/// A named table of rows.
pub struct Table {
    /// The file's name.
    pub name: &'static str,
    columns: Vec<&'static str>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// An empty table; prints its head.
    pub fn new(name: &'static str, columns: &[&'static str]) -> Self {
        println!("\n== {name}");
        println!("{}", columns.iter().map(|c| format!(" {c:>13}")).collect::<String>());
        Self { name, columns: columns.to_vec(), rows: Vec::new() }
    }

    /// Adds and prints a row.
    pub fn row(&mut self, cells: Vec<String>) {
        println!("{}", cells.iter().map(|c| format!(" {c:>13}")).collect::<String>());
        self.rows.push(cells);
    }

    /// The rows as CSV, the driver in front.
    pub fn csv(&self, driver: &str) -> String {
        let mut text = format!("driver,{}\n", self.columns.join(","));
        for row in &self.rows {
            text.push_str(&format!("\"{driver}\",{}\n", row.join(",")));
        }
        text
    }
}

/// The value at a share of the sorted values.
pub fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[((sorted.len() - 1) as f64 * share).round() as usize]
}

/// The median.
pub fn median(values: &[f64]) -> f64 {
    quantile(values, 0.5)
}

/// Median and quartiles, in text.
pub fn spread(values: &[f64]) -> String {
    format!("{:.1}", median(values))
}

/// Least squares y = a + b x: (a, b, R²).
pub fn line(points: &[(f64, f64)]) -> (f64, f64, f64) {
    let n = points.len() as f64;
    let (mx, my) =
        (points.iter().map(|p| p.0).sum::<f64>() / n, points.iter().map(|p| p.1).sum::<f64>() / n);
    let sxy: f64 = points.iter().map(|p| (p.0 - mx) * (p.1 - my)).sum();
    let sxx: f64 = points.iter().map(|p| (p.0 - mx).powi(2)).sum();
    let syy: f64 = points.iter().map(|p| (p.1 - my).powi(2)).sum();
    let slope = sxy / sxx;
    (my - slope * mx, slope, sxy * sxy / (sxx * syy))
}

/// The exponent of y ∝ x^e.
pub fn exponent(points: &[(f64, f64)]) -> f64 {
    line(&points.iter().map(|p| (p.0.ln(), p.1.ln())).collect::<Vec<_>>()).1
}
