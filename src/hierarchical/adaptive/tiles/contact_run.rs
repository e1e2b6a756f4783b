//! Contacts in the order of the cells, a run of them at a time: what parts of the data are made into, and what tiles are made of.
//!
//! ```text
//! part of the contacts -> run -> its pieces by tile       pieces of all parts -> merged by (cell, number) -> tile
//! ```
//!
//! The order of the merged contacts is that of their cells, and within the smallest cell that of their numbers: it does not depend on the
//! parts.

use std::ops::Range;

use super::packed::{Packer, Unpacker, damaged};
use crate::adaptive::ground::{ContactBounds, FitGround};
use crate::adaptive::options::AdaptiveOptions;
use crate::equations::{BlockWeights, ColumnKind, SortedContacts, columns_of};
use crate::error::HierarchyError;
use crate::mesh::Mesh;
use palpate_geometry::contact::{Contacts, Frame};
use palpate_numeric::bspline::Knots;

/// Frame and base grid of a fit whose contacts come in parts.
#[derive(Clone, Debug, PartialEq)]
pub struct TileGround {
    pub(super) ground: FitGround,
}

impl TileGround {
    /// From where all contacts are.
    ///
    /// # Errors
    /// Faulty options, contacts that span no rectangle.
    pub fn of(bounds: &ContactBounds, options: &AdaptiveOptions) -> Result<TileGround, HierarchyError> {
        FitGround::of(bounds, options).map(|ground| TileGround { ground })
    }

    /// Cells of the base grid: what tiles are whole runs of.
    pub fn roots(&self) -> usize {
        self.ground.mesh.tree().base().iter().product()
    }

    /// As bytes.
    pub fn pack(&self) -> Vec<u8> {
        let FitGround { frame, mesh, weights, declared } = &self.ground;
        let mut packer = Packer::default();
        packer.reals(&frame.origin);
        packer.real(frame.scale);
        for level in mesh.levels().at(0) {
            // uniform knots are evaluated as such: as a list they would give other last bits
            packer.words(&[level.knots().degree() as u64, level.knots().n_segments() as u64]);
            packer.reals(&level.knots().domain());
        }
        [weights.heights, weights.slopes].into_iter().for_each(|weight| packer.real(weight));
        packer.reals(declared.as_slice());
        packer.bytes
    }

    /// From bytes.
    ///
    /// # Errors
    /// [`HierarchyError::Parts`].
    pub fn unpack(bytes: &[u8]) -> Result<TileGround, HierarchyError> {
        let mut reader = Unpacker::new(bytes);
        let origin = reader.reals()?.try_into().map_err(|_| damaged())?;
        let frame = Frame { origin, scale: reader.real()?, ..Frame::IDENTITY };
        let mut axis = || {
            let [degree, segments] = reader.words()?[..] else { return Err(damaged()) };
            let [lo, hi] = reader.reals()?[..] else { return Err(damaged()) };
            Knots::uniform(degree as usize, segments as usize, lo, hi).map_err(|_| damaged())
        };
        let mesh = Mesh::new([axis()?, axis()?])?;
        let weights = BlockWeights { heights: reader.real()?, slopes: reader.real()? };
        let declared = reader.reals()?.first().copied();
        reader.end()?;
        Ok(TileGround { ground: FitGround { frame, mesh, weights, declared } })
    }
}

/// A run of contacts.
#[derive(Clone, Debug)]
pub struct ContactRun {
    pub(super) sorted: SortedContacts,
}

impl ContactRun {
    /// A part of the contacts, the first of which has this number among all.
    ///
    /// # Errors
    /// Faulty contacts, and contacts outside of the domain; numbers beyond 2^32.
    pub fn of(contacts: &Contacts, ground: &TileGround, first: usize) -> Result<ContactRun, HierarchyError> {
        let FitGround { frame, mesh, .. } = &ground.ground;
        let sorted = SortedContacts::new(contacts, frame, mesh).map_err(|error| match error {
            HierarchyError::Outside { index, x, y } => HierarchyError::Outside { index: first + index, x, y },
            other => other,
        })?;
        Ok(ContactRun { sorted: sorted.numbered_from(first)? })
    }

    /// Contacts.
    pub fn len(&self) -> usize {
        self.sorted.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.sorted.is_empty()
    }

    /// How many there are in every base cell.
    pub fn by_root(&self, ground: &TileGround) -> Vec<usize> {
        (0..ground.roots()).map(|root| self.sorted.of_roots(root..root + 1).len()).collect()
    }

    /// Those of a run of base cells.
    #[must_use]
    pub fn of_roots(&self, roots: Range<usize>) -> ContactRun {
        self.slice(self.sorted.of_roots(roots))
    }

    /// A run of them.
    #[must_use]
    pub fn slice(&self, range: Range<usize>) -> ContactRun {
        ContactRun { sorted: self.sorted.slice(range) }
    }

    /// All of these in one.
    ///
    /// # Errors
    /// When some come with columns that others lack.
    pub fn merged(runs: &[ContactRun]) -> Result<ContactRun, HierarchyError> {
        let runs: Vec<SortedContacts> = runs.iter().map(|run| run.sorted.clone()).collect();
        Ok(ContactRun { sorted: SortedContacts::merged(&runs)? })
    }

    /// As bytes.
    pub fn pack(&self) -> Vec<u8> {
        let mut packer = Packer::default();
        self.write(&mut packer);
        packer.bytes
    }

    pub(super) fn write(&self, packer: &mut Packer) {
        packer.word(ColumnKind::of(self.sorted.contacts()).to_word());
        columns_of(self.sorted.contacts()).iter().for_each(|column| packer.reals(column));
        let (codes, numbers) = self.sorted.codes_and_numbers();
        packer.words(codes);
        packer.numbers(numbers);
    }

    /// From bytes.
    ///
    /// # Errors
    /// [`HierarchyError::Parts`].
    pub fn unpack(bytes: &[u8]) -> Result<ContactRun, HierarchyError> {
        let mut reader = Unpacker::new(bytes);
        let run = ContactRun::read(&mut reader)?;
        reader.end()?;
        Ok(run)
    }

    pub(super) fn read(reader: &mut Unpacker<'_>) -> Result<ContactRun, HierarchyError> {
        let kind = ColumnKind::of_word(reader.word()?).ok_or_else(damaged)?;
        let columns = (0..kind.count()).map(|_| reader.reals()).collect::<Result<_, _>>()?;
        let sorted = SortedContacts::of_columns(kind, columns, reader.words()?, reader.numbers()?)?;
        Ok(ContactRun { sorted })
    }
}
