//! A tile: the contacts of a run of base cells, and the few before and behind them that its own are judged beside.
//!
//! ```text
//! answer(tile, question) = numbers of its own cells        a function of both alone
//! ```
//!
//! Whoever has the tile can answer, as often as it is asked and on whichever machine: nothing is kept from question to question.

use std::ops::Range;

use super::contact_run::{ContactRun, TileGround};
use super::packed::{Packer, Unpacker};
use super::tile_extent::TileExtent;
use super::tile_question::{TileAsk, TileQuestion};
use crate::adaptive::contact_passes::{CellContacts, LeftOutContacts};
use crate::adaptive::local_scale::{CONTACTS_OF_BLOCK, LocalScales, block_scales, shares, weigh_by_noise};
use crate::adaptive::split_test::SplitTest;
use crate::equations::{CellSums, ColumnKind, ContactResiduals, SumLayout};
use crate::error::HierarchyError;
use crate::mesh::Mesh;

/// A tile with what it must know of the others.
#[derive(Clone, Debug)]
pub struct ContactTile {
    ground: TileGround,
    run: ContactRun,
    roots: Range<usize>,
    /// Its own contacts among those of the run.
    own: Range<usize>,
    /// Contacts of all before the first of the run, and of all.
    before: usize,
    total: usize,
}

/// Contacts on both sides of a tile's own that are looked at with them: a block of the noise begun before them, or not yet ended.
const BESIDE: usize = CONTACTS_OF_BLOCK;

/// Tiles and runs of their own contacts, on the side before and on the side behind; and the number of all contacts before these.
pub type RunsBeside = ([Vec<(usize, Range<usize>)>; 2], usize);

/// Where the contacts beside a tile's own are: for the side before and the side behind, tiles and the runs of their own contacts in
/// order; and the number of all contacts before them. `counts` are those of all tiles.
pub fn beside_tile(counts: &[usize], tile: usize) -> RunsBeside {
    let (mut earlier, mut missing) = (Vec::new(), BESIDE);
    for other in (0..tile).rev() {
        let taken = missing.min(counts[other]);
        missing -= taken;
        if taken > 0 {
            earlier.push((other, counts[other] - taken..counts[other]));
        }
    }
    earlier.reverse();
    let before = counts[..tile].iter().sum::<usize>() - (BESIDE - missing);
    let (mut later, mut missing) = (Vec::new(), BESIDE);
    for (other, count) in counts.iter().enumerate().skip(tile + 1) {
        let taken = missing.min(*count);
        missing -= taken;
        if taken > 0 {
            later.push((other, 0..taken));
        }
    }
    ([earlier, later], before)
}

impl ContactTile {
    /// The tile of a run of base cells from its own contacts and those on both sides, as [`beside_tile`] names them.
    ///
    /// # Errors
    /// When some come with columns that others lack.
    pub fn new(
        ground: &TileGround,
        roots: Range<usize>,
        own: ContactRun,
        [earlier, later]: [Vec<ContactRun>; 2],
        [before, total]: [usize; 2],
    ) -> Result<ContactTile, HierarchyError> {
        let ahead: usize = earlier.iter().map(ContactRun::len).sum();
        let range = ahead..ahead + own.len();
        let runs: Vec<ContactRun> = earlier.into_iter().chain([own]).chain(later).collect();
        let run = ContactRun::merged(&runs)?;
        Ok(ContactTile { ground: ground.clone(), run, roots, own: range, before, total })
    }

    /// What whoever asks must know.
    pub fn extent(&self) -> TileExtent {
        let (codes, _) = self.run.sorted.codes_and_numbers();
        let codes = codes.first().zip(codes.last()).map(|(first, last)| [*first, *last]);
        let kind = ColumnKind::of(self.run.sorted.contacts()).to_word();
        TileExtent { roots: self.roots.clone(), codes, kind, total: self.total }
    }

