//! `palpate fit INPUT`: contacts or a grid, from a file or a pipe, to surface and shape. Several files at once: `several.rs`.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;

use crate::io::{Input, OpenedInput, PieceRule, ReadOptions, Reading, open_input, read_input};
use crate::report::{Answer, ChosenPart, FitDocument, LackOfFitPart, Subject};
use palpate_fitting::fit::{FitError, FitOptions};
use palpate_geometry::contact::ContactError;

use super::adaptive_model::AdaptiveFlags;
use super::answer::{Question, answer};
use super::batch;
use super::describe::{Destination, Taken, describe, document_of};
use super::failure::{Failure, fit_message};
use super::fit_in_pieces::{PiecesAnswer, PiecesQuestion, fit_in_pieces};
use super::found::{Found, Refusal};
use super::memory::MemoryFlags;
use super::options::{FitFlags, OutputFlags, WordsFlags};
use super::output::Spinner;
use super::preparation::PreparationFlags;
use super::provenance::provenance;
use super::reading::{ReadFlags, seen_from};
use super::save::check_name;
use super::things::{TellThings, Things};

/// Arguments of `palpate fit`.
#[derive(Args)]
pub(super) struct FitArgs {
    /// Table, NPZ, NPY, PLY, PCD, OBJ, OFF, STL or a depth image; - for standard input
    ///
    /// A table has names in its first line (x,y,z, perhaps nx,ny,nz). Each may be packed as .gz
    #[arg(required = true, value_name = "INPUT")]
    inputs: Vec<PathBuf>,
    /// Write one row a file, for several files
    ///
    /// Its columns are name, contacts, class, S and R with their uncertainty and interval, radius, the probability of every class, notes, or why there is no answer
    #[arg(long, value_name = "F.csv", conflicts_with = "save")]
    table: Option<PathBuf>,
    /// Leave out rows with missing or non-finite numbers and count them
    ///
    /// Without it such a file is refused. A normal that is not known may be left empty (all three cells) or be 0,0,0: its contact counts without it
    #[arg(long)]
    skip_invalid: bool,
    /// Save the surface, in the format of the ending: .json, .step, .ply and others
    ///
    /// .json has all that is known of it; .step, .igs, .npz a spline; .ply, .obj, .stl, .glb, .vtu a mesh, .parquet its points, of --grid points each way [default: 49x49]
    #[arg(long, value_name = "F")]
    save: Option<PathBuf>,
    /// Leave out certificate, uncertainties and intervals, which can take longer than the fit; for a named model
    #[arg(long, hide_short_help = true)]
    bare: bool,
    #[command(flatten)]
    preparation: PreparationFlags,
    #[command(flatten)]
    reading: ReadFlags,
    #[command(flatten)]
    memory: MemoryFlags,
    #[command(flatten)]
    adaptive: AdaptiveFlags,
    #[command(flatten)]
    fit: FitFlags,
    #[command(flatten)]
    words: WordsFlags,
    #[command(flatten)]
    output: OutputFlags,
}

impl FitArgs {
    fn names_a_model(&self) -> bool {
        self.adaptive.adaptive || self.fit.names_a_model()
    }

    /// How the file is read. A model that was named takes the normals as they are; a recognition leaves out those of
    /// length zero and counts them. Normals that are not used may be anything.
    fn read_options(&self) -> ReadOptions {
        let keep_zero_normals = !self.names_a_model() || self.preparation.needs_no_normals();
        ReadOptions { keep_zero_normals, ..self.reading.options(self.skip_invalid) }
    }

    fn pieces_question(&self) -> PiecesQuestion<'_> {
        PiecesQuestion {
            typed: self.adaptive.typed(&self.fit),
            options: self.fit.over(FitOptions::default()),
            preparation: &self.preparation,
            bare: self.bare,
            memory: self.memory.bytes(),
            is_unnamed: !self.adaptive.adaptive,
        }
    }

    /// What would take more memory than it may is fitted in pieces; models other than an adaptive one take all contacts at once.
    fn open(&self, input: &Path) -> Result<OpenedInput, Failure> {
        let (options, typed) = (self.read_options(), self.memory.memory.is_some());
        if self.fit.names_a_model() && !self.adaptive.adaptive {
            if typed {
                let what = "--memory is for an adaptive surface: every other model takes all contacts at once";
                return Err(Failure::Input(what.into()));
            }
            let reading = read_input(input, &options).map_err(ReadFlags::refused)?;
            return Ok(OpenedInput::Whole(Box::new(reading)));
        }
        let keep_zero_normals = self.preparation.needs_no_normals();
        let pieces = ReadOptions { keep_zero_normals, ..options.clone() };
        let rule = PieceRule { memory: self.memory.bytes(), options: pieces, strict: typed };
        open_input(input, &options, &rule).map_err(ReadFlags::refused)
    }
}

