//! Charts as inline SVG: text by the page's own font, nothing fetched.

mod axis;
pub use axis::Axis;

use std::fmt::Write as _;

/// Colors that every kind of color vision tells apart (Okabe and Ito 2008), their yellow replaced by
/// one that shows on white, a gray, and a brown that its mark and dash must help.
pub const PALETTE: [&str; 10] = [
    "#0072b2", "#000000", "#7a6a00", "#e69f00", "#009e73", "#d55e00", "#cc79a7", "#56b4e9",
    "#8c8c8c", "#8c564b",
];

/// How a curve is drawn: color, dash and mark, so that no two depend on color alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style {
    /// A CSS color.
    pub color: &'static str,
    /// An SVG dash pattern; empty for a solid line.
    pub dash: &'static str,
    /// 0 circle, 1 square, 2 triangle, 3 diamond.
    pub mark: u8,
}

/// One point of a curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Where on x.
    pub x: f64,
    /// Where on y.
    pub y: f64,
    /// First and third quartile of x, where x is measured.
    pub x_spread: Option<[f64; 2]>,
    /// What a pointer over it shows.
    pub tip: String,
    /// Whether nobody beats it.
    pub front: bool,
}

/// A curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// What the legend says.
    pub label: String,
    /// How it is drawn.
    pub style: Style,
    /// Its points, in the order they are joined.
    pub points: Vec<Point>,
}

/// A chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// What stands above it.
    pub title: String,
    /// Left to right.
    pub x: Axis,
    /// Bottom to top.
    pub y: Axis,
    /// The curves.
    pub series: Vec<Series>,
    /// A level under which the truth's noise drowns what is measured.
    pub floor: Option<f64>,
    /// Whether it tells its own legend.
    pub legend: bool,
}

const WIDTH: f64 = 400.0;
const HEIGHT: f64 = 270.0;
const LEFT: f64 = 52.0;
const RIGHT: f64 = 12.0;
const TOP: f64 = 28.0;
const BOTTOM: f64 = 46.0;
/// The height of a line of the legend, and entries a line.
const LEGEND: f64 = 18.0;
const LEGEND_COLUMNS: usize = 3;

/// The text as it may stand in SVG and HTML.
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

fn mark(style: Style, x: f64, y: f64, size: f64) -> String {
    let color = style.color;
    let path = |d: String| format!("<path d=\"{d}\" fill=\"{color}\"/>");
    match style.mark {
        1 => {
            let (l, s) = (0.9 * size, 1.8 * size);
            path(format!("M{:.1} {:.1}h{s:.1}v{s:.1}h-{s:.1}z", x - l, y - l))
        }
        2 => path(format!(
            "M{x:.1} {:.1}L{:.1} {:.1}L{:.1} {:.1}z",
            y - 1.2 * size,
            x + 1.1 * size,
            y + 0.8 * size,
            x - 1.1 * size,
            y + 0.8 * size
        )),
        3 => path(format!(
            "M{x:.1} {:.1}L{:.1} {y:.1}L{x:.1} {:.1}L{:.1} {y:.1}z",
            y - 1.3 * size,
            x + 1.3 * size,
            y + 1.3 * size,
            x - 1.3 * size
        )),
        _ => format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{size}\" fill=\"{color}\"/>"),
    }
}

/// The sample of a curve in a legend, 26 wide.
pub fn sample(style: Style, x: f64, y: f64) -> String {
    let (color, dash) = (style.color, style.dash);
    format!(
        "<path d=\"M{x:.1} {y:.1}h26\" stroke=\"{color}\" stroke-width=\"2\" \
         stroke-dasharray=\"{dash}\"/>{}",
        mark(style, x + 13.0, y, 3.5)
    )
}

impl Chart {
    fn at(&self, x: f64, y: f64) -> Option<(f64, f64)> {
        let (u, v) = (self.x.place(x)?, self.y.place(y)?);
        Some((LEFT + u * (WIDTH - LEFT - RIGHT), HEIGHT - BOTTOM - v * (HEIGHT - TOP - BOTTOM)))
    }

    /// The chart as an `svg` element.
    pub fn svg(&self) -> String {
        let rows = if self.legend { self.series.len().div_ceil(LEGEND_COLUMNS) } else { 0 };
        let height = HEIGHT + LEGEND * rows as f64;
        let mut out = format!(
            "<svg viewBox=\"0 0 {WIDTH} {height}\" width=\"{WIDTH}\" height=\"{height}\" role=\"img\" \
             fill=\"none\" font-size=\"11.5\">\n<title>{0}</title>\n<text x=\"{LEFT}\" y=\"17\" \
             class=\"t\">{0}</text>\n",
            escape(&self.title)
        );
        self.draw_front(&mut out);
        self.draw_axes(&mut out);
        self.series.iter().for_each(|series| self.draw_curve(&mut out, series));
        if self.legend {
            self.draw_legend(&mut out);
        }
        out.push_str("</svg>\n");
        out
    }

