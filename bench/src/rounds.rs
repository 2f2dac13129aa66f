//! Rounds: all engines on one job, in turn, after their results were held against each other.
//!
//! ```text
//!   check   Limn's surface  ==  every engine's?      one that differs has no figure, and the run fails at its end
//!   round 1   Limn, peer, peer, wasm ...             so that whatever else the machine does meets all of them
//!   round 2   Limn, peer, peer, wasm ...
//!   ...       medians; then one run each with memory counted
//! ```
//!
//! Times are compared among those that store the same: Limn with normals has a row of its own. An engine that would take too long or too much memory, by what it took for fewer faces, is left out, and a note says so. A
//! run that is too short for a clock is repeated. Large levels are compared by counts and moments alone: the same engines
//! have been compared point by point on smaller ones.

use crate::engines::{Absent, Differs, Engine, GENERAL, Job, LIMN, Run, SHADED, refined};
use crate::machine::Machine;
use crate::report::{Report, Row, WITH_NORMALS, WITHOUT};
use crate::{clock, memory};
use limn_kernel::trial::same::{Sorted, Surface};
use limn_kernel::trial::surface;
use limn_mesh::grouped;
use std::collections::{BTreeMap, BTreeSet};
use std::time::Instant;

/// How far apart points of equal work may lie, in units of meshes that are two to three units in size.
const TOLERANCE: f64 = 1e-5;
/// Up to so many faces every point is compared.
const COMPARED: usize = 2_000_000;
/// An engine without a figure for the scheme is tried on fewer faces first where there are more than this.
const TRIED: usize = 100_000;

/// How long things may take.
#[derive(Clone, Copy)]
pub struct Pace {
    /// Rounds a job, half as many where there are a million faces.
    pub rounds: usize,
    /// Seconds that an engine may use for a job before it skips rounds. It has three in any case.
    pub patience: f64,
    /// Seconds that one run may take.
    pub longest: f64,
    /// Seconds after which no further job is begun.
    pub whole: f64,
}

impl Pace {
    /// As exact as it gets.
    pub const FULL: Pace = Pace { rounds: 21, patience: 0.4, longest: 4.0, whole: f64::INFINITY };
    /// Ends within three minutes: a job takes some ten seconds at most.
    pub const QUICK: Pace = Pace { rounds: 5, patience: 0.2, longest: 0.8, whole: 160.0 };
}

/// Engines, and what is known by now.
pub struct Bench {
    engines: Vec<Box<dyn Engine>>,
    pace: Pace,
    begun: Instant,
    /// Jobs that came too late.
    late: usize,
    /// Seconds and bytes a face, by engine and scheme, as last seen.
    costs: BTreeMap<(String, String), (f64, f64)>,
    left_out: BTreeSet<(String, String)>,
    /// By engine, jobs on which its result is another for a reason that is known.
    lost: BTreeMap<String, Vec<String>>,
    /// Everything measured and noted.
    pub report: Report,
    /// Engines whose result is another, a sentence each.
    pub differ: Vec<String>,
}

/// An engine that takes part in the rounds.
struct Entry<'a> {
    row: Row,
    run: Box<dyn Run + 'a>,
    repeats: u32,
    times: Vec<f64>,
}

impl Bench {
    /// Measures what stores reach, and begins.
    pub fn new(engines: Vec<Box<dyn Engine>>, machine: Machine, pace: Pace) -> Self {
        let report = Report { machine, measured_bandwidth: clock::bandwidth(), ..Report::default() };
        Bench {
            engines,
            pace,
            begun: Instant::now(),
            late: 0,
            costs: BTreeMap::new(),
            left_out: BTreeSet::new(),
            lost: BTreeMap::new(),
            report,
            differ: Vec::new(),
        }
    }

    /// Names of the engines that have curves, in their order.
    pub fn names(&self) -> Vec<(String, String)> {
        self.engines.iter().filter(|e| !is_twin(e.id())).map(|e| (e.id().to_owned(), e.name().to_owned())).collect()
    }

