//! Engines in other programs: OpenSubdiv in C++ (`opensubdiv.cpp`), and whatever runs in a browser (`browser.mjs`).
//!
//! Such a program is started once and answers lines, so that its runs take turns with everyone else's:
//!
//! ```text
//!   it says     engine ID NAME ...      one line an engine
//!               bandwidth ID BYTES/S        what plain stores reach there, if that is not what they reach natively
//!               clock ID WORD               `thread` or `wall`, if it is not what whoever started it says
//!               shaded ID                   where it stores normals too, beside points and corners
//!               excuse ID WORDS ...         what it is known to do wrong: it has no figure where it does
//!               machine KEY WORDS ...   browser or adapter, if it has one
//!               note WORDS ...          what a reader of the table should know
//!               ready
//!   asked       prepare ID SCHEME LEVEL FILE     run ID REPEATS     surface ID FILE     peak ID     free ID
//!   it answers  ok                               ok SECONDS         ok                  ok BYTES    ok
//!           or  no REASON
//!   a FILE has  4 numbers: vertices, faces, corners, creases; then 3 floats a vertex, a number a face, the corners,
//!               2 numbers a crease, a float a crease                all of 32 bits, little-endian
//! ```
//!
//! Cost: a file each way a row, off the clock. Limit: a program that does not answer holds everything up.

use super::{Absent, Engine, Job, Run};
use limn_kernel::trial::same::Surface;
use std::cell::RefCell;
use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::PathBuf;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::rc::Rc;

/// A program that was started.
struct Program {
    child: Child,
    input: Option<ChildStdin>,
    output: BufReader<ChildStdout>,
}

/// What a program brought.
#[derive(Default)]
pub struct Found {
    /// Its engines.
    pub engines: Vec<Box<dyn Engine>>,
    /// What it says of the machine: key and words.
    pub machine: Vec<(String, String)>,
    /// What it wants to be known.
    pub notes: Vec<String>,
}

/// Starts a program. `clock` says what its seconds are.
///
/// # Errors
/// One sentence, if it does not start or says something else.
pub fn start(command: &mut Command, clock: &'static str) -> Result<Found, String> {
    let name = command.get_program().to_string_lossy().into_owned();
    command.stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut child = command.spawn().map_err(|e| format!("{name} does not start: {e}"))?;
    let (Some(input), Some(output)) = (child.stdin.take(), child.stdout.take()) else {
        return Err(format!("{name} has no input and output"));
    };
    let program = Rc::new(RefCell::new(Program { child, input: Some(input), output: BufReader::new(output) }));
    let mut found = Found::default();
    let mut engines: Vec<Remote> = Vec::new();
    loop {
        let line = program.borrow_mut().line()?;
        let mut words = line.splitn(3, ' ');
        let (kind, first, rest) = (words.next(), words.next(), words.next().unwrap_or_default());
        match (kind, first) {
            (Some("engine"), Some(id)) => engines.push(Remote {
                id: id.to_owned(),
                name: rest.to_owned(),
                clock,
                program: Rc::clone(&program),
                bandwidth: None,
                shaded: false,
                excuse: None,
            }),
            (Some("clock"), Some(id)) => {
                let clock = if rest == "thread" { "thread" } else { "wall" };
                engines.iter_mut().filter(|engine| engine.id == id).for_each(|engine| engine.clock = clock);
            }
            (Some("shaded"), Some(id)) => {
                engines.iter_mut().filter(|engine| engine.id == id).for_each(|engine| engine.shaded = true);
            }
            (Some("excuse"), Some(id)) => {
                let known = engines.iter_mut().filter(|engine| engine.id == id);
                known.for_each(|engine| engine.excuse = Some(rest.to_owned()));
            }
            (Some("bandwidth"), Some(id)) => {
                let known = engines.iter_mut().filter(|engine| engine.id == id);
                known.for_each(|engine| engine.bandwidth = rest.parse().ok());
            }
            (Some("machine"), Some(key)) => found.machine.push((key.to_owned(), rest.to_owned())),
            (Some("note"), Some(word)) => found.notes.push(format!("{word} {rest}")),
            (Some("ready"), None) => break,
            _ => return Err(format!("{name} says `{line}`")),
        }
    }
    found.engines.extend(engines.into_iter().map(|engine| Box::new(engine) as Box<dyn Engine>));
    Ok(found)
}

