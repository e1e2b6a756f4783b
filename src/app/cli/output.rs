//! Standard output, the output directory, and a spinner for people who wait.

use std::cell::Cell;
use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::PoisonError;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use crate::io::{
    ReadPhase, ReadProgress, Together, imported_files, same_file, same_place, visible, watched, write_atomically,
};
use crate::report::{PAGE_WIDTH, folded};

use super::failure::Failure;
use super::options::OutputFlags;
use super::time_left::time_left;

/// The file that shows all of a run.
const FIRST: &str = "report.html";

/// Widths of a terminal within which words are fitted to it: narrower ones would break every line, wider ones are hard to
/// read.
const LEGIBLE: std::ops::RangeInclusive<usize> = 60..=110;

/// Columns of words beside a bar: with the bar they fit a narrow terminal.
const BRIEF: usize = 42;

/// Fills one output.
pub(super) type Fill<'a> = &'a mut dyn FnMut(&mut dyn Write) -> std::io::Result<()>;

/// Files that one run may write into an output directory. Those of one row describe one surface or one study, and must not
/// be of two.
const FAMILIES: [&[&str]; 9] = [
    &[
        "fit.json",
        "maps.csv",
        "maps.npz",
        "shape.svg",
        "shape.png",
        "shape.pdf",
        "section.svg",
        "section.png",
        "section.pdf",
        "perspective.svg",
        "perspective.png",
        "perspective.pdf",
        "contacts.csv",
        "points.csv",
    ],
    &["report.html"],
    &["study.json", "study.svg", "study.png", "study.pdf"],
    &["diff.json", "diff.csv", "diff.svg"],
    &["sweep.json", "sweep.csv", "sweep.svg", "sweep.png", "sweep.pdf"],
    &["coverage.json", "coverage.csv"],
    &["explore.json", "explore.csv", "explore.svg", "explore.png", "explore.pdf"],
    &["parts.json", "parts.csv", "parts.svg", "parts.png", "parts.pdf", "parts.dot", "parts.graphml", "parts.step"],
    &[
        "frontier.json",
        "frontier.csv",
        "frontier.parquet",
        "frontier.svg",
        "frontier.png",
        "solver.svg",
        "solver.png",
        "interval.svg",
        "interval.png",
        "stages.svg",
        "stages.png",
    ],
];

impl OutputFlags {
    /// Makes sure of every output before any work is done for it: that it has a place, and overwrites none of `inputs`.
    pub(super) fn prepare(&self, inputs: &[&Path], outputs: &[PathBuf]) -> Result<(), Failure> {
        let imported = imported_files();
        let all: Vec<&Path> = inputs.iter().copied().chain(imported.iter().map(PathBuf::as_path)).collect();
        let overwrites = |output: &Path| match all.iter().find(|input| same_file(input, output)) {
            Some(input) => Err(Failure::Input(format!(
                "{}: it is the input {}, which would be written over; give the output another name",
                output.display(),
                input.display()
            ))),
            None => Ok(()),
        };
        for output in outputs.iter().filter(|output| output.as_os_str() != "-") {
            has_place(output)?;
            overwrites(output)?;
        }
        apart(outputs)?;
        let Some(directory) = &self.out else { return Ok(()) };
        FAMILIES.iter().flat_map(|names| names.iter()).try_for_each(|name| overwrites(&directory.join(name)))?;
        std::fs::create_dir_all(directory)
            .map_err(|e| Failure::Input(format!("--out {}: cannot be made a directory: {e}", directory.display())))?;
        let own = FAMILIES.iter().flat_map(|names| names.iter()).map(|name| directory.join(name));
        match own
            .flat_map(|name| outputs.iter().map(move |output| (name.clone(), output)))
            .find(|(a, b)| same_place(a, b))
        {
            Some((_, output)) => Err(Failure::Input(format!(
                "{}: --out {} may write a file of this name; give one of the two another place",
                output.display(),
                directory.display()
            ))),
            None => Ok(()),
        }
    }