    /// Runs a job on every engine that takes it; the rows, Limn's first, are kept in the report as well. None where time is up.
    ///
    /// # Errors
    /// One sentence, if Limn itself does not take it.
    pub fn measure(&mut self, series: &str, mesh: &str, job: &Job<'_>) -> Result<Vec<Row>, String> {
        if self.begun.elapsed().as_secs_f64() > self.pace.whole {
            self.late += 1;
            return Ok(Vec::new());
        }
        let ours = refined(job, None)?;
        let faces = ours.faces.count();
        let plain = ours.points.len() as u64 * 12 + ours.faces.corners().len() as u64 * 4;
        let bent = plain + ours.points.len() as u64 * 12;
        let reference = Reference::new(job, surface(&ours));
        drop(ours);
        self.try_strangers(job, faces);

        let machine = self.report.machine.line();
        let pace = self.pace;
        let mut sentences = Vec::new();
        let lost = &mut self.lost;
        let mut entries: Vec<Entry<'_>> = Vec::new();
        for engine in &mut self.engines {
            if is_twin(engine.id()) && series != "table" {
                continue;
            }
            let (stores, output_bytes) = if engine.shaded() { (WITH_NORMALS, bent) } else { (WITHOUT, plain) };
            let (id, name) = (engine.id().to_owned(), engine.name().to_owned());
            let key = (id.clone(), job.id.to_owned());
            let (seconds, bytes) = self.costs.get(&key).copied().unwrap_or_default();
            let (seconds, bytes) = (seconds * faces as f64, bytes * faces as f64);
            let too_long = seconds > pace.longest;
            let too_large = memory::available().is_some_and(|free| bytes > 0.6 * free as f64);
            if too_long || too_large {
                let would = if too_long { format!("{seconds:.1} s") } else { format!("{:.1} GB", bytes / 1e9) };
                // Sizes of a curve rise: where it ends is enough.
                let part = if series == "table" { mesh } else { series };
                if self.left_out.insert((format!("{id} {part}"), job.id.to_owned())) {
                    let at = format!("{mesh}, level {}, {} faces", job.level, grouped(faces as u64));
                    self.report
                        .notes
                        .push(format!("{name} is left out at {}, {at}: a run would take {would}.", job.id));
                }
                continue;
            }
            let differs = engine.differs(job.id);
            let (clock, sample) = (engine.clock().to_owned(), engine.sample());
            let excuse = engine.excuse().map(str::to_owned);
            let bandwidth = engine.bandwidth().unwrap_or(self.report.measured_bandwidth);
            let mut run = match engine.prepare(job) {
                Ok(run) => run,
                Err(Absent::Scheme) => continue,
                Err(Absent::Failed(why)) => {
                    sentences.push(format!("{name} fails on {}, {mesh}, level {}: {why}.", job.id, job.level));
                    continue;
                }
            };
            let (repeats, first) = match fill(&mut *run, sample) {
                Ok(found) => found,
                Err(why) => {
                    sentences.push(format!("{name} fails on {}, {mesh}, level {}: {why}.", job.id, job.level));
                    continue;
                }
            };
            // Whether or not it counts: the next job is larger.
            self.costs.insert(key, (first / faces as f64, bytes / faces as f64));
            let checked = if id == GENERAL { Ok(()) } else { reference.check(&mut *run, differs) };
            match (checked, &excuse) {
                (Ok(()), _) => {}
                (Err(Check::Failed(why)), _) => {
                    sentences.push(format!("{name} fails on {}, {mesh}, level {}: {why}.", job.id, job.level));
                    continue;
                }
                (Err(Check::Differs(why)), None) => {
                    self.differ.push(format!("{}, {mesh}, level {}: Limn and {name} differ: {why}", job.id, job.level));
                    continue;
                }
                (Err(Check::Differs(why)), Some(_)) => {
                    lost.entry(id).or_default().push(format!("{}, {mesh}, level {} ({why})", job.id, job.level));
                    continue;
                }
            }
            let row = Row {
                series: series.to_owned(),
                engine: id,
                name: name.clone(),
                scheme: job.id.to_owned(),
                mesh: mesh.to_owned(),
                cage_faces: job.counts.len() as u64,
                level: job.level,
                faces: faces as u64,
                stores: stores.to_owned(),
                output_bytes,
                median_ms: 0.0,
                best_ms: 0.0,
                samples: 0,
                ns_per_face: 0.0,
                times_limn: None,
                peak_bytes: None,
                measured_bandwidth: bandwidth,
                limit_ns_per_face: output_bytes as f64 * 1e9 / bandwidth / faces as f64,
                clock,
                other_rule: matches!(differs, Some(Differs::Rule(_))),
                machine: machine.clone(),
            };
            entries.push(Entry { row, run, repeats, times: Vec::new() });
        }
        drop(reference);

        let rounds = if faces > 1_000_000 { pace.rounds.div_ceil(2) } else { pace.rounds };
        for round in 0..rounds.max(3) {
            for entry in &mut entries {
                let spent: f64 = entry.times.iter().sum::<f64>() * f64::from(entry.repeats);
                if entry.times.len() < 3 || spent < pace.patience || (round % 5 == 0 && spent < 4.0 * pace.patience) {
                    match entry.run.time(entry.repeats) {
                        Ok(time) => entry.times.push(time / f64::from(entry.repeats)),
                        Err(why) => sentences.push(format!("{} stopped: {why}.", entry.row.name)),
                    }
                }
            }
        }
        let mut rows = Vec::new();
        for mut entry in entries {
            let row = &mut entry.row;
            let median = clock::median(&entry.times);
            row.median_ms = median * 1e3;
            row.best_ms = entry.times.iter().copied().fold(f64::INFINITY, f64::min) * 1e3;
            row.samples = entry.times.len();
            row.ns_per_face = median * 1e9 / faces as f64;
            row.peak_bytes = entry.run.peak().ok().flatten();
            let bytes = row.peak_bytes.unwrap_or_default() as f64;
            let cost = (median / faces as f64, bytes / faces as f64);
            self.costs.insert((row.engine.clone(), row.scheme.clone()), cost);
            if row.samples > 0 {
                rows.push(entry.row);
            }
        }
        let of = |id: &str| rows.iter().find(|row| row.engine == id).map(|row| row.median_ms);
        let (limn, with_normals) = (of(LIMN), of(SHADED));
        for row in &mut rows {
            let like = if row.stores == WITHOUT { limn } else { with_normals };
            row.times_limn = like.map(|like| row.median_ms / like);
        }
        self.report.notes.extend(sentences);
        self.report.rows.extend(rows.iter().cloned());
        Ok(rows)
    }