    fn draw_axes(&self, out: &mut String) {
        let (right, bottom) = (WIDTH - RIGHT, HEIGHT - BOTTOM);
        for (value, label) in self.x.ticks() {
            let Some(u) = self.x.place(value) else { continue };
            let x = LEFT + u * (right - LEFT);
            let _ = writeln!(out, "<path d=\"M{x:.1} {TOP}V{bottom}\" class=\"g\"/>");
            if let Some(label) = label {
                let y = bottom + 15.0;
                let _ = writeln!(out, "<text x=\"{x:.1}\" y=\"{y}\" class=\"m\">{label}</text>");
            }
        }
        for (value, label) in self.y.ticks() {
            let Some(v) = self.y.place(value) else { continue };
            let y = bottom - v * (bottom - TOP);
            let _ = writeln!(out, "<path d=\"M{LEFT} {y:.1}H{right}\" class=\"g\"/>");
            if let Some(label) = label {
                let (x, y) = (LEFT - 6.0, y + 4.0);
                let _ = writeln!(out, "<text x=\"{x}\" y=\"{y:.1}\" class=\"e\">{label}</text>");
            }
        }
        let _ = writeln!(out, "<path d=\"M{LEFT} {TOP}V{bottom}H{right}\" class=\"a\"/>");
        let middle = 0.5 * (LEFT + right);
        let under = bottom + 34.0;
        let _ = writeln!(
            out,
            "<text x=\"{middle}\" y=\"{under}\" class=\"m\">{}</text>",
            escape(&self.x.label)
        );
        let side = 0.5 * (TOP + bottom);
        let _ = writeln!(
            out,
            "<text x=\"13\" y=\"{side}\" class=\"m\" transform=\"rotate(-90 13 {side})\">{}</text>",
            escape(&self.y.label)
        );
        if let Some((x, y)) = self.floor.and_then(|floor| self.at(self.x.from, floor)) {
            let _ = writeln!(
                out,
                "<path d=\"M{x:.1} {y:.1}H{right}\" class=\"f\"/><text x=\"{}\" y=\"{:.1}\" \
                 class=\"e f\">noise of the truth</text>",
                right - 2.0,
                y - 4.0
            );
        }
    }

    /// The steps that nobody beats: from each point of the front, right to the next one's time, then
    /// down to its error.
    fn draw_front(&self, out: &mut String) {
        let points = self.series.iter().flat_map(|s| &s.points).filter(|p| p.front);
        let mut front: Vec<(f64, f64)> = points.filter_map(|p| self.at(p.x, p.y)).collect();
        front.sort_by(|a, b| a.0.total_cmp(&b.0));
        let Some(first) = front.first() else { return };
        let mut path = format!("M{:.1} {TOP}", first.0);
        for (x, y) in &front {
            let _ = write!(path, "H{x:.1}V{y:.1}");
        }
        let _ = writeln!(out, "<path d=\"{path}H{}\" class=\"p\"/>", WIDTH - RIGHT);
    }

    fn draw_curve(&self, out: &mut String, series: &Series) {
        let Style { color, dash, .. } = series.style;
        let placed: Vec<_> =
            series.points.iter().filter_map(|p| Some((p, self.at(p.x, p.y)?))).collect();
        let line: Vec<String> = placed.iter().map(|(_, (x, y))| format!("{x:.1} {y:.1}")).collect();
        if line.len() > 1 {
            let _ = writeln!(
                out,
                "<path d=\"M{}\" stroke=\"{color}\" stroke-width=\"1.8\" stroke-dasharray=\"{dash}\"/>",
                line.join("L")
            );
        }
        // Dense curves are lines; their points are not marked one by one.
        let size = if line.len() > 16 { 2.0 } else { 3.5 };
        for (point, (x, y)) in placed {
            let _ = write!(out, "<g><title>{}</title>", escape(&point.tip));
            if let Some([from, to]) = point.x_spread
                && let (Some((a, _)), Some((b, _))) = (self.at(from, point.y), self.at(to, point.y))
            {
                let _ = write!(out, "<path d=\"M{a:.1} {y:.1}H{b:.1}\" stroke=\"{color}\"/>");
            }
            if point.front {
                let _ = write!(
                    out,
                    "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"6.5\" stroke=\"{color}\" \
                     stroke-width=\"1.3\"/>"
                );
            }
            let _ = writeln!(out, "{}</g>", mark(series.style, x, y, size));
        }
    }

    fn draw_legend(&self, out: &mut String) {
        let column = (WIDTH - LEFT) / LEGEND_COLUMNS as f64;
        for (i, series) in self.series.iter().enumerate() {
            let x = LEFT + column * (i % LEGEND_COLUMNS) as f64;
            let y = HEIGHT + 2.0 + LEGEND * (i / LEGEND_COLUMNS) as f64;
            let _ = writeln!(
                out,
                "{}<text x=\"{:.1}\" y=\"{:.1}\" class=\"l\">{}</text>",
                sample(series.style, x, y),
                x + 31.0,
                y + 4.0,
                escape(&series.label)
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart() -> Chart {
        let point =
            |x, y, front| Point { x, y, x_spread: Some([x, x]), tip: "<tip>".into(), front };
        let style = Style { color: PALETTE[0], dash: "", mark: 0 };
        let points = vec![point(1.0, 0.1, true), point(10.0, 0.01, true), point(5.0, 0.0, false)];
        Chart {
            title: "a & b".into(),
            x: Axis::log("ms", [1.0, 10.0]),
            y: Axis::log("error", [0.01, 0.1]),
            series: vec![Series { label: "one".into(), style, points }],
            floor: Some(0.02),
            legend: true,
        }
    }

    #[test]
    fn text_is_escaped_and_points_off_a_log_axis_are_left_out() {
        let svg = chart().svg();
        assert!(svg.contains("a &amp; b") && svg.contains("&lt;tip&gt;") && !svg.contains("<tip>"));
        // The point of no error has no place on a log axis.
        assert_eq!(svg.matches("&lt;tip&gt;").count(), 2);
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
        assert_eq!(svg.matches("<svg").count(), svg.matches("</svg>").count());
    }

    #[test]
    fn the_front_is_drawn_as_steps() {
        let svg = chart().svg();
        let front = svg.lines().find(|l| l.contains("class=\"p\"")).unwrap();
        assert_eq!(front.matches('H').count(), 3, "{front}");
    }
}
