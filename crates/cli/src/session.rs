//! Runs commands: the document decides, this reads files, refines and writes.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use limn_document::export::{ExportError, format};
use limn_document::{Command, CommandError, Document, Outcome, Source, Stamp};
use limn_formats::parcel::Notice;
use limn_formats::{Limits, read};
use limn_mesh::{Job, Plan, RefineError, Refined};

use crate::arguments::Arguments;
use crate::failure::Failure;
use crate::folder::Folder;
use crate::print;

/// New points between two looks at the progress: some hundredths of a second.
const ROWS: usize = 500_000;
/// Work shorter than this shows no progress bar.
const PATIENCE: Duration = Duration::from_millis(200);

/// A document and what the command line keeps beside it.
pub struct Session {
    document: Document,
    quiet: bool,
    /// Where relative paths of `open` begin.
    folder: PathBuf,
    /// Where the open model was read from.
    path: PathBuf,
    refined: Option<(Plan, Refined)>,
    /// Remarks on the open model that have been told.
    told: Vec<String>,
}

impl Session {
    /// A session without a model. Relative paths of `open` begin at `folder`.
    pub fn new(arguments: &Arguments, folder: PathBuf) -> Session {
        Session {
            document: Document::new(arguments.memory),
            quiet: arguments.quiet,
            folder,
            path: PathBuf::new(),
            refined: None,
            told: Vec::new(),
        }
    }

    /// Runs all commands, up to the first that fails.
    pub fn run(&mut self, commands: &[Command]) -> Result<(), Failure> {
        // What cannot be written anyway should not cost a refinement first.
        for command in commands {
            if let Command::Export { file } = command {
                format(file).map_err(|error| Failure::Usage(error.to_string()))?;
            }
        }
        commands.iter().try_for_each(|command| self.one(command))
    }

    fn one(&mut self, command: &Command) -> Result<(), Failure> {
        let opening = matches!(command, Command::Open(_) | Command::Reload);
        let outcome = self.document.apply(command, false).map_err(|e| failure(command, opening, &e))?;
        match outcome {
            Outcome::Nothing | Outcome::View | Outcome::Refine => {}
            Outcome::Model => self.tell(opening),
            Outcome::Open(source) => self.open(command, source)?,
            Outcome::Help(text) => print(&text)?,
            Outcome::Info { json } => self.info(json)?,
            Outcome::Export { file } => self.export(&file)?,
        }
        // Schemes for triangles have something to say although the model is the same.
        self.tell(false);
        Ok(())
    }

    /// Writes the remarks that have not been told yet to standard error.
    fn tell(&mut self, afresh: bool) {
        if afresh {
            self.told.clear();
        }
        for remark in self.document.remarks() {
            if !self.told.contains(&remark.text) {
                if !self.quiet {
                    let kind = if remark.minor { "note" } else { "warning" };
                    // Remarks are a courtesy: a closed standard error must not stop the work.
                    let _ = writeln!(std::io::stderr(), "{kind}: {}", remark.text);
                }
                self.told.push(remark.text);
            }
        }
    }

    fn open(&mut self, command: &Command, source: Source) -> Result<(), Failure> {
        let path = match (&source, command) {
            (_, Command::Reload) => self.path.clone(),
            (Source::File { name, .. }, _) => self.folder.join(name),
            (Source::Url(url), _) => {
                return Err(Failure::Input(format!("{url} is not on this machine; download it and open the file")));
            }
            (Source::Builtin(_), _) => return Ok(()),
        };
        let input = |error: &dyn std::fmt::Display| Failure::Input(format!("{}: {error}", path.display()));
        let unreadable = |e: std::io::Error| Failure::Input(format!("{} cannot be read: {e}", path.display()));
        let budget = self.document.budget();
        let length = std::fs::metadata(&path).map_err(unreadable)?.len();
        if length > budget {
            let text = format!("{} has {length} bytes, more than the memory budget of {budget}", path.display());
            return Err(Failure::Budget(text));
        }
        let bytes = std::fs::read(&path).map_err(unreadable)?;
        let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        let files = Folder::of(&path, budget);
        let (model, warnings) =
            read(&name, &bytes, &files, &Limits { bytes: budget }).map_err(|error| match error {
                limn_formats::ReadError::TooBig { .. } => Failure::Budget(format!("{}: {error}", path.display())),
                error => input(&error),
            })?;
        let opened = Source::File { name, stamp: Some(Stamp::of(&bytes)) };
        let notices: Vec<Notice> = warnings.iter().map(Notice::from).collect();
        self.document.load(opened, model, &notices).map_err(|error| input(&error))?;
        self.path = path;
        self.refined = None;
        self.tell(true);
        Ok(())
    }

