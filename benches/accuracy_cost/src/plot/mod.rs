//! Charts as inline SVG: text by the page's own font, nothing fetched.

mod axis;
pub use axis::Axis;

use maud::{Markup, html};

/// Colors that every kind of color vision tells apart (Okabe and Ito 2008), their yellow replaced by
/// one that shows on white, a gray, and a brown and a violet that their mark and dash must help.
pub const PALETTE: [&str; 11] = [
    "#0072b2", "#000000", "#7a6a00", "#e69f00", "#009e73", "#d55e00", "#cc79a7", "#56b4e9",
    "#8c8c8c", "#8c564b", "#6a3d9a",
];

/// How a curve is drawn: color, dash and mark, so that no two depend on color alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style {
    pub color: &'static str,
    /// An SVG dash pattern; empty for a solid line.
    pub dash: &'static str,
    /// 0 circle, 1 square, 2 triangle, 3 diamond.
    pub mark: u8,
}

/// One point of a curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Where on the axis of time, or of what is swept.
    pub x: f64,
    /// Where on the axis of the error, or of time.
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
    pub label: String,
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
    pub series: Vec<Series>,
    /// A level under which the truth's noise drowns what is measured.
    pub floor: Option<f64>,
    /// Whether it has a legend of its own.
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

fn mark(style: Style, x: f64, y: f64, size: f64) -> Markup {
    let corners: &[[f64; 2]] = match style.mark {
        1 => &[[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]],
        2 => &[[0.0, -1.2], [1.1, 0.8], [-1.1, 0.8]],
        3 => &[[0.0, -1.3], [1.3, 0.0], [0.0, 1.3], [-1.3, 0.0]],
        _ => return html! { circle cx=(tenth(x)) cy=(tenth(y)) r=(size) fill=(style.color) {} },
    };
    let at = |[u, v]: &[f64; 2]| format!("{:.1},{:.1}", x + size * u, y + size * v);
    let points: Vec<String> = corners.iter().map(at).collect();
    html! { polygon points=(points.join(" ")) fill=(style.color) {} }
}

/// A length in tenths of a pixel.
fn tenth(length: f64) -> String {
    format!("{length:.1}")
}

/// The sample of a curve in a legend, 26 wide.
pub fn sample(style: Style, x: f64, y: f64) -> Markup {
    html! {
        path d=(format!("M{x:.1} {y:.1}h26")) stroke=(style.color) stroke-width="2" stroke-dasharray=(style.dash) {}
        (mark(style, x + 13.0, y, 3.5))
    }
}

/// The right and the lower end of the axes.
const ENDS: (f64, f64) = (WIDTH - RIGHT, HEIGHT - BOTTOM);

impl Chart {
    fn at(&self, x: f64, y: f64) -> Option<(f64, f64)> {
        let (u, v) = (self.x.place(x)?, self.y.place(y)?);
        Some((LEFT + u * (ENDS.0 - LEFT), ENDS.1 - v * (ENDS.1 - TOP)))
    }

    /// The chart as an `svg` element.
    pub fn svg(&self) -> Markup {
        let rows = if self.legend { self.series.len().div_ceil(LEGEND_COLUMNS) } else { 0 };
        let height = HEIGHT + LEGEND * rows as f64;
        html! {
            svg viewBox=(format!("0 0 {WIDTH} {height}")) width=(WIDTH) height=(height) role="img" fill="none"
                font-size="11.5" {
                title { (self.title) }
                text x=(LEFT) y="17" class="t" { (self.title) }
                (self.front())
                (self.axes())
                @for series in &self.series { (self.curve(series)) }
                @if self.legend { (self.own_legend()) }
            }
        }
    }

