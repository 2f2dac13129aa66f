//! The table: which schemes on which cages to which levels, what each may take, and what creases may add.

use crate::clock::{median, seconds};
use crate::engines::{Job, LIMN, SHADED, refined};
use crate::report::{self, Row};
use crate::rounds::Bench;
use limn_kernel::trial::cages::{self, cage};
use limn_mesh::Soup;
use std::hint::black_box;

/// By how many per cent creases may add to a face's time.
const MORE_FOR_CREASES: f64 = 30.0;
/// Bytes a face that Limn may hold at most beyond its input and its output.
const MOST_BEYOND: f64 = 30.0;
/// What a face may take, in ns: by scheme.
const BUDGETS: [(&str, f64); 7] = [
    ("catmull-clark", 28.0),
    ("loop", 28.0),
    ("linear", 28.0),
    ("sqrt3", 28.0),
    ("doo-sabin", 40.0),
    ("butterfly", 40.0),
    ("modified-butterfly", 40.0),
];
/// The rows of a quick run.
const QUICK: [(&str, &str); 8] = [
    ("catmull-clark", "torus 64x64"),
    ("catmull-clark", "torus 64x64, creases"),
    ("linear", "torus 64x64"),
    ("loop", "torus, triangles"),
    ("loop", "sphere, triangles"),
    ("sqrt3", "sphere, triangles"),
    ("doo-sabin", "torus 64x64"),
    ("modified-butterfly", "sphere, triangles"),
];

/// How the rows are shown and chosen.
pub struct Table<'a> {
    /// What runs them.
    pub bench: &'a mut Bench,
    /// Rows whose scheme, cage and level contain this.
    pub word: String,
    /// Whether only a few are run.
    pub quick: bool,
    /// Whether rows are printed as JSON.
    pub json: bool,
    /// What took longer than it may, a sentence each.
    pub missed: Vec<String>,
}

