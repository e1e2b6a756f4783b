//! How a verb ends: 0 done, 2 bad usage or bad input (a panic, which is a fault of ours, exits 101); a closed pipe ends quietly.

use std::process::ExitCode;

use crate::io::IoError;

/// Why a verb did not do what it was asked.
#[derive(Debug)]
pub(super) enum Failure {
    /// The user can put it right: exit 2.
    Input(String),
    /// Who read our output has gone: no message, exit 0.
    ClosedPipe,
}

impl Failure {
    /// Says what happened on standard error and gives the exit code.
    pub(super) fn report(self) -> ExitCode {
        let Failure::Input(message) = self else { return ExitCode::SUCCESS };
        // standard error may be closed too; there is nobody left to tell
        let _ = std::io::Write::write_all(&mut std::io::stderr(), format!("palpate: {message}\n").as_bytes());
        ExitCode::from(2)
    }
}

/// Errors of writing to standard output.
impl From<std::io::Error> for Failure {
    fn from(error: std::io::Error) -> Failure {
        match error.kind() {
            std::io::ErrorKind::BrokenPipe => Failure::ClosedPipe,
            _ => Failure::Input(format!("standard output: cannot be written: {error}")),
        }
    }
}

impl From<IoError> for Failure {
    fn from(error: IoError) -> Failure {
        match error {
            IoError::Write { path, source } if path.as_os_str() == "-" => source.into(),
            other => Failure::Input(other.to_string()),
        }
    }
}