    fn axes(&self) -> Markup {
        let (right, bottom) = ENDS;
        let places = |axis: &Axis| -> Vec<_> {
            let ticks = axis.ticks().into_iter();
            ticks.filter_map(|(value, label)| Some((axis.place(value)?, label))).collect()
        };
        let side = 0.5 * (TOP + bottom);
        html! {
            @for (u, label) in places(&self.x) {
                @let x = tenth(LEFT + u * (right - LEFT));
                path d=(format!("M{x} {TOP}V{bottom}")) class="g" {}
                text x=(x) y=(bottom + 15.0) class="m" { (label) }
            }
            @for (v, label) in places(&self.y) {
                @let y = bottom - v * (bottom - TOP);
                path d=(format!("M{LEFT} {y:.1}H{right}")) class="g" {}
                text x=(LEFT - 6.0) y=(tenth(y + 4.0)) class="e" { (label) }
            }
            path d=(format!("M{LEFT} {TOP}V{bottom}H{right}")) class="a" {}
            text x=(0.5 * (LEFT + right)) y=(bottom + 34.0) class="m" { (self.x.label) }
            text x="13" y=(side) class="m" transform=(format!("rotate(-90 13 {side})")) { (self.y.label) }
            @if let Some((x, y)) = self.floor.and_then(|floor| self.at(self.x.from, floor)) {
                path d=(format!("M{x:.1} {y:.1}H{right}")) class="f" {}
                text x=(right - 2.0) y=(tenth(y - 4.0)) class="e f" { "noise of the truth" }
            }
        }
    }

    /// The steps that nobody beats: from each point of the front, right to the next one's time, then
    /// down to its error.
    fn front(&self) -> Markup {
        let points = self.series.iter().flat_map(|s| &s.points).filter(|p| p.front);
        let mut front: Vec<(f64, f64)> = points.filter_map(|p| self.at(p.x, p.y)).collect();
        front.sort_by(|a, b| a.0.total_cmp(&b.0));
        let steps: String = front.iter().map(|(x, y)| format!("H{x:.1}V{y:.1}")).collect();
        html! {
            @if let Some((x, _)) = front.first() {
                path d=(format!("M{x:.1} {TOP}{steps}H{}", ENDS.0)) class="p" {}
            }
        }
    }

    fn curve(&self, series: &Series) -> Markup {
        let Style { color, dash, .. } = series.style;
        let placed: Vec<_> =
            series.points.iter().filter_map(|p| Some((p, self.at(p.x, p.y)?))).collect();
        let line: Vec<String> = placed.iter().map(|(_, (x, y))| format!("{x:.1} {y:.1}")).collect();
        // Dense curves are lines; their points are not marked one by one.
        let size = if line.len() > 16 { 2.0 } else { 3.5 };
        let spread = |point: &Point| {
            let ends = point.x_spread?.map(|x| self.at(x, point.y));
            Some((ends[0]?.0, ends[1]?.0))
        };
        html! {
            @if line.len() > 1 {
                path d={ "M" (line.join("L")) } stroke=(color) stroke-width="1.8" stroke-dasharray=(dash) {}
            }
            @for (point, (x, y)) in placed {
                g {
                    title { (point.tip) }
                    @if let Some((a, b)) = spread(point) {
                        path d=(format!("M{a:.1} {y:.1}H{b:.1}")) stroke=(color) {}
                    }
                    @if point.front {
                        circle cx=(tenth(x)) cy=(tenth(y)) r="6.5" stroke=(color) stroke-width="1.3" {}
                    }
                    (mark(series.style, x, y, size))
                }
            }
        }
    }

    fn own_legend(&self) -> Markup {
        let column = (WIDTH - LEFT) / LEGEND_COLUMNS as f64;
        html! {
            @for (i, series) in self.series.iter().enumerate() {
                @let x = LEFT + column * (i % LEGEND_COLUMNS) as f64;
                @let y = HEIGHT + 2.0 + LEGEND * (i / LEGEND_COLUMNS) as f64;
                (sample(series.style, x, y))
                text x=(tenth(x + 31.0)) y=(tenth(y + 4.0)) class="l" { (series.label) }
            }
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
        let svg = chart().svg().into_string();
        assert!(svg.contains("a &amp; b") && svg.contains("&lt;tip&gt;") && !svg.contains("<tip>"));
        // The point of no error has no place on a log axis.
        assert_eq!(svg.matches("&lt;tip&gt;").count(), 2);
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
        assert_eq!(svg.matches("<svg").count(), svg.matches("</svg>").count());
    }

    #[test]
    fn the_front_is_drawn_as_steps() {
        let svg = chart().svg().into_string();
        let front = svg.split('<').find(|tag| tag.contains("class=\"p\"")).unwrap();
        assert_eq!(front.matches('H').count(), 3, "{front}");
    }
}
