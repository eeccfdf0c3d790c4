//! Why a run ends without success, and the exit code that says so.

use std::fmt;
use std::path::Path;
use std::process::ExitCode;

/// The exit codes other than 0. They are a contract: see `--help`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Code {
    /// The input cannot be reconstructed, or a checked mesh is not sound.
    Unfit = 1,
    /// Wrong usage.
    Usage = 2,
    /// A file cannot be read or written, or is malformed.
    File = 3,
    /// A bug of ours.
    Internal = 101,
    /// The user stopped the work.
    Interrupted = 130,
}

impl From<Code> for ExitCode {
    fn from(code: Code) -> ExitCode {
        ExitCode::from(code as u8)
    }
}

/// An error for people: what happened, and the remedy where one is known.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    pub code: Code,
    pub what: String,
    pub hint: Option<String>,
}

impl Failure {
    pub fn new(code: Code, what: impl Into<String>) -> Failure {
        Failure {
            code,
            what: what.into(),
            hint: None,
        }
    }

    pub fn usage(what: impl Into<String>) -> Failure {
        Failure::new(Code::Usage, what)
    }

    /// `<file>: <what>`.
    pub fn file(path: &Path, what: impl fmt::Display) -> Failure {
        Failure::new(Code::File, format!("{}: {what}", name(path)))
    }

    pub fn interrupted() -> Failure {
        Failure::new(Code::Interrupted, "interrupted, nothing was written")
    }

    pub fn hint(mut self, hint: impl Into<String>) -> Failure {
        self.hint = Some(hint.into());
        self
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "powercrust: error: {}", self.what)?;
        if let Some(hint) = &self.hint {
            write!(f, "\nhint: {hint}")?;
        }
        Ok(())
    }
}

/// A path as people write it; `-` by the name of the stream it stands for.
pub fn name(path: &Path) -> String {
    if path.as_os_str() == "-" {
        "standard input".to_owned()
    } else {
        path.display().to_string()
    }
}

/// An I/O error without the number that the system puts behind it.
pub fn reason(error: &std::io::Error) -> String {
    let text = error.to_string();
    match text.split_once(" (os error") {
        Some((plain, _)) => plain.to_lowercase(),
        None => text,
    }
}
