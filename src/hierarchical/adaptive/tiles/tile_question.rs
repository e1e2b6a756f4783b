//! What a tile is asked: a surface over the cells that its contacts lie in, how contacts count, and which numbers are wanted.

use std::ops::Range;

use super::packed::{Packer, Unpacker, damaged};
use super::tile_extent::TileExtent;
use crate::adaptive::local_scale::ShareRule;
use crate::adaptive::rules::SplitRule;
use crate::adaptive::split_test::SplitLimits;
use crate::equations::{SurfaceCells, codes_of_cell};
use crate::error::HierarchyError;
use crate::field::HierarchicalField;
use crate::mesh::{CellId, MAX_LEVEL, Mesh};

/// The cells of a surface that a tile's contacts lie in.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SentSurface {
    cells: Vec<CellId>,
    tables: Vec<f64>,
}

impl SentSurface {
    /// The cells of a field that a tile needs, and which of them are its own.
    pub(super) fn of(field: &HierarchicalField, extent: &TileExtent) -> (SentSurface, Range<usize>) {
        let (mesh, leaves) = (field.space().mesh(), field.space().leaves());
        let root_code = |root: usize| (root as u64) << (2 * MAX_LEVEL);
        let [from, to] = [root_code(extent.roots.start), root_code(extent.roots.end)];
        let own_from = leaves.partition_point(|cell| codes_of_cell(mesh, *cell)[1] <= from);
        let own_to = leaves.partition_point(|cell| codes_of_cell(mesh, *cell)[0] < to);
        let [mut first, mut last] = [own_from, own_to];
        if let Some([low, high]) = extent.codes {
            first = first.min(leaves.partition_point(|cell| codes_of_cell(mesh, *cell)[1] <= low));
            last = last.max(leaves.partition_point(|cell| codes_of_cell(mesh, *cell)[0] <= high));
        }
        let part = SurfaceCells::of(field).part(first..last);
        let sent = SentSurface { cells: part.cells.to_vec(), tables: part.tables.to_vec() };
        (sent, own_from - first..own_to - first)
    }

    pub(super) fn view<'a>(&'a self, mesh: &'a Mesh) -> Result<SurfaceCells<'a>, HierarchyError> {
        let surface = SurfaceCells { mesh, cells: &self.cells, tables: &self.tables };
        let base = mesh.tree().base();
        let inside = |cell: &CellId| (0..2).all(|k| ((cell.place[k] >> cell.level) as usize) < base[k]);
        let sound = self.tables.len() == self.cells.len() * surface.local_count() && self.cells.iter().all(inside);
        if sound { Ok(surface) } else { Err(damaged()) }
    }

    fn write(&self, packer: &mut Packer) {
        packer.cells(&self.cells);
        packer.reals(&self.tables);
    }

    fn read(reader: &mut Unpacker<'_>) -> Result<SentSurface, HierarchyError> {
        Ok(SentSurface { cells: reader.cells()?, tables: reader.reals()? })
    }
}

/// By which surface and rule contacts count, and how much the squares of each block of them do; no ratios: all alike.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Weighing {
    pub surface: SentSurface,
    pub rule: ShareRule,
    pub ratios: Vec<f64>,
}

/// Which numbers are wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum TileAsk {
    Sums,
    Evidence(SplitLimits),
    BlockScales,
    LeftOut,
    Outliers,
    PlaneMoments,
    PlaneSquares([f64; 3]),
}

impl TileAsk {
    pub(super) fn wants_residuals(self) -> bool {
        match self {
            TileAsk::LeftOut | TileAsk::Outliers | TileAsk::PlaneMoments => false,
            TileAsk::Sums | TileAsk::Evidence(_) | TileAsk::BlockScales | TileAsk::PlaneSquares(_) => true,
        }
    }

    fn write(self, packer: &mut Packer) {
        let (word, numbers) = match self {
            TileAsk::Sums => (0, Vec::new()),
            TileAsk::Evidence(limits) => (1, numbers_of(limits).to_vec()),
            TileAsk::BlockScales => (2, Vec::new()),
            TileAsk::LeftOut => (3, Vec::new()),
            TileAsk::Outliers => (4, Vec::new()),
            TileAsk::PlaneMoments => (5, Vec::new()),
            TileAsk::PlaneSquares(plane) => (6, plane.to_vec()),
        };
        packer.word(word);
        packer.reals(&numbers);
    }