    /// The report, with a sentence for each engine that is known to lose points, and the sentences of those that may not differ.
    pub fn finish(mut self) -> (Report, Vec<String>) {
        for engine in &self.engines {
            if let (Some(excuse), Some(jobs)) = (engine.excuse(), self.lost.get(engine.id())) {
                let text = format!("{} {excuse}, and has no figure where it does: {}.", engine.name(), jobs.join("; "));
                self.report.notes.push(text);
            }
        }
        if self.late > 0 {
            let (late, whole) = (self.late, self.pace.whole);
            self.report.notes.push(format!("Time was up after {whole:.0} s: {late} jobs at the end are left out."));
        }
        (self.report, self.differ)
    }

    /// Lets engines that have not been seen with the scheme make a lower level first, so that nobody waits for a surprise.
    fn try_strangers(&mut self, job: &Job<'_>, faces: usize) {
        if faces < TRIED || job.level < 2 {
            return;
        }
        let lower = Job::new(job.id, (job.level - 2).max(1), job.soup);
        let Ok(made) = refined(&lower, None) else { return };
        let fewer = made.faces.count() as f64;
        drop(made);
        for engine in &mut self.engines {
            let key = (engine.id().to_owned(), job.id.to_owned());
            if self.costs.contains_key(&key) {
                continue;
            }
            let Ok(mut run) = engine.prepare(&lower) else { continue };
            if let Ok(time) = run.time(1) {
                let bytes = run.peak().ok().flatten().unwrap_or_default() as f64;
                self.costs.insert(key, (time / fewer, bytes / fewer));
            }
        }
    }
}