pub(super) fn fit(args: &FitArgs) -> Result<(), Failure> {
    if let ([input], None) = (&args.inputs[..], &args.table) {
        return fit_one(input, args);
    }
    let one_only = |option: &str| {
        Failure::Input(format!("{option} is for one file; with several, --table F.csv has a row of each"))
    };
    let of_one = [
        (args.save.is_some(), "--save"),
        (args.output.out.is_some(), "--out"),
        (args.words.verbose, "--verbose"),
        (args.words.unit.is_some(), "--unit"),
    ];
    if let Some((_, option)) = of_one.iter().find(|(typed, _)| *typed) {
        return Err(one_only(option));
    }
    batch::fit_several(&args.inputs, args.table.as_deref(), &args.output, |input| row_of(input, args))
}

fn fit_one(input: &Path, args: &FitArgs) -> Result<(), Failure> {
    if args.output.json && args.save.as_ref().is_some_and(|path| path.as_os_str() == "-") {
        return Err(Failure::Input("--save - and --json both want standard output; give --save a file".into()));
    }
    args.output.prepare(&[input], args.save.as_slice())?;
    check_name(args.save.as_deref())?;
    let spinner = args.output.spinner(format!("reading {}", input.display()));
    let one = match Outcome::of(input, args, Some(&spinner))? {
        Outcome::Surface(one) => one,
        Outcome::Things(things) => {
            let (output, saves, viewpoint) = (&args.output, args.save.is_some(), args.preparation.viewpoint);
            return things.tell(&TellThings { output, saves, viewpoint }, spinner);
        }
    };
    drop(spinner);
    describe(
        &one.answer,
        &one.reading.file,
        &one.subject(args),
        &one.taken,
        &Destination {
            output: &args.output,
            words: &args.words,
            save: args.save.as_ref(),
            grid: args.fit.typed_grid(),
            provenance: provenance(&one.reading.file, None, None),
        },
    )
}

/// The document of one of several files.
fn row_of(input: &Path, args: &FitArgs) -> Result<FitDocument, Failure> {
    let one = match Outcome::of(input, args, None)? {
        Outcome::Surface(one) => one,
        Outcome::Things(things) => return Err(things.refused()),
    };
    document_of(&one.answer, &one.reading.file, &one.subject(args), &one.taken)
}

/// What a file holds.
enum Outcome {
    /// One surface.
    Surface(Box<One>),
    /// Several things, which have no one shape.
    Things(Box<Things>),
}

/// One file, read and fitted.
struct One {
    reading: Reading,
    answer: Answer,
    chosen: Option<ChosenPart>,
    lack_of_fit: Option<LackOfFitPart>,
    notes: Vec<String>,
    taken: Taken,
}

