//! How a verb ends: 0 done, 2 bad usage or bad input, 1 an output that could not be written; a closed pipe ends quietly. (A panic, which is a fault of the
//! program, exits 101.)

use std::process::ExitCode;

use crate::io::{IoError, changes_others, visible};
use palpate_fitting::fit::FitError;

/// Why a verb did not do what it was asked.
#[derive(Debug)]
pub(super) enum Failure {
    /// Something that the user can put right: exit 2.
    Input(String),
    /// The system would not take the output, as a full disk: exit 1.
    Output(String),
    /// Ctrl-C ended it early, and what was done by then is kept: exit 130.
    Interrupted(String),
    /// The reader of the output has gone: no message, exit 0.
    ClosedPipe,
}

impl Failure {
    /// The message alone, for a program that reports it in its own way.
    pub(super) fn into_message(self) -> String {
        match self {
            Failure::Input(message) | Failure::Output(message) | Failure::Interrupted(message) => message,
            Failure::ClosedPipe => "the reader of the output has gone".into(),
        }
    }

    /// Says what happened on standard error and gives the exit code.
    pub(super) fn report(self) -> ExitCode {
        let (message, code) = match self {
            Failure::Input(message) => (message, 2),
            Failure::Output(message) => (message, 1),
            Failure::Interrupted(message) => (message, 130),
            Failure::ClosedPipe => return ExitCode::SUCCESS,
        };
        // names in it come from files and arguments
        let message = message.split('\n').map(visible).collect::<Vec<_>>().join("\n");
        // standard error may be closed too; there is nobody left to tell
        let _ = std::io::Write::write_all(&mut std::io::stderr(), format!("palpate: {message}\n").as_bytes());
        ExitCode::from(code)
    }
}

/// Says what is wrong with the arguments, or helps.
pub(super) fn print_usage(error: &clap::Error) -> Result<(), Failure> {
    let message = error.render().to_string();
    if message.chars().any(|c| changes_others(c) && c != '\n') {
        let shown = message.split('\n').map(visible).collect::<Vec<_>>().join("\n");
        // nowhere is left to say that this could not be said
        let _ = std::io::Write::write_all(&mut std::io::stderr(), shown.as_bytes());
        return Ok(());
    }
    // help and version go to standard output
    error.print()?;
    Ok(std::io::Write::flush(&mut std::io::stdout())?)
}

/// Errors of writing to standard output.
impl From<std::io::Error> for Failure {
    fn from(error: std::io::Error) -> Failure {
        match error.kind() {
            std::io::ErrorKind::BrokenPipe => Failure::ClosedPipe,
            _ => Failure::Output(format!("standard output: cannot be written: {error}")),
        }
    }
}

impl From<IoError> for Failure {
    fn from(error: IoError) -> Failure {
        match error {
            IoError::Write { path, source } if path.as_os_str() == "-" => source.into(),
            error @ IoError::Write { .. } => Failure::Output(error.to_string()),
            other => Failure::Input(with_flags(other.to_string(), other.remedies())),
        }
    }
}

/// A message of the library, in which the options that it proposes are written as flags of this command line.
pub(super) fn with_flags(mut message: String, remedies: &[(&str, &str)]) -> String {
    for (option, value) in remedies {
        let flag = format!("--{}", option.replace('_', "-"));
        let (proposed, flag) = match *value {
            "" => (option.to_string(), flag),
            value => (format!("{option} = {value}"), format!("{flag} {value}")),
        };
        // the last place: what stands before may be the user's own text
        if let Some(at) = message.rfind(&proposed) {
            message.replace_range(at..at + proposed.len(), &flag);
        }
    }
    message
}

/// An error of a fit, with the flags that may help.
pub(super) fn fit_message(error: &FitError) -> String {
    with_flags(error.to_string(), error.remedies())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn proposed_options_become_flags_and_file_names_stay() {
        let error = IoError::ZeroNormal { file: "skip_invalid.csv".into(), place: crate::io::Place::Line(2) };
        let message = with_flags(error.to_string(), error.remedies());
        assert!(
            message.starts_with("skip_invalid.csv, line 2") && message.ends_with("(or --skip-invalid)"),
            "{message}"
        );
        let every = [
            FitError::NormalDown { index: 0, nz: -1.0 },
            FitError::Steep { index: 0, nz: 0.0 },
            FitError::Inward { contacts: 9 },
            FitError::Rank { rank: 1, unknowns: 9 },
            FitError::Runaway { bending: 9.0, most: 2.5 },
            FitError::HeightField { option: "closed direction" },
        ];
        for error in every {
            let (own, typed) = (error.to_string(), fit_message(&error));
            assert!(!own.contains("--"), "{own}");
            assert_eq!(typed.matches("--").count(), error.remedies().len(), "{typed}");
        }
    }
}
