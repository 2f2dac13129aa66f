//! How cost grows: one cage to levels 0 to 7, and cages of 6 faces to a million to one level.
//!
//! ```text
//!   levels   creature ── 0, 1, 2 ... 7              cages   cube, torus 4x4, 8x8 ... 1024x1024 ── level 2
//! ```
//!
//! Every engine stops where a run of it would take too long; a note says where. Limit: level 0 is connecting the faces, which
//! stencil tables have no word for.

use crate::engines::Job;
use crate::report::{Row, figures};
use crate::rounds::Bench;
use crate::rows::print;
use limn_kernel::trial::cages::cage;
use limn_mesh::{Soup, grouped, triangulate_soup};

/// The level that cages are refined to.
const LEVEL: u32 = 2;
/// The highest level of the creature.
const HIGHEST: u32 = 7;
/// The largest cage's cells along one side.
const LARGEST: u32 = 1024;
/// A quick run ends where a level has more faces than this, and takes every second level and cage.
const QUICK: f64 = 2e6;

/// Measures and prints both curves of both schemes that every engine has.
///
/// # Errors
/// One sentence, if Limn does not take a cage.
pub fn run(bench: &mut Bench, word: &str, json: bool, quick: bool) -> Result<(), String> {
    let step = if quick { 2 } else { 1 };
    for (id, model, ring, names) in [
        ("catmull-clark", "creature", "torus", ["cube", "torus"]),
        ("loop", "creature-triangles", "triangles", ["cube, triangles", "torus, triangles"]),
    ] {
        if format!("{id} levels").contains(word) {
            let name = if id == "loop" { "creature, triangles" } else { "creature" };
            let soup = cage(model, 0);
            let few = |level: &u32| !quick || soup.face_count() as f64 * 4f64.powi(*level as i32) < QUICK;
            let jobs = (u32::from(quick)..=HIGHEST)
                .step_by(step)
                .filter(few)
                .map(|level| (name.to_owned(), soup.clone(), level));
            series(bench, "levels", id, jobs, json)?;
        }
        if format!("{id} cages").contains(word) {
            let cube = if id == "loop" { triangulate_soup(&cage("cube", 0)).0 } else { cage("cube", 0) };
            let per_cell = if id == "loop" { 2.0 } else { 1.0 };
            let few = |k: &u32| !quick || per_cell * 4f64.powi((k + LEVEL) as i32) < QUICK;
            let sizes = (2..=LARGEST.ilog2()).step_by(step).filter(few);
            let rings = sizes.map(|k| (format!("{} {n}x{n}", names[1], n = 1 << k), cage(ring, 1 << k)));
            let cages = std::iter::once((names[0].to_owned(), cube)).chain(rings);
            series(bench, "cages", id, cages.map(|(name, soup)| (name, soup, LEVEL)), json)?;
        }
    }
    Ok(())
}

fn series(
    bench: &mut Bench,
    series: &str,
    id: &str,
    jobs: impl Iterator<Item = (String, Soup, u32)>,
    json: bool,
) -> Result<(), String> {
    let names = bench.names();
    if !json {
        println!("\nhow cost grows, {id}, {series}: ms, and in the first column what storing the level takes");
        let heads: String = names.iter().map(|(_, name)| format!("{name:>19}")).collect();
        println!("  {:<24}{:>2}{:>12}{:>10}{heads}", "cage", "L", "faces", "limit");
    }
    for (mesh, soup, level) in jobs {
        let rows = bench.measure(series, &mesh, &Job::new(id, level, &soup))?;
        let Some(first) = rows.first() else { continue };
        if json {
            rows.iter().for_each(|row| print(true, row, ""));
            continue;
        }
        let limit = first.limit_ns_per_face * first.faces as f64 * 1e-6;
        let cell = |id: &str| {
            let found: Option<&Row> = rows.iter().find(|row| row.engine == id);
            found.map_or("-".to_owned(), |row| figures(row.median_ms))
        };
        let cells: String = names.iter().map(|(id, _)| format!("{:>19}", cell(id))).collect();
        println!("  {mesh:<24}{level:>2}{:>12}{:>10}{cells}", grouped(first.faces), figures(limit));
    }
    Ok(())
}