/// Whether this is another engine once more, with normals: it has rows in the table and no curves.
fn is_twin(id: &str) -> bool {
    id.ends_with("-shaded")
}

/// How many runs make a sample that is long enough for the clock, and about how many seconds one takes.
fn fill(run: &mut dyn Run, sample: f64) -> Result<(u32, f64), String> {
    let mut repeats = 1;
    loop {
        let took = run.time(repeats)?;
        if took > sample / 2.0 || repeats >= 10_000 {
            return Ok((repeats, took / f64::from(repeats)));
        }
        // A short one may be known by one figure only, or none.
        let more = (sample / took.max(1e-9)).clamp(1.0, 16.0);
        repeats = (f64::from(repeats) * more).ceil().min(10_000.0) as u32;
    }
}

/// Why an engine has no figure.
enum Check {
    Differs(String),
    Failed(String),
}

/// What engines are held against.
struct Reference<'a> {
    job: &'a Job<'a>,
    ours: Surface,
    sorted: Option<Result<Sorted, String>>,
}

impl<'a> Reference<'a> {
    fn new(job: &'a Job<'a>, ours: Surface) -> Self {
        let sorted = (ours.counts.len() <= COMPARED).then(|| Sorted::new(&ours));
        Reference { job, ours, sorted }
    }

    fn check(&self, run: &mut dyn Run, differs: Option<Differs>) -> Result<(), Check> {
        let theirs = run.surface().map_err(Check::Failed)?;
        let again;
        let (ours, sorted) = match differs {
            // Where the crate has weights that Limn has too, Limn makes those.
            Some(Differs::Weights(choice)) => {
                let made = refined(self.job, Some(choice)).map_err(Check::Failed)?;
                again = Reference::new(self.job, surface(&made));
                (&again.ours, &again.sorted)
            }
            _ => (&self.ours, &self.sorted),
        };
        let tolerance = if let Some(Differs::Rule(_)) = differs { f64::INFINITY } else { TOLERANCE };
        let said = match sorted {
            _ if close(ours, &theirs, tolerance) => Ok(()),
            Some(Ok(sorted)) => Sorted::new(&theirs).and_then(|theirs| sorted.distance(&theirs, tolerance).map(drop)),
            Some(Err(why)) => Err(why.clone()),
            None => alike(ours, &theirs, tolerance),
        };
        said.map_err(Check::Differs)
    }
}

/// Whether two surfaces are the same in the same numbering, which is told sooner than any other.
fn close(a: &Surface, b: &Surface, tolerance: f64) -> bool {
    let near = |(p, q): (&[f32; 3], &[f32; 3])| p.iter().zip(q).all(|(x, y)| f64::from((x - y).abs()) <= tolerance);
    (a.points.len(), &a.counts, &a.corners) == (b.points.len(), &b.counts, &b.corners)
        && a.points.iter().zip(&b.points).all(near)
}

/// Whether counts are equal, and the means of the points' coordinates, of their squares, and of the same weighted by
/// how many faces meet there.
fn alike(a: &Surface, b: &Surface, tolerance: f64) -> Result<(), String> {
    let counts = |s: &Surface| (s.points.len(), s.counts.len(), s.corners.len());
    if counts(a) != counts(b) {
        return Err(format!("{:?} vertices, faces and corners, and the other has {:?}", counts(a), counts(b)));
    }
    let off = moments(a).iter().zip(moments(b)).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
    if off <= tolerance || tolerance.is_infinite() {
        return Ok(());
    }
    Err(format!("the points' means are {off:.1e} off"))
}

