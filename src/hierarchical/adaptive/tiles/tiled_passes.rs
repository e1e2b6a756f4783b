//! Passes over tiles: each is asked, and what they say stands one behind another as if one had said it.

use super::tile_extent::TileExtent;
use super::tile_question::{SentSurface, TileAsk, TileQuestion, Weighing};
use crate::adaptive::contact_passes::{ContactPasses, LeftOutContacts, PassColumns, PlaneMoments, PlaneSquares, added};
use crate::adaptive::local_scale::{ShareRule, noise_ratios};
use crate::adaptive::split_test::{CellEvidence, SplitLimits};
use crate::equations::{CellSums, ColumnKind, SumLayout};
use crate::error::HierarchyError;
use crate::field::HierarchicalField;
use palpate_geometry::contact::Orientation;

/// Whoever has the tiles.
pub trait TileSource {
    /// What every tile answers to its own question, in the order of the tiles.
    ///
    /// # Errors
    /// When tiles cannot be read, or do not answer.
    fn answers(&mut self, questions: Vec<TileQuestion>) -> Result<Vec<Vec<f64>>, HierarchyError>;
}

/// All contacts, tile by tile.
pub(super) struct TiledPasses<'a> {
    extents: &'a [TileExtent],
    columns: PassColumns,
    source: &'a mut dyn TileSource,
    weighing: Option<(HierarchicalField, ShareRule, Vec<f64>)>,
}

fn wrong(what: &str) -> HierarchyError {
    HierarchyError::Parts { what: what.into() }
}

impl<'a> TiledPasses<'a> {
    /// Tiles that are whole runs of base cells, one behind another.
    pub(super) fn new(
        extents: &'a [TileExtent],
        roots: usize,
        degree: [usize; 2],
        source: &'a mut dyn TileSource,
    ) -> Result<TiledPasses<'a>, HierarchyError> {
        let mut next = 0;
        for extent in extents {
            if extent.roots.start != next || extent.roots.end < next {
                return Err(wrong("tiles that leave base cells out, or hold some twice"));
            }
            next = extent.roots.end;
        }
        let Some(first) = extents.first().filter(|_| next == roots) else {
            return Err(wrong("tiles that leave base cells out"));
        };
        if extents.iter().any(|extent| (extent.kind, extent.total) != (first.kind, first.total)) {
            return Err(wrong("tiles of different contacts"));
        }
        let kind = ColumnKind::of_word(first.kind).ok_or_else(|| wrong("tiles of another version"))?;
        let bare = kind.contacts(Vec::new());
        let normals = matches!(bare.orientation, Orientation::Normals { .. });
        let columns = PassColumns { count: first.total, layout: SumLayout::of(degree, &bare), normals };
        Ok(TiledPasses { extents, columns, source, weighing: None })
    }

    /// Answers of all tiles.
    fn ask(&mut self, field: &HierarchicalField, ask: TileAsk) -> Result<Vec<Vec<f64>>, HierarchyError> {
        let question = |extent: &TileExtent| {
            let (surface, own) = SentSurface::of(field, extent);
            let weighing = self.weighing.as_ref().filter(|_| ask != TileAsk::BlockScales);
            let weighing = weighing.map(|(field, rule, ratios)| Weighing {
                surface: SentSurface::of(field, extent).0,
                rule: *rule,
                ratios: ratios.clone(),
            });
            TileQuestion { surface, own, weighing, ask }
        };
        let questions: Vec<TileQuestion> = self.extents.iter().map(question).collect();
        let answers = self.source.answers(questions)?;
        if answers.len() == self.extents.len() { Ok(answers) } else { Err(wrong("tiles that do not answer")) }
    }

    /// So many numbers for every cell.
    fn by_cell<const N: usize>(
        &mut self,
        field: &HierarchicalField,
        ask: TileAsk,
    ) -> Result<Vec<[f64; N]>, HierarchyError> {
        let all = self.ask(field, ask)?.concat();
        let (rows, rest) = all.as_chunks();
        let whole = rest.is_empty() && rows.len() == field.space().leaves().len();
        if whole { Ok(rows.to_vec()) } else { Err(wrong("answers about other cells")) }
    }
}

impl ContactPasses for TiledPasses<'_> {
    fn columns(&self) -> PassColumns {
        self.columns
    }

    fn about(&mut self, _field: &HierarchicalField) -> Result<(), HierarchyError> {
        // every question brings its surface
        Ok(())
    }

    fn weigh(&mut self, field: &HierarchicalField, rule: ShareRule, noise_varies: bool) -> Result<(), HierarchyError> {
        let ratios =
            if noise_varies { noise_ratios(&self.ask(field, TileAsk::BlockScales)?.concat()) } else { Vec::new() };
        self.weighing = (rule != ShareRule::All || noise_varies).then(|| (field.clone(), rule, ratios));
        Ok(())
    }

    fn sums(&mut self, field: &HierarchicalField) -> Result<CellSums, HierarchyError> {
        let sums = CellSums::of_values(self.columns.layout, self.ask(field, TileAsk::Sums)?.concat());
        if sums.cells() == field.space().leaves().len() { Ok(sums) } else { Err(wrong("answers about other cells")) }
    }

    fn evidence(
        &mut self,
        field: &HierarchicalField,
        limits: SplitLimits,
    ) -> Result<Vec<CellEvidence>, HierarchyError> {
        let rows = self.by_cell(field, TileAsk::Evidence(limits))?;
        Ok(rows.into_iter().map(|[significance, excess]| CellEvidence { significance, excess }).collect())
    }

    fn left_out(&mut self, field: &HierarchicalField) -> Result<LeftOutContacts, HierarchyError> {
        let mut sum = LeftOutContacts::default();
        for answer in self.ask(field, TileAsk::LeftOut)? {
            let [count, high, low] = answer[..] else { return Err(wrong("tiles that do not answer")) };
            sum = sum.with(LeftOutContacts { count: count as usize, fingerprint: (high as u64) << 32 | low as u64 });
        }
        Ok(sum)
    }

    fn outliers(&mut self, field: &HierarchicalField) -> Result<Vec<usize>, HierarchyError> {
        let mut outliers: Vec<usize> =
            self.ask(field, TileAsk::Outliers)?.iter().flatten().map(|number| *number as usize).collect();
        outliers.sort_unstable();
        Ok(outliers)
    }

    fn plane_moments(&mut self, field: &HierarchicalField) -> Result<PlaneMoments, HierarchyError> {
        Ok(added(self.by_cell(field, TileAsk::PlaneMoments)?))
    }

    fn plane_squares(&mut self, field: &HierarchicalField, plane: [f64; 3]) -> Result<PlaneSquares, HierarchyError> {
        Ok(added(self.by_cell(field, TileAsk::PlaneSquares(plane))?))
    }
}