    /// The present level, refined if it is not yet.
    fn refined(&mut self) -> Result<&Refined, Failure> {
        let (Some(mesh), Some(plan)) = (self.document.mesh().cloned(), self.document.plan()) else {
            return Err(Failure::Command("no model is open".into()));
        };
        let fresh = self.refined.take().filter(|(p, r)| *p == plan && Arc::ptr_eq(r.mesh(), &mesh));
        let refined = match fresh {
            Some((_, refined)) => refined,
            // Shaded, as the page's are: exports have the same normals.
            None => refine(
                Job::new(mesh, plan.clone(), self.document.budget())
                    .map_err(|error| match error {
                        RefineError::TooLarge { .. } => Failure::Budget(error.to_string()),
                        error => Failure::Command(error.to_string()),
                    })?
                    .shaded(),
            ),
        };
        Ok(&self.refined.insert((plan, refined)).1)
    }

    fn info(&mut self, json: bool) -> Result<(), Failure> {
        self.refined()?;
        let points = self.refined.as_ref().map(|(_, refined)| &refined.points[..]);
        let info = self.document.info(points).ok_or_else(|| Failure::Command("`info` has nothing to tell".into()))?;
        print(&if json { info.json() + "\n" } else { info.text() })
    }

    fn export(&mut self, file: &str) -> Result<(), Failure> {
        self.refined()?;
        let Some((_, refined)) = &self.refined else { return Ok(()) };
        let files = self.document.export(refined, file).map_err(|error| match error {
            ExportError::Format { .. } => Failure::Usage(error.to_string()),
            error => Failure::Command(format!("export {file}: {error}")),
        })?;
        let folder = Path::new(file).parent().unwrap_or(Path::new(""));
        for out in files {
            let path = folder.join(&out.name);
            std::fs::write(&path, &out.bytes)
                .map_err(|error| Failure::Output(format!("{} cannot be written: {error}", path.display())))?;
        }
        Ok(())
    }
}

/// Works a job off, with a bar on standard error if that is a terminal and the work takes a while.
fn refine(mut job: Job) -> Refined {
    let begun = Instant::now();
    let bar = ProgressBar::with_draw_target(Some(1000), ProgressDrawTarget::hidden());
    if let Ok(style) = ProgressStyle::with_template("refining {wide_bar} {percent} %  {eta}") {
        bar.set_style(style);
    }
    while !job.step(ROWS) {
        if bar.is_hidden() && begun.elapsed() > PATIENCE {
            // Stays hidden where standard error is no terminal.
            bar.set_draw_target(ProgressDrawTarget::stderr());
        }
        bar.set_position((job.progress() * 1000.0) as u64);
    }
    bar.finish_and_clear();
    job.finish()
}

fn failure(command: &Command, opening: bool, error: &CommandError) -> Failure {
    let (command, error_text) = (command.to_string(), error.to_string());
    // Many messages say which command it was; the others need it in a line of several.
    let text = if error_text.contains(&command) { error_text } else { format!("{command}: {error_text}") };
    match error {
        error if error.is_budget() => Failure::Budget(text),
        CommandError::UnknownShape { .. } | CommandError::Build(_) | CommandError::OtherFile { .. } if opening => {
            Failure::Input(text)
        }
        CommandError::Version(_) => Failure::Usage(text),
        _ => Failure::Command(text),
    }
}
