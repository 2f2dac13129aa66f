//! Plots as SVG, written by hand: bars on a logarithmic axis, and curves on two.
//!
//! ```text
//!   Limn        ████ 19          10^2 |        .o
//!   OpenSubdiv  █████████ 95          |     .o'  .-- stores
//!          limit ┆                    |  .o'  .-'
//!             1     10    100         +--------------
//! ```
//!
//! Colours are classes (`e0`, `e1` ... by engine), so that the page's style says them once for dark and once for light. Every plot is
//! one line of text. Limit: axes are logarithmic, values greater than 0.

use crate::report::figures;
use std::fmt::Write;

/// A bar.
pub struct Bar {
    /// The class of its colour.
    pub class: String,
    /// What stands before it.
    pub label: String,
    /// How long it is.
    pub value: f64,
    /// What stands behind the value.
    pub mark: String,
}

/// A curve.
pub struct Curve {
    /// The class of its colour.
    pub class: String,
    /// What it is, for those who point at it.
    pub label: String,
    /// Its points, both coordinates greater than 0.
    pub points: Vec<[f64; 2]>,
}

/// A logarithmic axis: values from the first to the second are spread over pixels from the third to the fourth.
#[derive(Clone, Copy)]
struct Axis(f64, f64, f64, f64);

impl Axis {
    fn at(self, value: f64) -> f64 {
        let Axis(low, high, from, to) = self;
        from + (to - from) * (value / low).ln() / (high / low).ln()
    }

    /// The powers of ten within.
    fn decades(self) -> impl Iterator<Item = i32> {
        let (first, last) = (self.0.log10() - 1e-9, self.1.log10() + 1e-9);
        (first.ceil() as i32)..=(last.floor() as i32)
    }
}

/// The powers of ten around some values, at least one decade.
pub fn decades(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let (low, high) = values.fold((f64::INFINITY, 0.0f64), |(low, high), v| (low.min(v), high.max(v)));
    if high <= 0.0 {
        return [1.0, 10.0];
    }
    let (first, last) = (low.log10().floor(), high.log10().ceil());
    [10f64.powf(first), 10f64.powf(last.max(first + 1.0))]
}

const WIDTH: f64 = 460.0;
const LABELS: f64 = 132.0;
const STEP: f64 = 22.0;

/// Bars under each other, and a line where the limit is.
pub fn bars(title: &str, bars: &[Bar], limit: f64, range: [f64; 2]) -> String {
    let bottom = 8.0 + STEP * bars.len() as f64;
    let axis = Axis(range[0], range[1], LABELS, WIDTH - 62.0);
    let mut out = open(title, WIDTH, bottom + 22.0);
    for k in axis.decades() {
        let x = axis.at(10f64.powi(k));
        _ = write!(out, "<path class=\"grid\" d=\"M{x:.1} 4V{bottom:.1}\"/>");
        _ = write!(
            out,
            "<text class=\"tick\" x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
            bottom + 15.0,
            power(k)
        );
    }
    for (i, bar) in bars.iter().enumerate() {
        let (y, middle) = (10.0 + STEP * i as f64, 20.0 + STEP * i as f64);
        let end = axis.at(bar.value.clamp(range[0], range[1])).max(LABELS + 1.0);
        let (label, mark) = (escaped(&bar.label), escaped(&bar.mark));
        _ = write!(out, "<text x=\"{:.1}\" y=\"{middle:.1}\" text-anchor=\"end\">{label}</text>", LABELS - 8.0);
        _ = write!(
            out,
            "<rect class=\"{}\" x=\"{LABELS:.1}\" y=\"{y:.1}\" width=\"{:.1}\" height=\"14\"/>",
            bar.class,
            end - LABELS
        );
        let value = figures(bar.value);
        _ = write!(out, "<text class=\"value\" x=\"{:.1}\" y=\"{middle:.1}\">{value}{mark}</text>", end + 6.0);
    }
    if limit >= range[0] && limit <= range[1] {
        let x = axis.at(limit);
        _ = write!(
            out,
            "<path class=\"limit\" d=\"M{x:.1} 2V{bottom:.1}\"><title>storing the result: {} ns</title></path>",
            figures(limit)
        );
    }
    out + "</svg>"
}