impl Program {
    fn line(&mut self) -> Result<String, String> {
        let mut line = String::new();
        match self.output.read_line(&mut line) {
            Ok(n) if n > 0 => Ok(line.trim_end().to_owned()),
            _ => Err("the program has ended".to_owned()),
        }
    }

    fn ask(&mut self, question: &str) -> Result<String, String> {
        let input = self.input.as_mut().ok_or("the program has ended")?;
        writeln!(input, "{question}").and_then(|()| input.flush()).map_err(|e| e.to_string())?;
        let line = self.line()?;
        match line.split_once(' ').unwrap_or((&line, "")) {
            ("ok", answer) => Ok(answer.trim().to_owned()),
            (_, why) => Err(why.to_owned()),
        }
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        // The end of its input is the end of it.
        self.input = None;
        let _ = self.child.wait();
    }
}

struct Remote {
    id: String,
    name: String,
    clock: &'static str,
    program: Rc<RefCell<Program>>,
    bandwidth: Option<f64>,
    shaded: bool,
    excuse: Option<String>,
}

impl Engine for Remote {
    fn id(&self) -> &str {
        &self.id
    }

    fn name(&self) -> &str {
        &self.name
    }

    fn clock(&self) -> &'static str {
        self.clock
    }

    fn bandwidth(&self) -> Option<f64> {
        self.bandwidth
    }

    /// A browser's clock tells tenths of a millisecond; where it is the thread's, handing a question over counts.
    fn sample(&self) -> f64 {
        0.02
    }

    fn shaded(&self) -> bool {
        self.shaded
    }

    fn excuse(&self) -> Option<&str> {
        self.excuse.as_deref()
    }

    fn prepare<'a>(&'a mut self, job: &'a Job<'a>) -> Result<Box<dyn Run + 'a>, Absent> {
        let file = scratch(&self.id);
        fs::write(&file, packed(job)).map_err(|e| Absent::Failed(e.to_string()))?;
        let question = format!("prepare {} {} {} {}", self.id, job.id, job.level, file.display());
        let answer = self.program.borrow_mut().ask(&question);
        let _ = fs::remove_file(&file);
        match answer {
            Ok(_) => {}
            Err(why) if why == "the program has ended" => return Err(Absent::Failed(why)),
            Err(_) => return Err(Absent::Scheme),
        }
        Ok(Box::new(Trial { id: &self.id, program: &self.program }))
    }
}

/// A file for what goes to and fro, which is taken away at once.
fn scratch(id: &str) -> PathBuf {
    std::env::temp_dir().join(format!("limn-bench-{}-{id}.bin", std::process::id()))
}

fn packed(job: &Job<'_>) -> Vec<u8> {
    let creases = &job.soup.marks.creases;
    let sizes = [job.soup.positions.len(), job.counts.len(), job.soup.corners.len(), creases.len()];
    let numbers = sizes.iter().map(|&n| n as u32);
    let mut bytes: Vec<u8> = numbers.flat_map(u32::to_le_bytes).collect();
    bytes.extend(job.soup.positions.iter().flatten().flat_map(|x| x.to_le_bytes()));
    let whole = job.counts.iter().chain(&job.soup.corners).chain(creases.iter().flat_map(|c| &c.0));
    bytes.extend(whole.flat_map(|n| n.to_le_bytes()));
    bytes.extend(creases.iter().flat_map(|c| c.1.to_le_bytes()));
    bytes
}

