//! What can go wrong, by what the caller can do about it: each kind has its exit code.

/// The kinds with their codes, as `--help` tells them.
pub const CODES: &str = "\
Exit codes:
   0  done
   1  a command failed
   2  the command line or the script is not understood
   3  the model or the script cannot be read
   4  the memory budget refused it; raise --memory or lower the level
  74  a file cannot be written
";

/// Why the program ends early.
#[derive(Debug)]
pub enum Failure {
    /// A command could not be carried out.
    Command(String),
    /// Words that are no commands.
    Usage(String),
    /// A model or script that cannot be read.
    Input(String),
    /// More than the budget.
    Budget(String),
    /// A file that cannot be written.
    Output(String),
    /// Nobody reads standard output any more.
    Closed,
}

impl Failure {
    /// The exit code.
    pub fn code(&self) -> u8 {
        match self {
            Failure::Closed => 0,
            Failure::Command(_) => 1,
            Failure::Usage(_) => 2,
            Failure::Input(_) => 3,
            Failure::Budget(_) => 4,
            // EX_IOERR of sysexits.h.
            Failure::Output(_) => 74,
        }
    }

    /// One sentence, if there is anything to say.
    pub fn message(&self) -> Option<&str> {
        match self {
            Failure::Closed => None,
            Failure::Command(m) | Failure::Usage(m) | Failure::Input(m) | Failure::Budget(m) | Failure::Output(m) => {
                Some(m)
            }
        }
    }
}