/// Curves over each other, and a line below which nobody comes.
pub fn curves(title: &str, across: &str, up: &str, curves: &[Curve], limit: &[[f64; 2]]) -> String {
    let (height, left, bottom) = (340.0, 52.0, 296.0);
    let all = || curves.iter().flat_map(|c| &c.points).chain(limit);
    let [xs, ys] = [0, 1].map(|k| decades(all().map(|p| p[k])));
    let (x, y) = (Axis(xs[0], xs[1], left, WIDTH - 22.0), Axis(ys[0], ys[1], bottom, 18.0));
    let mut out = open(title, WIDTH, height);
    for k in x.decades() {
        let at = x.at(10f64.powi(k));
        _ = write!(out, "<path class=\"grid\" d=\"M{at:.1} 18V{bottom:.1}\"/>");
        _ = write!(
            out,
            "<text class=\"tick\" x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
            bottom + 16.0,
            power(k)
        );
    }
    for k in y.decades() {
        let at = y.at(10f64.powi(k));
        _ = write!(out, "<path class=\"grid\" d=\"M{left:.1} {at:.1}H{:.1}\"/>", WIDTH - 22.0);
        _ = write!(
            out,
            "<text class=\"tick\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
            left - 7.0,
            at + 4.0,
            power(k)
        );
    }
    let (across, up) = (escaped(across), escaped(up));
    _ = write!(
        out,
        "<text class=\"tick\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{across}</text>",
        WIDTH - 22.0,
        height - 8.0
    );
    _ = write!(out, "<text class=\"tick\" x=\"{left:.1}\" y=\"11\">{up}</text>");
    let path = |points: &[[f64; 2]]| {
        let at = points.iter().map(|p| format!("{:.1} {:.1}", x.at(p[0]), y.at(p[1])));
        format!("M{}", at.collect::<Vec<_>>().join("L"))
    };
    if !limit.is_empty() {
        _ = write!(out, "<path class=\"limit\" d=\"{}\"><title>storing the result</title></path>", path(limit));
    }
    for curve in curves.iter().filter(|c| !c.points.is_empty()) {
        let (class, label) = (&curve.class, escaped(&curve.label));
        _ = write!(
            out,
            "<g class=\"{class}\"><title>{label}</title><path class=\"curve\" d=\"{}\"/>",
            path(&curve.points)
        );
        for p in &curve.points {
            _ = write!(out, "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"3\"/>", x.at(p[0]), y.at(p[1]));
        }
        out.push_str("</g>");
    }
    out + "</svg>"
}

fn open(title: &str, width: f64, height: f64) -> String {
    format!("<svg viewBox=\"0 0 {width:.0} {height:.0}\" role=\"img\" aria-label=\"{}\">", escaped(title))
}

/// A power of ten as people read it.
fn power(k: i32) -> String {
    match k {
        -3..=3 => format!("{}", 10f64.powi(k)),
        4 => "10 k".to_owned(),
        5 => "100 k".to_owned(),
        6 => "1 M".to_owned(),
        7 => "10 M".to_owned(),
        8 => "100 M".to_owned(),
        _ => format!("1e{k}"),
    }
}

/// Text as it may stand in a page.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bar(label: &str, value: f64) -> Bar {
        Bar { class: "e1".to_owned(), label: label.to_owned(), value, mark: String::new() }
    }

    #[test]
    fn bars_are_as_long_as_logarithms() {
        // 266 pixels for two decades: 10 in the middle, 100 at the end; the limit at 1 is where they begin.
        let made = bars("A & B", &[bar("<ten>", 10.0), bar("hundred", 100.0)], 1.0, [1.0, 100.0]);
        assert!(made.starts_with("<svg viewBox=\"0 0 460 74\" role=\"img\" aria-label=\"A &amp; B\">"), "{made}");
        assert!(made.contains("<rect class=\"e1\" x=\"132.0\" y=\"10.0\" width=\"133.0\" height=\"14\"/>"), "{made}");
        assert!(made.contains("<rect class=\"e1\" x=\"132.0\" y=\"32.0\" width=\"266.0\" height=\"14\"/>"), "{made}");
        assert!(made.contains("&lt;ten></text>") && made.contains(">100</text>"), "{made}");
        assert!(made.contains("<path class=\"limit\" d=\"M132.0 2V52.0\">"), "{made}");
        assert!(!made.contains('\n') && made.ends_with("</svg>"));
        assert!(
            !bars("", &[bar("a", 5.0)], 0.5, [1.0, 10.0]).contains("limit"),
            "a limit beside the axis is not drawn"
        );
    }

    #[test]
    fn curves_go_through_their_points() {
        let curve =
            Curve { class: "e0".to_owned(), label: "Limn".to_owned(), points: vec![[10.0, 1.0], [1000.0, 100.0]] };
        let made = curves("growth", "faces", "ms", &[curve], &[[10.0, 1.0], [1000.0, 10.0]]);
        assert!(made.contains("<path class=\"curve\" d=\"M52.0 296.0L438.0 18.0\"/>"), "{made}");
        assert!(made.contains("<path class=\"limit\" d=\"M52.0 296.0L438.0 157.0\">"), "{made}");
        assert!(made.contains("<circle cx=\"438.0\" cy=\"18.0\" r=\"3\"/>"), "{made}");
        assert_eq!(made.matches("class=\"grid\"").count(), 6, "three decades each way");
        assert_eq!(decades([3.0, 40.0].into_iter()), [1.0, 100.0]);
        assert_eq!(decades(std::iter::empty()), [1.0, 10.0]);
    }
}
