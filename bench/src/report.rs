//! What was measured, a row an engine and a job: for people as text, for programs as one JSON object a line.
//!
//! ```json
//! {"series":"table","engine":"limn","scheme":"loop","mesh":"sphere, triangles","level":2,"faces":1605632,"median_ms":20.1,
//!  "ns_per_face":12.5,"peak_bytes":48000000,"measured_bandwidth":10200000000.0,"limit_ns_per_face":1.8, ...}
//! ```

use crate::machine::Machine;
use limn_mesh::grouped;
use serde::{Deserialize, Serialize};

/// What a row stores, in the words that its field has: what every library makes.
pub const WITHOUT: &str = "points, corners";
/// And with the unit normals that a picture needs: Limn alone.
pub const WITH_NORMALS: &str = "points, normals, corners";

/// What rows stored before there was a word for it.
fn without() -> String {
    WITHOUT.to_owned()
}

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
    /// What is stored: `points, corners` or `points, normals, corners`.
    #[serde(default = "without")]
    pub stores: String,
    /// Bytes of that: 12 a point and a normal, 4 a corner.
    #[serde(default)]
    pub output_bytes: u64,
    /// The middle of all runs.
    pub median_ms: f64,
    /// The shortest.
    pub best_ms: f64,
    /// How many samples there were.
    pub samples: usize,
    /// The median by the level's faces.
    pub ns_per_face: f64,
    /// How many times Limn's time for storing the same it is; none if Limn was not run.
    pub times_limn: Option<f64>,
    /// The most that a run holds beyond its input; none where that cannot be told.
    pub peak_bytes: Option<u64>,
    /// Bytes a second that plain stores reached where the engine runs, in the same run of the benchmark.
    pub measured_bandwidth: f64,
    /// What plain stores of the output take at that.
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

impl Row {
    /// Bytes a face that a run holds at most beyond its input, and of that beyond its output: none where the peak is not known, or less than
    /// the output, as where a module's memory had room left.
    pub fn bytes_per_face(&self) -> [Option<f64>; 2] {
        let each = |bytes: u64| bytes as f64 / self.faces as f64;
        let over =
            self.peak_bytes.filter(|_| self.output_bytes > 0).and_then(|peak| peak.checked_sub(self.output_bytes));
        [self.peak_bytes.map(each), over.map(each)]
    }
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
        "  {:<28}{:>11}{:>11}{:>11}{:>9}{:>11}{:>10}{:>8}",
        "engine", "median ms", "best ms", "ns a face", "ratio", "peak MB", "B a face", "beyond"
    )
}

/// A row as a line.
pub fn line(row: &Row) -> String {
    let ratio = row.times_limn.map_or(String::new(), |x| format!("x{}", figures(x)));
    let star = if row.other_rule { "*" } else { " " };
    let peak = row.peak_bytes.map_or("-".to_owned(), |bytes| format!("{:.1}", bytes as f64 / 1e6));
    let [all, beyond] = row.bytes_per_face().map(|bytes| bytes.map_or("-".to_owned(), |bytes| format!("{bytes:.0}")));
    format!(
        "  {:<28}{:>11}{:>11}{:>11}{ratio:>8}{star}{peak:>11}{all:>10}{beyond:>8}",
        row.name,
        figures(row.median_ms),
        figures(row.best_ms),
        figures(row.ns_per_face),
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
            stores: without(),
            output_bytes: 18 * faces,
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
            ("stores", false),
            ("output_bytes", true),
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
        assert_eq!(
            text.split_whitespace().collect::<Vec<_>>(),
            ["PEER", "123", "111", "61.7", "x2.00", "60.0", "30", "12"]
        );
        assert_eq!(["1234", "12.3", "1.23", "0.123"], [1234.4, 12.34, 1.234, 0.1234].map(figures));
    }
}
