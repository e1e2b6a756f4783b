//! How a verb ends: 0 done, 2 bad usage or bad input; a closed pipe ends quietly. (A panic, which is a fault of the
//! program, exits 101.)

use std::process::ExitCode;

use crate::fit::FitError;
use crate::io::IoError;

/// Why a verb did not do what it was asked.
#[derive(Debug)]
pub(super) enum Failure {
    /// Something that the user can put right: exit 2.
    Input(String),
    /// The reader of the output has gone: no message, exit 0.
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
            other => Failure::Input(with_flags(other.to_string(), other.remedies())),
        }
    }
}

/// A message of the library, and the flags of this command line for the options that it names as remedies.
pub(super) fn with_flags(message: String, remedies: &[(&str, &str)]) -> String {
    let flag = |(option, value): &(&str, &str)| {
        let flag = format!("--{}", option.replace('_', "-"));
        if value.is_empty() { flag } else { format!("{flag} {value}") }
    };
    let flags: Vec<String> = remedies.iter().map(flag).collect();
    if flags.is_empty() { message } else { format!("{message}; try {}", flags.join(" or ")) }
}

/// An error of a fit, with the flags that may help.
pub(super) fn fit_message(error: &FitError) -> String {
    with_flags(error.to_string(), error.remedies())
}
