//! The page with plots: everything in one file, made of a [`Report`] alone.
//!
//! ```text
//!   machine, and how it was measured
//!   schemes   a panel of bars a cage: ns a face by engine, the line of stores
//!   growth    levels and cages: ms by faces, the line of stores
//!   figures   every row as a table
//! ```
//!
//! Limit: colours for ten engines.

use crate::engines::LIMN;
use crate::plot::{Bar, Curve, bars, curves, decades, escaped};
use crate::report::{Report, Row, figures};
use limn_mesh::{grouped, scheme};
use std::fmt::Write;

const STYLE: &str = include_str!("page.css");

/// The whole page.
pub fn page(report: &Report) -> String {
    let engines = engines(report);
    let mut out = String::from("<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n");
    out +=
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>Limn: benchmarks</title>\n";
    _ = write!(out, "<style>\n{STYLE}</style>\n</head>\n<body>\n<h1>How fast Limn subdivides</h1>\n");
    out += "<p class=\"lead\">From indexed faces to the points and faces of a level, on one thread, beside other libraries that do the \
            same work. Rows called “+ normals” are Limn once more, with the unit normals that a picture needs: no other library here makes \
            any, so they are compared with each other alone. Shorter is better; every axis is logarithmic; the dashed line is what \
            storing points and corners takes.</p>\n";
    out += &facts(report);
    out += &legend(&engines);
    out += "<h2>Nanoseconds a face</h2>\n";
    let table: Vec<&Row> = report.series("table").collect();
    let range = decades(table.iter().flat_map(|r| [r.ns_per_face, r.limit_ns_per_face]));
    for id in unique(table.iter().map(|row| row.scheme.as_str())) {
        let name = scheme(id).map_or(id, |entry| entry.info.name);
        _ = write!(out, "<h3>{}</h3>\n<div class=\"panels\">\n", escaped(name));
        let of: Vec<&Row> = table.iter().copied().filter(|row| row.scheme == id).collect();
        for panel in unique(of.iter().map(|row| (row.mesh.as_str(), row.level))) {
            let rows: Vec<&Row> = of.iter().copied().filter(|row| (row.mesh.as_str(), row.level) == panel).collect();
            out += &bar_panel(&engines, &rows, range);
        }
        out += "</div>\n";
    }
    out += "<h2>How cost grows</h2>\n<p>Milliseconds by the faces of the last level. Where a curve ends before its neighbours, a run \
            would have taken too long or too much memory.</p>\n<div class=\"panels wide\">\n";
    for (series, what) in
        [("levels", "the creature to levels 0 to 7"), ("cages", "cages of 6 faces to a million, two levels")]
    {
        let rows: Vec<&Row> = report.series(series).collect();
        for id in unique(rows.iter().map(|row| row.scheme.as_str())) {
            let name = scheme(id).map_or(id, |entry| entry.info.name);
            let of: Vec<&Row> = rows.iter().copied().filter(|row| row.scheme == id).collect();
            out += &curve_panel(&engines, &format!("{name}, {what}"), &of);
        }
    }
    out += "</div>\n<h2>All figures</h2>\n";
    out += &all(report);
    out + "</body>\n</html>\n"
}

/// Engines with rows, by the order in which they came: word and name.
fn engines(report: &Report) -> Vec<(&str, &str)> {
    let known = unique(report.rows.iter().map(|row| row.engine.as_str()));
    let name = |id: &str| report.rows.iter().find(|row| row.engine == id).map_or("", |row| row.name.as_str());
    known.into_iter().map(|id| (id, name(id))).collect()
}

fn class(engines: &[(&str, &str)], id: &str) -> String {
    format!("e{}", engines.iter().position(|e| e.0 == id).unwrap_or_default() % 10)
}

fn unique<T: PartialEq>(items: impl Iterator<Item = T>) -> Vec<T> {
    let mut seen = Vec::new();
    items.for_each(|item| {
        if !seen.contains(&item) {
            seen.push(item);
        }
    });
    seen
}