    /// Writes `name` for the output directory, if one is asked for; [`OutputFlags::publish`] puts it there.
    pub(super) fn file(&self, name: &str, fill: Fill) -> Result<(), Failure> {
        let Some(directory) = &self.out else { return Ok(()) };
        let mut gathered = self.gathered.files.lock().unwrap_or_else(PoisonError::into_inner);
        if gathered.is_none() {
            *gathered = Some(Together::new(directory)?);
        }
        match gathered.as_mut() {
            Some(files) => Ok(files.write(name, fill)?),
            None => Ok(()),
        }
    }

    /// Puts all files of this run into the output directory, unless it holds some of another run that would stay.
    pub(super) fn publish(&self) -> Result<(), Failure> {
        let files = self.gathered.files.lock().unwrap_or_else(PoisonError::into_inner).take();
        let (Some(files), Some(directory)) = (files, &self.out) else { return Ok(()) };
        let written = |name: &&str| files.names().iter().any(|written| written == name);
        let families = FAMILIES.iter().filter(|names| names.iter().any(written));
        let stale =
            families.flat_map(|names| names.iter()).find(|name| !written(name) && directory.join(name).exists());
        match stale {
            Some(name) => Err(Failure::Input(format!(
                "--out {}: holds {name} of another run, which this run would not replace; remove it or name another directory",
                directory.display()
            ))),
            None => {
                let names = files.names().to_vec();
                files.publish()?;
                self.gathered.written.lock().unwrap_or_else(PoisonError::into_inner).extend(names);
                Ok(())
            }
        }
    }

    /// What a verb says to people at its end, and what was written for them.
    pub(super) fn tell(&self, fill: Fill) -> Result<(), Failure> {
        print(&mut |out| {
            fill(out)?;
            out.write_all(self.written().as_bytes())
        })
    }

    /// Which files stand in the output directory, the one to look at first before the others; nothing without any.
    fn written(&self) -> String {
        let names = self.gathered.written.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(directory) = self.out.as_ref().filter(|_| !names.is_empty()) else { return String::new() };
        let is_first = |name: &&String| name.as_str() == FIRST;
        let others: Vec<&str> = names.iter().filter(|name| !is_first(name)).map(String::as_str).collect();
        let path = visible(&directory.join(FIRST).display().to_string());
        let words = match (names.iter().any(|name| is_first(&name)), others.join(", ")) {
            (true, others) if others.is_empty() => format!("open {path} first"),
            (true, others) => format!("open {path} first; beside it {others}"),
            (false, others) => format!("{others} in {}", visible(&directory.display().to_string())),
        };
        folded(&format!("wrote      {words}"), Some(11), columns())
    }

    /// A spinner on a terminal's standard error; nothing elsewhere.
    pub(super) fn spinner(&self, what: impl Into<String>) -> Spinner {
        if self.quiet {
            return Spinner(ProgressBar::hidden());
        }
        let bar = ProgressBar::new_spinner().with_message(brief(&what.into())).with_style(waiting());
        // short work ends before the first tick and shows nothing
        bar.enable_steady_tick(Duration::from_millis(250));
        Spinner(bar)
    }
}

/// The directory of an output is there, and the output is none itself.
/// That no two outputs have one place: the second would replace the first.
fn apart(outputs: &[PathBuf]) -> Result<(), Failure> {
    for (k, first) in outputs.iter().enumerate() {
        let to_stdout = |path: &Path| path.as_os_str() == "-";
        let again = |second: &&PathBuf| same_place(first, second) || (to_stdout(first) && to_stdout(second));
        if let Some(second) = outputs[k + 1..].iter().find(again) {
            return Err(Failure::Input(format!(
                "{}: two outputs would be written to this place ({} names it, too); give one of them another name",
                first.display(),
                second.display()
            )));
        }
    }
    Ok(())
}

