//! Contacts that are more than memory holds: an adaptive surface from files, to the bits of one memory.
//!
//! ```text
//! table -> pieces -> spool in a temporary folder -> tiles of the base grid -> fit, each pass through all tiles
//! ```
//!
//! Each contact is read once. Ctrl-C removes the folder and ends, as it ends every fit.

use crate::io::{Input, IoError, Places, Reading, TablePieces, TemporaryFolder};
use palpate_fitting::fit::FitOptions;
use palpate_geometry::contact::Contacts;
use palpate_geometry::shape::Outline;
use palpate_hierarchical::HierarchyError;
use palpate_hierarchical::adaptive::tiles::{ContactSpool, StoredTiles, TileQuestion, TileSource, fit_tiles};
use palpate_hierarchical::adaptive::{AdaptiveFit, AdaptiveOptions};

use super::adaptive_model::{GRID, TypedForAdaptive, adaptive_found, adaptive_options, refused};
use super::failure::{Failure, fit_message};
use super::found::Found;
use super::output::Spinner;
use super::preparation::PreparationFlags;

/// Bytes in memory for a contact of the tile at hand, with its residuals and shares, twice while it is sorted.
const BYTES_OF_CONTACT: u64 = 256;
/// Least and most contacts of a tile: few hide the time of opening a file, many gain nothing.
const CONTACTS_OF_TILE: [usize; 2] = [4096, 4_000_000];

/// What is asked of contacts in pieces.
pub(super) struct PiecesQuestion<'a> {
    pub(super) typed: TypedForAdaptive,
    pub(super) options: FitOptions,
    pub(super) preparation: &'a PreparationFlags,
    pub(super) bare: bool,
    /// Bytes.
    pub(super) memory: u64,
    /// No model was named.
    pub(super) is_unnamed: bool,
}

/// The answer, and what was read of the table but its contacts.
pub(super) struct PiecesAnswer {
    pub(super) found: Found,
    pub(super) reading: Reading,
}

/// Contacts on their way into the folder.
struct SpoolingTable<'a> {
    spool: ContactSpool,
    reading: Reading,
    question: &'a PiecesQuestion<'a>,
    /// Numbers of the first contacts of all pieces, and where these stand.
    places: Vec<(usize, Places)>,
    /// Contacts that are taken, and all.
    taken: usize,
    all: usize,
}

/// Fits what comes in pieces; `spinner` shows what is done.
pub(super) fn fit_in_pieces(
    mut pieces: TablePieces,
    question: &PiecesQuestion,
    spinner: Option<&Spinner>,
) -> Result<PiecesAnswer, Failure> {
    let file = pieces.file().to_string();
    let told = |error| refused(error, 0, &question.options).words();
    question.preparation.check_pieces().map_err(|what| Failure::Input(format!("{file}: {what}")))?;
    question.options.check().map_err(|error| Failure::Input(fit_message(&error)))?;
    let asked = adaptive_options(&question.typed, &question.options, question.bare);
    let asked = asked.map_err(|error| Failure::Input(format!("{file}: {}", fit_message(&error))))?;
    asked.check().map_err(|error| Failure::Input(format!("{file}: {}", told(error))))?;
    let folder = TemporaryFolder::new()?;
    let mut table = SpoolingTable::new(&folder, &file, question)?;
    let mut spool_all = || pieces.by_ref().try_for_each(|piece| table.take(piece?));
    match spinner {
        Some(spinner) => spinner.while_reading(&mut spool_all),
        None => spool_all(),
    }?;
    table.end(pieces.notes())?;
    let (found, mut reading) = table.fit(&folder, &asked, spinner)?;
    reading.notes.push(said(question));
    Ok(PiecesAnswer { found, reading })
}

/// Why the contacts were fitted from files.
fn said(question: &PiecesQuestion) -> String {
    let unnamed =
        if question.is_unnamed { "; of so many an adaptive surface is fitted, and no kind is recognised" } else { "" };
    format!(
        "the contacts would take more than {} MB of memory and were fitted from files{unnamed}",
        question.memory >> 20
    )
}