impl Outcome {
    /// `spinner` shows what is done.
    fn of(input: &Path, args: &FitArgs, spinner: Option<&Spinner>) -> Result<Outcome, Failure> {
        let began = Instant::now();
        let read = || args.open(input);
        let opened = match spinner {
            Some(spinner) => spinner.while_reading(read),
            None => read(),
        };
        let mut reading = match opened? {
            OpenedInput::Whole(reading) => *reading,
            OpenedInput::Pieces(pieces) => {
                let question = args.pieces_question();
                return One::of_pieces(fit_in_pieces(*pieces, &question, spinner)?, args, began);
            }
            OpenedInput::TooLarge(file) => {
                let what = "tables of text alone are fitted in pieces, and it takes more than --memory";
                return Err(Failure::Input(format!("{file}: {what}")));
            }
        };
        let prepared = args.preparation.apply(&mut reading)?;
        let read = began.elapsed().as_secs_f64();
        let clock = Instant::now();
        if let Some(spinner) = spinner {
            spinner.phase(&format!("fitting {} contacts of {}", count_of(&reading.input), reading.file));
        }
        let found = match answer_to(&reading, args) {
            Ok(found) => found,
            Err(Refusal::Fit(error)) => return Err(Failure::Input(placed(&error, &reading))),
            Err(Refusal::Shape(message)) => return Err(Failure::Input(format!("{}: {message}", reading.file))),
            Err(Refusal::Several(found)) => return Ok(Outcome::Things(Box::new(Things { reading, found: *found }))),
        };
        let fitted = clock.elapsed().as_secs_f64();
        let mut notes = notes(&reading);
        notes.extend(prepared);
        let Found { answer, chosen, lack_of_fit, notes: own } = found;
        notes.extend(own);
        notes.extend(args.fit.without_effect(&answer, &reading.input));
        let taken = Taken { began, read, fitted };
        Ok(Outcome::Surface(Box::new(One { reading, answer, chosen, lack_of_fit, notes, taken })))
    }
}

impl One {
    /// Of contacts that came in pieces; reading and fitting are one.
    fn of_pieces(answer: PiecesAnswer, args: &FitArgs, began: Instant) -> Result<Outcome, Failure> {
        let PiecesAnswer { found: Found { answer, chosen, lack_of_fit, notes: own }, reading } = answer;
        let mut notes = notes(&reading);
        notes.extend(own);
        notes.extend(args.fit.without_effect(&answer, &reading.input));
        let taken = Taken { began, read: 0.0, fitted: began.elapsed().as_secs_f64() };
        Ok(Outcome::Surface(Box::new(One { reading, answer, chosen, lack_of_fit, notes, taken })))
    }

    fn subject(&self, args: &FitArgs) -> Subject<'_> {
        Subject {
            chosen: self.chosen.clone(),
            lack_of_fit: self.lack_of_fit.clone(),
            input: &self.reading.input,
            // a unit that stands in the file needs no option
            unit: args.words.unit.clone().or_else(|| self.reading.unit.clone()),
            truth: None,
            bare: args.bare,
            notes: self.notes.clone(),
        }
    }
}

/// The model that was named, or what the contacts show where none was.
fn answer_to(reading: &Reading, args: &FitArgs) -> Result<Found, Refusal> {
    let (named, viewpoint) = (args.names_a_model(), args.preparation.viewpoint);
    if named && viewpoint.is_some() && !args.preparation.estimates_normals() {
        let what = "a viewpoint changes nothing for a model that is named by options: --flip-normals reverses normals";
        return Err(Refusal::Shape(what.into()));
    }
    let viewpoint = viewpoint.or(seen_from(reading));
    let adaptive = &args.adaptive;
    let question = Question { flags: &args.fit, adaptive, base: FitOptions::default(), bare: args.bare, viewpoint };
    answer(&reading.input, &question)
}

/// Contacts, or pixels.
fn count_of(input: &Input) -> usize {
    match input {
        Input::Contacts(contacts) => contacts.len(),
        Input::Grid(grid) => grid.z.len(),
    }
}

/// The error with its file, and its line where it is about one contact.
fn placed(error: &FitError, reading: &Reading) -> String {
    let index = match error {
        FitError::Outside { index, .. } | FitError::NormalDown { index, .. } | FitError::Steep { index, .. } => {
            Some(*index)
        }
        FitError::Contacts(ContactError::NotFinite { index, .. } | ContactError::Weight { index, .. }) => Some(*index),
        FitError::Contacts(ContactError::ZeroNormal { index }) => Some(*index),
        _ => None,
    };
    match index.zip(reading.places.as_ref()) {
        Some((index, places)) => format!("{}, {}: {}", reading.file, places.of(index), fit_message(error)),
        None => format!("{}: {}", reading.file, fit_message(error)),
    }
}

fn notes(reading: &Reading) -> Vec<String> {
    let mut notes = reading.notes.clone();
    if !reading.ignored.is_empty() {
        notes.push(format!("columns not used: {}", reading.ignored.join(", ")));
    }
    if reading.skipped > 0 {
        let what = if matches!(reading.input, Input::Grid(_)) { "infinite entries" } else { "invalid rows" };
        notes.push(format!("{} {what} counted out", reading.skipped));
    }
    notes
}