fn has_place(output: &Path) -> Result<(), Failure> {
    let directory = output.parent().filter(|d| !d.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let why = match (output.is_dir(), directory.is_dir()) {
        (true, _) => "it is a directory; name a file in it".to_string(),
        (false, false) => format!("there is no directory {}", directory.display()),
        (false, true) => return Ok(()),
    };
    Err(Failure::Input(format!("{}: cannot be written: {why}", output.display())))
}

/// What is said beside a bar, at most [`BRIEF`] columns of it: the end of a path says more than its beginning.
pub(super) fn brief(what: &str) -> String {
    let shown = visible(what);
    let columns = shown.chars().count();
    if columns <= BRIEF {
        return shown;
    }
    let (begin, end) = (BRIEF / 3, BRIEF - BRIEF / 3 - 3);
    let head: String = shown.chars().take(begin).collect();
    let tail: String = shown.chars().skip(columns - end).collect();
    format!("{head}...{tail}")
}

/// The look of work whose end is not known.
fn waiting() -> ProgressStyle {
    styled("{spinner} {msg}, {elapsed}")
}

/// The look of reading: how much, how fast, how long still.
fn reading(progress: &ReadProgress) -> ProgressStyle {
    let phase = match progress.phase {
        ReadPhase::Fetching => "",
        ReadPhase::Unpacking => " (unpacking)",
        ReadPhase::Parsing => " (its numbers)",
    };
    match progress.total {
        Some(_) => styled(&format!("{{msg}}{phase} {{bar:20}} {{bytes}}/{{total_bytes}} {{bytes_per_sec}} {{left}}")),
        None => styled(&format!("{{spinner}} {{msg}}{phase} {{bytes}} {{bytes_per_sec}}, {{elapsed}}")),
    }
}

fn styled(template: &str) -> ProgressStyle {
    let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_spinner());
    style.with_key("left", time_left)
}

/// Goes away when dropped.
pub(super) struct Spinner(ProgressBar);

impl Spinner {
    /// What is done from now on.
    pub(super) fn phase(&self, what: &str) {
        self.0.set_style(waiting());
        self.0.set_message(brief(what));
    }

    /// A part of the work is done: from the first one on a bar shows how much, and how long the rest takes.
    pub(super) fn part(&self, done: usize, all: usize) {
        // asked far more often than anything changes
        if done == 0 || done as u64 == self.0.position() {
            return;
        }
        if self.0.position() == 0 {
            self.0.set_style(styled("{msg} {bar:20} {percent} % {left}"));
        }
        self.0.set_length(all as u64);
        self.0.set_position(done as u64);
    }

    /// What reads a file while a bar shows how far it has come.
    pub(super) fn while_reading<T>(&self, read: impl FnOnce() -> T) -> T {
        let bar = self.0.clone();
        let shown = Cell::new(None);
        let show = move |progress: &ReadProgress| {
            // every phase has its own rate; short ones need no bar
            if shown.replace(Some(progress.phase)) != Some(progress.phase) {
                bar.reset();
                bar.set_style(reading(progress));
            }
            if let Some(total) = progress.total {
                bar.set_length(total as u64);
            }
            bar.set_position(progress.done as u64);
        };
        watched(Box::new(show), read)
    }
}

impl Drop for Spinner {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

/// Columns of the terminal that standard output is, and of a page where it is none.
pub(super) fn columns() -> usize {
    let terminal = std::io::stdout().is_terminal().then(terminal_size::terminal_size).flatten();
    terminal.map_or(PAGE_WIDTH, |(width, _)| usize::from(width.0).clamp(*LEGIBLE.start(), *LEGIBLE.end()))
}

/// Whether standard output is a terminal that shows colours; NO_COLOR says no (no-color.org).
pub(super) fn wants_colour() -> bool {
    let refused = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    !refused && std::env::var_os("TERM").is_none_or(|term| term != "dumb") && std::io::stdout().is_terminal()
}

/// Text with what stands before the first two blanks of a line in bold.
pub(super) fn with_bold_labels(text: &str) -> String {
    let bold = |line: &str| match line.find("  ").filter(|at| *at > 0) {
        Some(at) => format!("\u{1b}[1m{}\u{1b}[0m{}\n", &line[..at], &line[at..]),
        None => format!("{line}\n"),
    };
    text.lines().map(bold).collect()
}

/// Writes to standard output, whole.
pub(super) fn print(fill: Fill) -> Result<(), Failure> {
    Ok(write_atomically(Path::new("-"), fill)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_paths_are_cut_in_the_middle() {
        assert_eq!(brief("reading a.csv"), "reading a.csv");
        let cut = brief(&format!("reading /{}/the-last-scan.csv", "folder/".repeat(40)));
        assert!(cut.starts_with("reading /") && cut.ends_with("the-last-scan.csv"), "{cut}");
        assert_eq!(cut.chars().count(), BRIEF);
        assert!(!brief("\u{1b}[31m").contains('\u{1b}'));
    }
}