impl Table<'_> {
    /// All rows.
    ///
    /// # Errors
    /// One sentence, if Limn does not take one of them.
    pub fn run(&mut self) -> Result<(), String> {
        let quads = cage("creature", 0);
        let triangles = cage("creature-triangles", 0);
        let torus = cages::torus(64, 64);
        let (wide, wide_rings) = (cages::torus(256, 256), cages::rings(256, 256));
        let shuffled = cages::shuffled(&wide);
        let mixed = cages::mixed(256, 256);
        // A quick run has a quarter of the faces: software takes the place of a GPU within its time, too.
        let (less, rows) = if self.quick { (1, 56) } else { (0, 112) };
        let sphere = cages::sphere(rows);
        let triangulated = cages::torus_triangles(64, 64);
        self.creases("catmull-clark", "torus 64x64", &torus, cages::rings(64, 64), 4 - less)?;
        // At low levels a larger part of the vertices lies on creases.
        self.creases("catmull-clark", "torus 256x256", &wide, wide_rings.clone(), 2)?;
        self.row("catmull-clark", "torus 256x256 shuffled", &shuffled, 3)?;
        self.row("catmull-clark", "mixed polygons", &mixed, 2)?;
        self.row("catmull-clark", "creature", &quads, 5)?;
        self.row("linear", "torus 64x64", &torus, 4 - less)?;
        self.row("linear", "sphere, triangles", &sphere, 2)?;
        self.row("linear", "creature", &quads, 5)?;
        self.row("loop", "sphere, triangles", &sphere, 2)?;
        self.creases("loop", "torus, triangles", &triangulated, cages::rings(64, 64), 4 - less)?;
        self.creases("loop", "triangles 256x256", &cages::torus_triangles(256, 256), wide_rings, 2)?;
        self.row("loop", "creature, triangles", &triangles, 4)?;
        self.row("sqrt3", "sphere, triangles", &sphere, 3)?;
        self.row("sqrt3", "creature, triangles", &triangles, 5)?;
        self.row("doo-sabin", "torus 64x64", &torus, 4 - less)?;
        self.row("doo-sabin", "torus 256x256 shuffled", &shuffled, 2)?;
        self.row("doo-sabin", "mixed polygons", &mixed, 2)?;
        self.row("doo-sabin", "creature", &quads, 4)?;
        for id in ["butterfly", "modified-butterfly"] {
            self.row(id, "sphere, triangles", &sphere, 2)?;
            self.row(id, "creature, triangles", &triangles, 4)?;
        }
        Ok(())
    }

    fn selects(&self, id: &str, name: &str, level: u32) -> bool {
        let wanted = !self.quick || QUICK.contains(&(id, name));
        wanted && format!("{id} {name} {level}").contains(&self.word)
    }

    /// A row with creases and one without, and what they add.
    fn creases(
        &mut self,
        id: &str,
        name: &str,
        smooth: &Soup,
        creases: Vec<([u32; 2], f32)>,
        level: u32,
    ) -> Result<(), String> {
        let mut creased = smooth.clone();
        creased.marks.creases = creases;
        let before = self.row(id, name, smooth, level)?;
        let named = format!("{name}, creases");
        if !self.selects(id, &named, level) {
            return Ok(());
        }
        let one = |soup: &Soup| refined(&Job::new(id, 1, soup), None).map(|made| made.points);
        if one(smooth)? == one(&creased)? {
            self.say(&format!("{id}, {named}: not measured, this scheme does not honour creases"));
            return Ok(());
        }
        let after = self.row(id, &named, &creased, level)?;
        if let (Some(before), Some(after)) = (before, after) {
            let more = (after / before - 1.0) * 100.0;
            self.say(&format!("  creases add {more:.0}% (at most {MORE_FOR_CREASES:.0}%)"));
            if more > MORE_FOR_CREASES {
                self.missed.push(format!("creases of {id} on {name}: {more:.0}% more"));
            }
        }
        Ok(())
    }

    /// Measures and prints a row, and returns Limn's ns a face.
    fn row(&mut self, id: &str, name: &str, soup: &Soup, level: u32) -> Result<Option<f64>, String> {
        if !self.selects(id, name, level) {
            return Ok(None);
        }
        let rows = self.bench.measure("table", name, &Job::new(id, level, soup))?;
        let Some(limn) = rows.iter().find(|row| row.engine == LIMN) else { return Ok(None) };
        let ns = limn.ns_per_face;
        let budget = BUDGETS.iter().find(|b| b.0 == id).map(|b| b.1);
        if budget.is_some_and(|budget| ns > budget) {
            self.missed.push(format!("{id} on {name}: {ns:.1} ns"));
        }
        for row in rows.iter().filter(|row| [LIMN, SHADED].contains(&row.engine.as_str())) {
            if let Some(beyond) = row.bytes_per_face()[1].filter(|beyond| *beyond > MOST_BEYOND) {
                let name = &row.name;
                self.missed
                    .push(format!("{id} on {mesh}, {name}: {beyond:.0} B a face beyond its output", mesh = row.mesh));
            }
        }
        self.say(&format!("\n{}", report::heading(limn)));
        for row in &rows {
            let mark = match budget {
                Some(budget) if row.engine == LIMN && ns <= budget => format!("  budget {budget:.0} met"),
                Some(budget) if row.engine == LIMN => format!("  budget {budget:.0} MISSED"),
                _ => String::new(),
            };
            print(self.json, row, &(report::line(row) + &mark));
        }
        Ok(Some(ns))
    }

    fn say(&self, text: &str) {
        if !self.json {
            println!("{text}");
        }
    }
}

/// A row for programs or for people.
pub fn print(json: bool, row: &Row, line: &str) {
    match serde_json::to_string(row) {
        Ok(text) if json => println!("{text}"),
        _ => println!("{line}"),
    }
}

/// A. Powell, "Surface Subdivision" (2003): seconds for one step of any of his schemes on about so many triangles, on
/// his laptop; most of it went to growing arrays. Beside it one step of Butterfly with smooth normals, from indexed faces.
///
/// # Errors
/// One sentence, if there is no Butterfly.
pub fn powell() -> Result<(), String> {
    println!("\none step of Butterfly with normals   Powell, 2003    Limn, median      ratio");
    for (n, m, his) in [(15, 10, 4.3), (25, 20, 22.7), (50, 30, 74.2)] {
        let soup = cages::torus_triangles(n, m);
        let job = Job::new("butterfly", 1, &soup);
        let once = || refined(&job, None).map(|made| drop(black_box(made.normals())));
        once()?;
        let times: Vec<f64> = (0..201).map(|_| seconds(|| drop(once()))).collect();
        let (ours, triangles) = (median(&times), soup.face_count());
        println!("{triangles:>18} triangles {his:>18.1} s {:>12.3} ms {:>10.0}", ours * 1e3, his / ours);
    }
    Ok(())
}