fn facts(report: &Report) -> String {
    let m = &report.machine;
    let cores = format!("{}, {}", m.cores, m.caches);
    let stores = format!("{:.1} GB/s natively, {} memory", report.measured_bandwidth / 1e9, report.memory);
    let elsewhere = unique(
        report
            .rows
            .iter()
            .filter(|r| r.measured_bandwidth != report.measured_bandwidth)
            .map(|r| format!("; {:.1} GB/s in the browser", r.measured_bandwidth / 1e9)),
    );
    let stores = stores + &elsewhere.concat();
    let mut out = String::from("<dl>\n");
    for (what, is) in [
        ("Processor", &m.cpu),
        ("Cores, caches", &cores),
        ("System", &m.system),
        ("Compilers", &m.compilers),
        ("Browser", &m.browser),
        ("Adapter", &m.adapter),
        ("Plain stores", &stores),
        ("Date", &m.date),
    ] {
        if !is.is_empty() {
            _ = writeln!(out, "<dt>{what}</dt><dd>{}</dd>", escaped(is));
        }
    }
    out += "</dl>\n<ul class=\"notes\">\n";
    let how = [
        "All engines take turns, round by round, on the same inputs; figures are medians.",
        "Before an engine's time counts its result is held against Limn's: numbers of vertices and faces, and all positions within \
         1e-5 whatever their numbering (above two million faces: their means and squares).",
        if report.rows.iter().any(|row| row.clock == "wall") {
            "Native times are what the thread computed, a browser's are time that passed."
        } else {
            "Times are what the thread computed, in the browser too."
        },
        "In a browser engines run until they are compiled well before they are timed.",
        "Memory is the most that one run holds beyond its input; in WebAssembly, by how much its memory grew. “Beyond” is what of that is \
         not output: 12 bytes a point (and as many a normal), 4 a corner.",
    ];
    let quick = "This was a quick run: fewer rows, fewer rounds, curves up to five million faces.";
    let took = format!("It took {} s.", report.seconds);
    let notes = how.into_iter().chain(report.quick.then_some(quick)).chain([took.as_str()]);
    notes.for_each(|note| _ = writeln!(out, "<li>{}</li>", escaped(note)));
    _ = write!(out, "</ul>\n<details><summary>What is not there, and why ({})</summary>\n", report.notes.len());
    out += "<ul class=\"notes\">\n";
    report.notes.iter().for_each(|note| _ = writeln!(out, "<li>{}</li>", escaped(note)));
    out + "</ul></details>\n"
}

fn legend(engines: &[(&str, &str)]) -> String {
    let mut out = String::from("<p class=\"legend\">");
    for (id, name) in engines {
        let (class, name) = (class(engines, id), escaped(name));
        _ = write!(
            out,
            "<span><svg viewBox=\"0 0 12 12\"><rect class=\"{class}\" width=\"12\" height=\"12\"/></svg>{name}</span>"
        );
    }
    out +=
        "<span><svg viewBox=\"0 0 12 12\"><path class=\"limit\" d=\"M0 6H12\"/></svg>storing the result</span></p>\n";
    out
}

fn bar_panel(engines: &[(&str, &str)], rows: &[&Row], range: [f64; 2]) -> String {
    let Some(first) = rows.iter().find(|row| row.engine == LIMN).or(rows.first()) else { return String::new() };
    let title = format!("{}, level {}: {} faces", first.mesh, first.level, grouped(first.faces));
    let bar = |row: &&Row| Bar {
        class: class(engines, &row.engine),
        label: row.name.clone(),
        value: row.ns_per_face,
        mark: if row.other_rule { "*".to_owned() } else { String::new() },
    };
    let plot = bars(&title, &rows.iter().map(bar).collect::<Vec<_>>(), first.limit_ns_per_face, range);
    let star = if rows.iter().any(|row| row.other_rule) { " · * another rule under this name" } else { "" };
    format!("<figure><figcaption>{}{star}</figcaption>{plot}</figure>\n", escaped(&title))
}