fn moments(s: &Surface) -> [f64; 12] {
    let mut sums = [0.0; 12];
    let mut add = |p: &[f32; 3], at: usize, n: usize| {
        for k in 0..3 {
            let x = f64::from(p[k]);
            sums[at + k] += x / n as f64;
            sums[at + 3 + k] += x * x / n as f64;
        }
    };
    s.points.iter().for_each(|p| add(p, 0, s.points.len()));
    s.corners.iter().filter_map(|&v| s.points.get(v as usize)).for_each(|p| add(p, 6, s.corners.len()));
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use limn_kernel::trial::cages;

    /// An engine that is Limn, but for one point.
    struct Off(f32);

    struct OffRun(Surface);

    impl Engine for Off {
        fn id(&self) -> &str {
            "off"
        }
        fn name(&self) -> &str {
            "Off"
        }
        fn clock(&self) -> &'static str {
            "wall"
        }
        fn prepare<'a>(&'a mut self, job: &'a Job<'a>) -> Result<Box<dyn Run + 'a>, Absent> {
            let mut made = surface(&refined(job, None).map_err(Absent::Failed)?);
            made.points[3][1] += self.0;
            Ok(Box::new(OffRun(made)))
        }
    }

    impl Run for OffRun {
        fn time(&mut self, repeats: u32) -> Result<f64, String> {
            Ok(0.004 * f64::from(repeats))
        }
        fn surface(&mut self) -> Result<Surface, String> {
            Ok(self.0.clone())
        }
        fn peak(&mut self) -> Result<Option<u64>, String> {
            Ok(None)
        }
    }

    #[test]
    fn an_engine_that_is_a_little_off_has_no_figure() {
        let soup = cages::cage("cube", 0);
        let job = Job::new("catmull-clark", 2, &soup);
        for (off, present) in [(0.0, true), (1e-4, false)] {
            let engines: Vec<Box<dyn Engine>> = vec![Box::new(Off(off))];
            let mut bench = Bench::new(engines, Machine::default(), Pace::QUICK);
            let rows = bench.measure("table", "cube", &job).unwrap();
            assert_eq!((rows.len(), bench.differ.len()), if present { (1, 0) } else { (0, 1) });
            if let [row] = &rows[..] {
                assert_eq!((row.faces, row.median_ms, row.samples), (96, 4.0, 5));
                assert!((row.ns_per_face - 4e6 / 96.0).abs() < 1e-6);
            } else {
                assert!(bench.differ[0].contains("Limn and Off differ: a point is"), "{}", bench.differ[0]);
            }
        }
    }

    #[test]
    fn an_engine_that_would_take_too_long_is_left_out_and_named_once() {
        let soup = cages::cage("cube", 0);
        let mut bench = Bench::new(vec![Box::new(Off(0.0))], Machine::default(), Pace { longest: 0.01, ..Pace::QUICK });
        for level in [1, 2, 3] {
            let job = Job::new("catmull-clark", level, &soup);
            assert_eq!(bench.measure("levels", "cube", &job).unwrap().len(), usize::from(level == 1));
        }
        assert_eq!(
            bench.report.notes,
            ["Off is left out at catmull-clark, cube, level 2, 96 faces: a run would take 0.0 s."]
        );
    }

    #[test]
    fn jobs_that_come_too_late_are_left_out_and_counted() {
        let soup = cages::cage("cube", 0);
        let mut bench = Bench::new(vec![Box::new(Off(0.0))], Machine::default(), Pace { whole: 0.0, ..Pace::QUICK });
        for _ in 0..2 {
            assert!(bench.measure("table", "cube", &Job::new("catmull-clark", 2, &soup)).unwrap().is_empty());
        }
        assert_eq!(bench.finish().0.notes, ["Time was up after 0 s: 2 jobs at the end are left out."]);
    }

    #[test]
    fn moments_tell_a_moved_point() {
        let soup = cages::cage("torus", 8);
        let made = surface(&refined(&Job::new("linear", 1, &soup), None).unwrap());
        let mut moved = made.clone();
        moved.points[0][0] += 0.1;
        assert_eq!(alike(&made, &made, 1e-6), Ok(()));
        assert!(alike(&made, &moved, 1e-6).is_err_and(|why| why.contains("means")));
        moved.corners.pop();
        assert!(alike(&made, &moved, f64::INFINITY).is_err());
    }
}