fn unpacked(bytes: &[u8]) -> Option<Surface> {
    let (words, []) = bytes.as_chunks::<4>() else { return None };
    let (head, rest) = words.split_at_checked(4)?;
    let [vertices, faces, corners] = [0, 1, 2].map(|i| u32::from_le_bytes(head[i]) as usize);
    let (points, rest) = rest.split_at_checked(3 * vertices)?;
    let (counts, rest) = rest.split_at_checked(faces)?;
    let (corners, _) = rest.split_at_checked(corners)?;
    let whole = |words: &[[u8; 4]]| words.iter().map(|w| u32::from_le_bytes(*w)).collect();
    let points = points.as_chunks::<3>().0.iter().map(|p| p.map(f32::from_le_bytes)).collect();
    Some(Surface { points, counts: whole(counts), corners: whole(corners) })
}

struct Trial<'a> {
    id: &'a str,
    program: &'a Rc<RefCell<Program>>,
}

impl Trial<'_> {
    fn ask(&self, command: &str, argument: &str) -> Result<String, String> {
        self.program.borrow_mut().ask(&format!("{command} {} {argument}", self.id))
    }
}

impl Run for Trial<'_> {
    fn time(&mut self, repeats: u32) -> Result<f64, String> {
        let answer = self.ask("run", &repeats.to_string())?;
        answer.parse().map_err(|_| format!("`{answer}` is no time"))
    }

    fn surface(&mut self) -> Result<Surface, String> {
        let file = scratch(self.id);
        self.ask("surface", &file.display().to_string())?;
        let bytes = fs::read(&file).map_err(|e| e.to_string());
        let _ = fs::remove_file(&file);
        unpacked(&bytes?).ok_or_else(|| "its result is cut off".to_owned())
    }

    fn peak(&mut self) -> Result<Option<u64>, String> {
        Ok(self.ask("peak", "").ok().and_then(|text| text.parse().ok()))
    }
}

impl Drop for Trial<'_> {
    fn drop(&mut self) {
        let _ = self.ask("free", "");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use limn_kernel::trial::cages;

    #[test]
    fn a_mesh_survives_the_file_and_a_short_file_is_none() {
        let mut soup = cages::cage("mouse", 0);
        soup.marks.creases = vec![([0, 1], 2.5)];
        let job = Job::new("catmull-clark", 1, &soup);
        let bytes = packed(&job);
        let back = unpacked(&bytes).unwrap();
        assert_eq!((&back.points, &back.counts, &back.corners), (&soup.positions, &job.counts, &soup.corners));
        assert_eq!(bytes.len(), 4 * (4 + 3 * soup.positions.len() + job.counts.len() + soup.corners.len() + 3));
        assert_eq!(unpacked(&bytes[..bytes.len() - 16 * 4]), None);
    }

    #[test]
    fn a_program_that_speaks_is_an_engine_and_one_that_ends_is_a_sentence() {
        let script = "echo engine it It speaks; echo bandwidth it 2.5e9; echo shaded it; echo clock it thread; echo excuse it loses points; echo machine browser None 1; echo ready; \
                      while read line; do case $line in prepare*) echo ok;; run*) echo ok 0.25;; *) echo no idea;; esac; done";
        let mut found = start(Command::new("sh").args(["-c", script]), "wall").unwrap();
        assert_eq!(found.machine, [("browser".to_owned(), "None 1".to_owned())]);
        let soup = cages::cage("cube", 0);
        let job = Job::new("loop", 1, &soup);
        let engine = &mut found.engines[0];
        assert_eq!((engine.id(), engine.name(), engine.bandwidth()), ("it", "It speaks", Some(2.5e9)));
        assert_eq!((engine.shaded(), engine.clock(), engine.excuse()), (true, "thread", Some("loses points")));
        let Ok(mut run) = engine.prepare(&job) else { panic!("it takes the job") };
        assert_eq!(run.time(3), Ok(0.25));
        assert_eq!(run.peak(), Ok(None));
        assert_eq!(run.surface().unwrap_err(), "idea");
        drop(run);
        assert!(start(Command::new("sh").args(["-c", "true"]), "wall").is_err());
    }
}