fn curve_panel(engines: &[(&str, &str)], title: &str, rows: &[&Row]) -> String {
    let curve = |(id, name): &(&str, &str)| Curve {
        class: class(engines, id),
        label: name.to_string(),
        points: rows.iter().filter(|r| r.engine == *id).map(|r| [r.faces as f64, r.median_ms]).collect(),
    };
    let all: Vec<Curve> = engines.iter().map(curve).collect();
    let stores = rows.iter().filter(|row| row.engine == LIMN);
    let limit: Vec<_> = stores.map(|r| [r.faces as f64, r.limit_ns_per_face * r.faces as f64 * 1e-6]).collect();
    let plot = curves(title, "faces of the last level", "ms", &all, &limit);
    format!("<figure><figcaption>{}</figcaption>{plot}</figure>\n", escaped(title))
}

/// Every row; a line each, for those who read sources.
fn all(report: &Report) -> String {
    let mut out = String::from("<details><summary>Every row");
    _ = write!(
        out,
        " ({}); the same as <a href=\"results.json\">JSON</a></summary>\n<div class=\"scroll\"><table>",
        report.rows.len()
    );
    let heads = [
        "Scheme",
        "Cage",
        "Level",
        "Faces",
        "Engine",
        "Stores",
        "Median ms",
        "ns a face",
        "Limit",
        "Ratio",
        "Peak MB",
        "B a face",
        "Beyond",
    ];
    let heads: String = heads.iter().map(|head| format!("<th>{head}</th>")).collect();
    _ = write!(out, "<thead><tr>{heads}</tr></thead><tbody>");
    for row in &report.rows {
        let [each, beyond] = row.bytes_per_face();
        let peak = row.peak_bytes.map(|bytes| bytes as f64 / 1e6);
        let [peak, each, beyond] = [peak, each, beyond].map(|x| x.map_or("–".to_owned(), figures));
        let ratio = row.times_limn.map_or("–".to_owned(), figures);
        let name = row.name.as_str();
        let words = [&row.scheme, &row.mesh].map(|word| format!("<td>{}</td>", escaped(word))).concat();
        let cells = [
            figures(row.median_ms),
            figures(row.ns_per_face),
            figures(row.limit_ns_per_face),
            ratio,
            peak,
            each,
            beyond,
        ];
        let cells = cells.map(|cell| format!("<td>{cell}</td>")).concat();
        let (level, faces, name, stores) = (row.level, grouped(row.faces), escaped(name), &row.stores);
        _ = write!(
            out,
            "<tr>{words}<td>{level}</td><td>{faces}</td><td class=\"word\">{name}</td><td class=\"word\">{stores}</td>{cells}</tr>"
        );
    }
    out + "</tbody></table></div></details>\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::tests::row;

    #[test]
    fn a_page_has_a_panel_a_cage_a_curve_a_series_and_every_row() {
        let mut report = Report { measured_bandwidth: 1e10, ..Report::default() };
        report.machine.cpu = "A <fast> one".to_owned();
        report.notes = vec!["one.is.cut".to_owned()];
        report.rows = vec![
            row(LIMN, "table", 2_000_000, 30.0),
            row("peer", "table", 2_000_000, 300.0),
            row(LIMN, "levels", 100, 0.01),
            row(LIMN, "levels", 400, 0.02),
            row("peer", "levels", 100, 0.1),
        ];
        let page = page(&report);
        assert!(page.contains("A &lt;fast> one") && page.contains("<li>one.is.cut</li>"));
        assert_eq!(page.matches("<figure>").count(), 2);
        assert_eq!(page.matches("<circle").count(), 3);
        assert_eq!(page.matches("<tr>").count(), 1 + 5);
        // Both engines keep their colour in bars, curves and the legend.
        assert_eq!((page.matches("class=\"e0\"").count(), page.matches("class=\"e1\"").count()), (3, 3));
        assert!(page.lines().count() < 400, "plots are lines");
    }
}