impl<'a> SpoolingTable<'a> {
    fn new(
        folder: &TemporaryFolder,
        file: &str,
        question: &'a PiecesQuestion<'a>,
    ) -> Result<SpoolingTable<'a>, Failure> {
        let spool = ContactSpool::new(&folder.path().join("contacts")).map_err(|error| of_files(folder, &error))?;
        let reading = Reading {
            input: Input::Contacts(Contacts::default()),
            file: file.into(),
            skipped: 0,
            ignored: Vec::new(),
            places: None,
            notes: Vec::new(),
            viewpoint: None,
            unit: None,
        };
        Ok(SpoolingTable { spool, reading, question, places: Vec::new(), taken: 0, all: 0 })
    }

    /// A piece: the part of it that was asked for, with its normals as they were asked for.
    fn take(&mut self, mut piece: Reading) -> Result<(), Failure> {
        let Input::Contacts(contacts) = &mut piece.input else { return Ok(()) };
        self.reading.skipped += piece.skipped;
        self.all += contacts.len();
        if let Some(kept) = self.question.preparation.kept(contacts) {
            *contacts = contacts.in_order(&kept);
            piece.places = None;
        }
        if contacts.is_empty() {
            return Ok(());
        }
        let first = self.taken == 0;
        let notes = self.question.preparation.without_part().apply(&mut piece)?;
        if first {
            self.reading.notes = notes;
            self.reading.ignored = std::mem::take(&mut piece.ignored);
            self.reading.unit = piece.unit.take();
        }
        self.places.extend(piece.places.take().map(|places| (self.taken, places)));
        let Input::Contacts(contacts) = &piece.input else { return Ok(()) };
        self.taken += contacts.len();
        self.spool.add(contacts).map_err(|error| self.refused(error))
    }

    /// All pieces have come.
    fn end(&mut self, notes: Vec<String>) -> Result<(), Failure> {
        let (file, skipped) = (self.reading.file.clone(), self.reading.skipped);
        if self.all == 0 {
            return Err(IoError::NoRows { file, skipped }.into());
        }
        self.reading.notes.splice(0..0, notes);
        if let Some(note) = self.question.preparation.part_note([self.taken, self.all]) {
            let note = note.map_err(|what| Failure::Input(format!("{file}: {what}")))?;
            self.reading.notes.push(note);
        }
        Ok(())
    }

    fn fit(
        mut self,
        folder: &TemporaryFolder,
        asked: &AdaptiveOptions,
        spinner: Option<&Spinner>,
    ) -> Result<(Found, Reading), Failure> {
        let count = self.taken;
        let phase = |what: String| spinner.iter().for_each(|spinner| spinner.phase(&what));
        let shown = self.spool.places(Outline::step_of(count)).map_err(|error| of_files(folder, &error))?;
        phase(format!("sorting {count} contacts"));
        let SpoolingTable { spool, reading, question, places, .. } = self;
        let wrong = |error| refused_at(error, &reading, &places, count, &question.options);
        let most = usize::try_from(question.memory / BYTES_OF_CONTACT).unwrap_or(usize::MAX);
        let tiles = spool.sorted(asked, most.clamp(CONTACTS_OF_TILE[0], CONTACTS_OF_TILE[1])).map_err(wrong)?;
        let fit =
            fit_of(tiles, asked, &|pass| phase(format!("fitting {count} contacts, pass {pass}"))).map_err(wrong)?;
        let (x, y) = shown.iter().map(|[x, y]| (*x, *y)).unzip();
        let outlined = Contacts::from_positions(x, y, vec![0.0; shown.len()]);
        let found = adaptive_found(fit, &outlined, &question.options, question.typed.grid.unwrap_or(GRID));
        Ok((found, reading))
    }

    fn refused(&self, error: HierarchyError) -> Failure {
        refused_at(error, &self.reading, &self.places, self.taken, &self.question.options)
    }
}

/// The fit; `passing` hears of each pass through the tiles.
fn fit_of(
    mut tiles: StoredTiles,
    asked: &AdaptiveOptions,
    passing: &dyn Fn(usize),
) -> Result<AdaptiveFit, HierarchyError> {
    let (extents, ground) = (tiles.extents().to_vec(), tiles.ground().clone());
    fit_tiles(&ground, &extents, &mut WatchedTiles { tiles: &mut tiles, passes: 0, passing }, asked)
}

/// Tiles that say when they are gone through.
struct WatchedTiles<'a> {
    tiles: &'a mut StoredTiles,
    passes: usize,
    passing: &'a dyn Fn(usize),
}

impl TileSource for WatchedTiles<'_> {
    fn answers(&mut self, questions: Vec<TileQuestion>) -> Result<Vec<Vec<f64>>, HierarchyError> {
        self.passes += 1;
        (self.passing)(self.passes);
        self.tiles.answers(questions)
    }
}

/// An error of files, with what names another place for them.
fn of_files(folder: &TemporaryFolder, error: &HierarchyError) -> Failure {
    Failure::Output(format!("{}: {error}; TMPDIR names another place", folder.path().display()))
}

/// A refusal in the words of other fits, with the line where it is about one contact.
fn refused_at(
    error: HierarchyError,
    reading: &Reading,
    places: &[(usize, Places)],
    count: usize,
    options: &FitOptions,
) -> Failure {
    let file = &reading.file;
    let index = match &error {
        HierarchyError::Parts { .. } => {
            return Failure::Output(format!("{file}: {error}; TMPDIR names another place for temporary files"));
        }
        HierarchyError::Outside { index, .. } => Some(*index),
        _ => None,
    };
    let behind = |index: usize| places.partition_point(|(first, _)| *first <= index).checked_sub(1);
    let line = index.and_then(|index| {
        let (first, places) = places.get(behind(index)?)?;
        Some(format!(", {}", places.of(index - first)))
    });
    Failure::Input(format!("{file}{}: {}", line.unwrap_or_default(), refused(error, count, options).words()))
}