    fn read(reader: &mut Unpacker<'_>) -> Result<TileAsk, HierarchyError> {
        let (word, numbers) = (reader.word()?, reader.reals()?);
        Ok(match (word, &numbers[..]) {
            (0, []) => TileAsk::Sums,
            (1, numbers) => TileAsk::Evidence(limits_of(numbers.try_into().map_err(|_| damaged())?)),
            (2, []) => TileAsk::BlockScales,
            (3, []) => TileAsk::LeftOut,
            (4, []) => TileAsk::Outliers,
            (5, []) => TileAsk::PlaneMoments,
            (6, [a, b, c]) => TileAsk::PlaneSquares([*a, *b, *c]),
            _ => return Err(damaged()),
        })
    }
}

/// Limits as numbers.
fn numbers_of(limits: SplitLimits) -> [f64; 7] {
    let SplitLimits { clip, least_contacts, deepest_level, rule } = limits;
    let SplitRule { most_boxes, contacts_of_box, reach_of_swings, shade } = rule;
    let counts = [least_contacts, deepest_level, most_boxes, contacts_of_box].map(|count| count as f64);
    [clip, counts[0], counts[1], counts[2], counts[3], f64::from(reach_of_swings), shade]
}

fn limits_of([clip, least, deepest, boxes, of_box, reach, shade]: [f64; 7]) -> SplitLimits {
    let [least_contacts, deepest_level, most_boxes, contacts_of_box] =
        [least, deepest, boxes, of_box].map(|count| count as usize);
    let rule = SplitRule { most_boxes, contacts_of_box, reach_of_swings: reach as u32, shade };
    SplitLimits { clip, least_contacts, deepest_level, rule }
}

/// One question to one tile.
#[derive(Clone, Debug, PartialEq)]
pub struct TileQuestion {
    pub(super) surface: SentSurface,
    /// The tile's own cells among those of the surface.
    pub(super) own: Range<usize>,
    pub(super) weighing: Option<Weighing>,
    pub(super) ask: TileAsk,
}

impl TileQuestion {
    /// The deepest level of its cells.
    pub(super) fn deepest(&self) -> usize {
        let weighed = self.weighing.as_ref().map_or(&[][..], |weighing| &weighing.surface.cells);
        self.surface.cells.iter().chain(weighed).map(|cell| usize::from(cell.level)).max().unwrap_or(0)
    }

    /// As bytes.
    pub fn pack(&self) -> Vec<u8> {
        let mut packer = Packer::default();
        self.surface.write(&mut packer);
        packer.words(&[self.own.start as u64, self.own.end as u64]);
        self.ask.write(&mut packer);
        if let Some(Weighing { surface, rule, ratios }) = &self.weighing {
            let (word, limit) = match rule {
                ShareRule::All => (0, 0.0),
                ShareRule::Clip(limit) => (1, *limit),
                ShareRule::Reject(limit) => (2, *limit),
            };
            packer.words(&[1, word]);
            packer.real(limit);
            packer.reals(ratios);
            surface.write(&mut packer);
        } else {
            packer.words(&[]);
        }
        packer.bytes
    }

    /// From bytes.
    ///
    /// # Errors
    /// [`HierarchyError::Parts`].
    pub fn unpack(bytes: &[u8]) -> Result<TileQuestion, HierarchyError> {
        let mut reader = Unpacker::new(bytes);
        let surface = SentSurface::read(&mut reader)?;
        let [from, to] = reader.words()?[..] else { return Err(damaged()) };
        let own = from as usize..to as usize;
        if own.start > own.end || own.end > surface.cells.len() {
            return Err(damaged());
        }
        let ask = TileAsk::read(&mut reader)?;
        let weighing = match reader.words()?[..] {
            [] => None,
            [1, word] => {
                let limit = reader.real()?;
                let rule = match word {
                    0 => ShareRule::All,
                    1 => ShareRule::Clip(limit),
                    2 => ShareRule::Reject(limit),
                    _ => return Err(damaged()),
                };
                let ratios = reader.reals()?;
                Some(Weighing { surface: SentSurface::read(&mut reader)?, rule, ratios })
            }
            _ => return Err(damaged()),
        };
        reader.end()?;
        Ok(TileQuestion { surface, own, weighing, ask })
    }
}