    /// The numbers that a question asks for, cell by cell of its own, or block by block.
    ///
    /// # Errors
    /// [`HierarchyError::Parts`] where the question is about other cells.
    pub fn answer(&self, question: &TileQuestion) -> Result<Vec<f64>, HierarchyError> {
        let contacts = &self.run.sorted;
        let levels = self.ground.ground.mesh.levels().at(0).map(|level| level.knots().clone());
        let mesh = Mesh::with_levels(levels, question.deepest())?;
        let surface = question.surface.view(&mesh)?;
        let weighed = self.shares(question, &mesh)?;
        let own = surface.part(question.own.clone());
        let residuals = if question.ask.wants_residuals() {
            ContactResiduals::of(contacts, surface)
        } else {
            ContactResiduals::default()
        };
        let cells = CellContacts { surface: own, contacts, residuals: &residuals, shares: weighed.as_deref() };
        Ok(match question.ask {
            TileAsk::Sums => {
                let layout = SumLayout::of(mesh.levels().degree(), contacts.contacts());
                let mut sums = CellSums::empty(own.cells.len(), layout);
                sums.add(contacts, own, &residuals, weighed.as_deref());
                sums.into_values()
            }
            TileAsk::Evidence(limits) => {
                let scales = LocalScales::of(own, contacts, &residuals);
                let test = SplitTest { surface: own, contacts, residuals: &residuals, scales: &scales, limits };
                test.evidence().iter().flat_map(|cell| [cell.significance, cell.excess]).collect()
            }
            TileAsk::BlockScales => block_scales(contacts, &residuals, self.own.clone(), [self.before, self.total]),
            TileAsk::LeftOut => {
                let LeftOutContacts { count, fingerprint } = LeftOutContacts::of(cells.left_out());
                vec![count as f64, (fingerprint >> 32) as f64, (fingerprint & 0xffff_ffff) as f64]
            }
            TileAsk::Outliers => cells.left_out().map(|number| number as f64).collect(),
            TileAsk::PlaneMoments => cells.plane_moments().concat(),
            TileAsk::PlaneSquares(plane) => cells.plane_squares(plane).concat(),
        })
    }

    /// How the contacts of the run count; those beside the tile's own may have less to be judged by than they ought to.
    fn shares(&self, question: &TileQuestion, mesh: &Mesh) -> Result<Option<Vec<f64>>, HierarchyError> {
        let Some(weighing) = &question.weighing else { return Ok(None) };
        let (contacts, surface) = (&self.run.sorted, weighing.surface.view(mesh)?);
        let residuals = ContactResiduals::of(contacts, surface);
        let mut made = shares(surface, contacts, &residuals, weighing.rule);
        weigh_by_noise(&mut made, &weighing.ratios, self.before);
        Ok(Some(made))
    }

    /// As bytes.
    pub fn pack(&self) -> Vec<u8> {
        let mut packer = Packer::default();
        let ground: Vec<u64> = self.ground.pack().iter().map(|byte| u64::from(*byte)).collect();
        packer.words(&ground);
        let ContactTile { roots, own, before, total, .. } = self;
        [roots.start, roots.end, own.start, own.end, *before, *total].iter().for_each(|k| packer.word(*k as u64));
        self.run.write(&mut packer);
        packer.bytes
    }

    /// From bytes.
    ///
    /// # Errors
    /// [`HierarchyError::Parts`].
    pub fn unpack(bytes: &[u8]) -> Result<ContactTile, HierarchyError> {
        let mut reader = Unpacker::new(bytes);
        let ground: Vec<u8> = reader.words()?.iter().map(|byte| *byte as u8).collect();
        let ground = TileGround::unpack(&ground)?;
        let mut next = || reader.size();
        let (roots, own, before, total) = (next()?..next()?, next()?..next()?, next()?, next()?);
        let run = ContactRun::read(&mut reader)?;
        reader.end()?;
        Ok(ContactTile { ground, run, roots, own, before, total })
    }
}
