//! Adaptive fits of contacts that lie in parts with many workers: what each does, and what the one that fits does.
//!
//! ```text
//! part -> bounds      all bounds -> ground      part, ground -> run      pieces of runs -> tile      tile, question -> answer
//! ```
//!
//! Everything that passes between them is bytes, and a function of its arguments: done again it gives the same.

use std::time::Instant;

use super::adaptive_model::{GRID, TypedForAdaptive, adaptive_found, adaptive_options, refused};
use super::embedded_fits::{FitAnswer, FitRefusal};
use super::tuned::TunedOption;
use palpate_fitting::fit::FitOptions;
use palpate_geometry::contact::Contacts;
use palpate_geometry::shape::Outline;
use palpate_hierarchical::HierarchyError;
use palpate_hierarchical::adaptive::tiles::{
    ContactRun, ContactTile, TileExtent, TileGround, TileQuestion, TileSource, beside_tile, fit_tiles,
};
use palpate_hierarchical::adaptive::{AdaptiveOptions, ContactBounds};

/// Where a tile's neighbours are: of the side before and of the side behind, tiles with the first and the last of their contacts; and the
/// number of contacts before all of these.
pub type TileSides = ([Vec<(usize, [usize; 2])>; 2], usize);

/// A run as bytes, its contacts in every base cell, and places by which the outline of all is drawn.
pub type PartRun = (Vec<u8>, Vec<usize>, Vec<[f64; 2]>);

/// How many contacts there are, and least and largest x, y and z of them.
///
/// # Errors
/// What is wrong with the contacts.
pub fn part_bounds(contacts: &Contacts) -> Result<(usize, [[f64; 2]; 3]), String> {
    contacts.check().map_err(|error| error.to_string())?;
    let ContactBounds { count, x, y, z } = ContactBounds::of(contacts);
    Ok((count, [x, y, z]))
}

/// A part of the contacts, from this number on among all, in the order of the cells; how many there are in every base cell; and those of
/// them by which the outline of all is drawn.
///
/// # Errors
/// What is wrong with the contacts.
pub fn part_run(contacts: &Contacts, ground: &[u8], first: usize, total: usize) -> Result<PartRun, String> {
    let ground = TileGround::unpack(ground).map_err(words)?;
    let run = ContactRun::of(contacts, &ground, first).map_err(words)?;
    let step = Outline::step_of(total);
    let shown = (first.next_multiple_of(step)..first + contacts.len()).step_by(step);
    let shown = shown.map(|r| [contacts.x[r - first], contacts.y[r - first]]).collect();
    Ok((run.pack(), run.by_root(&ground), shown))
}

/// Those of a run that lie in base cells, from the first to before the second.
///
/// # Errors
/// When the bytes are none of a run.
pub fn run_of_roots(run: &[u8], [from, to]: [usize; 2]) -> Result<Vec<u8>, String> {
    Ok(ContactRun::unpack(run).map_err(words)?.of_roots(from..to).pack())
}

/// Those of a run from the first to before the second.
///
/// # Errors
/// When the bytes are none of a run, or it has fewer.
pub fn run_slice(run: &[u8], [from, to]: [usize; 2]) -> Result<Vec<u8>, String> {
    let run = ContactRun::unpack(run).map_err(words)?;
    if from > to || to > run.len() {
        return Err(format!("contacts {from} to {to} of {}", run.len()));
    }
    Ok(run.slice(from..to).pack())
}

/// All contacts of some runs in one.
///
/// # Errors
/// When the bytes are none of runs, or some come with columns that others lack.
pub fn merged_runs(runs: &[Vec<u8>]) -> Result<Vec<u8>, String> {
    let runs = unpacked(runs)?;
    Ok(ContactRun::merged(&runs).map_err(words)?.pack())
}

/// Where the contacts beside a tile's own are, by the number of contacts of every tile.
pub fn tile_sides(counts: &[usize], tile: usize) -> TileSides {
    let (sides, before) = beside_tile(counts, tile);
    let plain = |side: Vec<(usize, std::ops::Range<usize>)>| {
        side.into_iter().map(|(other, range)| (other, [range.start, range.end])).collect()
    };
    (sides.map(plain), before)
}

