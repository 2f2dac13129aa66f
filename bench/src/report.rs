//! What was measured, a row an engine and a job: for people as text, for programs as one JSON object a line.
//!
//! ```json
//! {"series":"table","engine":"limn","scheme":"loop","mesh":"sphere, triangles","level":2,"faces":1605632,"median_ms":20.1,
//!  "ns_per_face":12.5,"peak_bytes":48000000,"measured_bandwidth":10200000000.0,"limit_ns_per_face":1.8, ...}
//! ```

use crate::machine::Machine;
use limn_mesh::grouped;
use serde::{Deserialize, Serialize};

/// One engine on one job.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// What it is part of: `table`, `levels` or `cages`.
    pub series: String,
    /// The engine's word.
    pub engine: String,
    /// What people call it.
    pub name: String,
    /// The scheme's id.
    pub scheme: String,
    /// The cage.
    pub mesh: String,
    /// How many faces the cage has.
    pub cage_faces: u64,
    /// The level.
    pub level: u32,
    /// How many faces the level has.
    pub faces: u64,
    /// The middle of all runs.
    pub median_ms: f64,
    /// The shortest.
    pub best_ms: f64,
    /// How many samples there were.
    pub samples: usize,
    /// The median by the level's faces.
    pub ns_per_face: f64,
    /// How many times Limn's time it is; none if Limn was not run.
    pub times_limn: Option<f64>,
    /// The most that a run holds beyond its input; none where that cannot be told.
    pub peak_bytes: Option<u64>,
    /// Bytes a second that plain stores reached where the engine runs, in the same run of the benchmark.
    pub measured_bandwidth: f64,
    /// What storing the level's points and corners takes at that.
    pub limit_ns_per_face: f64,
    /// `thread`: time that the thread computed. `wall`: time that passed.
    pub clock: String,
    /// Whether the engine has another rule under the scheme's name, so that only counts were compared.
    pub other_rule: bool,
    /// The machine in one line.
    pub machine: String,
}

/// A whole run.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Report {
    /// Where.
    pub machine: Machine,
    /// How memory was: `warm` or `fresh`.
    pub memory: String,
    /// Whether it was a quick run, with fewer rows and rounds.
    pub quick: bool,
    /// How long it took.
    pub seconds: f64,
    /// Bytes a second of plain stores, natively.
    pub measured_bandwidth: f64,
    /// What a reader has to know, a sentence each.
    pub notes: Vec<String>,
    /// What was measured.
    pub rows: Vec<Row>,
}

impl Report {
    /// Rows of a series.
    pub fn series<'a>(&'a self, series: &'a str) -> impl Iterator<Item = &'a Row> {
        self.rows.iter().filter(move |row| row.series == series)
    }
}

/// The line above the rows of a job.
pub fn heading(row: &Row) -> String {
    format!(
        "{}, {}, level {}: {} faces, limit {:.1} ns",
        row.scheme,
        row.mesh,
        row.level,
        grouped(row.faces),
        row.limit_ns_per_face
    )
}

/// What stands above all.
pub fn columns() -> String {
    format!(
        "  {:<20}{:>11}{:>11}{:>11}{:>9}{:>11}{:>9}",
        "engine", "median ms", "best ms", "ns a face", "ratio", "peak MB", "B a face"
    )
}

/// A row as a line.
pub fn line(row: &Row) -> String {
    let ratio = row.times_limn.map_or(String::new(), |x| format!("x{}", figures(x)));
    let star = if row.other_rule { "*" } else { " " };
    let bytes = row.peak_bytes.map_or([String::from("-"), String::from("-")], |bytes| {
        [format!("{:.1}", bytes as f64 / 1e6), format!("{:.0}", bytes as f64 / row.faces as f64)]
    });
    format!(
        "  {:<20}{:>11}{:>11}{:>11}{ratio:>8}{star}{:>11}{:>9}",
        row.name,
        figures(row.median_ms),
        figures(row.best_ms),
        figures(row.ns_per_face),
        bytes[0],
        bytes[1]
    )
}

/// A number with about three figures.
pub fn figures(x: f64) -> String {
    match x.abs() {
        a if a >= 100.0 => format!("{x:.0}"),
        a if a >= 10.0 => format!("{x:.1}"),
        a if a >= 1.0 => format!("{x:.2}"),
        _ => format!("{x:.3}"),
    }
}

#[cfg(test)]
pub mod tests {
    use super::*;

    /// A row with figures that are easy to find.
    pub fn row(engine: &str, series: &str, faces: u64, ms: f64) -> Row {
        Row {
            series: series.to_owned(),
            engine: engine.to_owned(),
            name: engine.to_uppercase(),
            scheme: "loop".to_owned(),
            mesh: "sphere, triangles".to_owned(),
            cage_faces: faces / 16,
            level: 2,
            faces,
            median_ms: ms,
            best_ms: ms * 0.9,
            samples: 5,
            ns_per_face: ms * 1e6 / faces as f64,
            times_limn: Some(2.0),
            peak_bytes: Some(30 * faces),
            measured_bandwidth: 1e10,
            limit_ns_per_face: 1.8,
            clock: "thread".to_owned(),
            other_rule: false,
            machine: "a machine, 2 cores".to_owned(),
        }
    }

    #[test]
    fn a_json_row_has_every_field_and_comes_back() {
        let row = row("limn", "table", 1000, 0.5);
        let text = serde_json::to_string(&row).unwrap();
        assert!(!text.contains('\n'), "one line");
        let value: serde_json::Value = serde_json::from_str(&text).unwrap();
        for (field, number) in [
            ("engine", false),
            ("scheme", false),
            ("level", true),
            ("faces", true),
            ("median_ms", true),
            ("ns_per_face", true),
            ("peak_bytes", true),
            ("measured_bandwidth", true),
            ("machine", false),
        ] {
            assert_eq!(value[field].is_number(), number, "{field}");
            assert_eq!(value[field].is_string(), !number, "{field}");
        }
        assert_eq!(value["ns_per_face"], 500.0);
        assert_eq!(serde_json::from_str::<Row>(&text).unwrap(), row);
    }

    #[test]
    fn a_line_has_its_figures() {
        let text = line(&row("peer", "table", 2_000_000, 123.4));
        assert_eq!(text.split_whitespace().collect::<Vec<_>>(), ["PEER", "123", "111", "61.7", "x2.00", "60.0", "30"]);
        assert_eq!(["1234", "12.3", "1.23", "0.123"], [1234.4, 12.34, 1.234, 0.1234].map(figures));
    }
}