/// The tile of base cells from the first to before the second, and what whoever asks must know of it.
///
/// # Errors
/// When the bytes are none of runs, or some come with columns that others lack.
pub fn contact_tile(
    ground: &[u8],
    [from, to]: [usize; 2],
    own: &[u8],
    sides: [&[Vec<u8>]; 2],
    before_and_total: [usize; 2],
) -> Result<(Vec<u8>, Vec<u8>), String> {
    let ground = TileGround::unpack(ground).map_err(words)?;
    let own = ContactRun::unpack(own).map_err(words)?;
    let sides = [unpacked(sides[0])?, unpacked(sides[1])?];
    let tile = ContactTile::new(&ground, from..to, own, sides, before_and_total).map_err(words)?;
    Ok((tile.pack(), tile.extent().pack()))
}

/// What a tile answers.
///
/// # Errors
/// When the bytes are none of a tile and a question to it.
pub fn tile_answer(tile: &[u8], question: &[u8]) -> Result<Vec<f64>, String> {
    let (tile, question) = (ContactTile::unpack(tile).map_err(words)?, TileQuestion::unpack(question).map_err(words)?);
    tile.answer(&question).map_err(words)
}

fn unpacked(runs: &[Vec<u8>]) -> Result<Vec<ContactRun>, String> {
    runs.iter().map(|run| ContactRun::unpack(run).map_err(words)).collect()
}

#[expect(clippy::needless_pass_by_value, reason = "it stands where errors are mapped")]
fn words(error: HierarchyError) -> String {
    error.to_string()
}

/// Whoever has the tiles: questions in their order, answers in the same.
pub type AskTiles<'a> = &'a mut dyn FnMut(Vec<Vec<u8>>) -> Result<Vec<Vec<f64>>, String>;

struct AskedTiles<'a>(AskTiles<'a>);

impl TileSource for AskedTiles<'_> {
    fn answers(&mut self, questions: Vec<TileQuestion>) -> Result<Vec<Vec<f64>>, HierarchyError> {
        (self.0)(questions.iter().map(TileQuestion::pack).collect()).map_err(|what| HierarchyError::Parts { what })
    }
}

/// A fit of contacts that are tiles in other hands.
#[derive(Debug)]
pub struct TiledFit {
    asked: AdaptiveOptions,
    options: FitOptions,
    ground: TileGround,
    grid: Option<[usize; 2]>,
    bare: bool,
}

impl TiledFit {
    /// From where the contacts of all parts are, as [`part_bounds`] tells.
    ///
    /// # Errors
    /// Faulty options, contacts that span no rectangle.
    pub fn new(
        parts: &[(usize, [[f64; 2]; 3])],
        [degree, grid]: [Option<[usize; 2]>; 2],
        tuned: Vec<TunedOption>,
        options: &FitOptions,
        bare: bool,
    ) -> Result<TiledFit, FitRefusal> {
        options.check().map_err(FitRefusal::Fit)?;
        let asked =
            adaptive_options(&TypedForAdaptive { degree, grid, tuned }, options, bare).map_err(FitRefusal::Fit)?;
        let of = |(count, [x, y, z]): &(usize, [[f64; 2]; 3])| ContactBounds { count: *count, x: *x, y: *y, z: *z };
        let bounds = parts.iter().map(of).fold(ContactBounds::NONE, ContactBounds::with);
        let ground = TileGround::of(&bounds, &asked).map_err(|error| refused(error, bounds.count, options))?;
        Ok(TiledFit { asked, options: options.clone(), ground, grid, bare })
    }

    /// What every worker must have.
    pub fn ground(&self) -> Vec<u8> {
        self.ground.pack()
    }

    /// Cells of the base grid.
    pub fn roots(&self) -> usize {
        self.ground.roots()
    }

    /// The answer, by asking the tiles; `shown` are the places that [`part_run`] gave, in their order.
    ///
    /// # Errors
    /// Those of a fit, and of whoever is asked.
    pub fn fit(&self, extents: &[Vec<u8>], shown: &[[f64; 2]], ask: AskTiles<'_>) -> Result<FitAnswer, FitRefusal> {
        let clock = Instant::now();
        let wrong = |error| FitRefusal::from(refused(error, 0, &self.options));
        let extents: Vec<TileExtent> =
            extents.iter().map(|bytes| TileExtent::unpack(bytes)).collect::<Result<_, _>>().map_err(wrong)?;
        let fit = fit_tiles(&self.ground, &extents, &mut AskedTiles(ask), &self.asked).map_err(wrong)?;
        let (x, y) = shown.iter().map(|[x, y]| (*x, *y)).unzip();
        let places = Contacts::from_positions(x, y, vec![0.0; shown.len()]);
        let found = adaptive_found(fit, &places, &self.options, self.grid.unwrap_or(GRID));
        Ok(FitAnswer::without_contacts(found, self.bare, clock.elapsed().as_secs_f64()))
    }
}
