//! Contacts in memory: residuals and shares are kept from pass to pass.

use super::contact_passes::{
    CellContacts, ContactPasses, LeftOutContacts, PassColumns, PlaneMoments, PlaneSquares, added,
};
use super::local_scale::{LocalScales, ShareRule, block_scales, noise_ratios, shares, weigh_by_noise};
use super::split_test::{CellEvidence, SplitLimits, SplitTest};
use crate::equations::{CellSums, ContactResiduals, SortedContacts, SumLayout, SurfaceCells};
use crate::error::HierarchyError;
use crate::field::HierarchicalField;
use palpate_geometry::contact::Orientation;

/// All contacts, with what is left of them by the surface at hand, and how they count.
#[derive(Clone, Debug)]
pub(super) struct HeldContacts {
    pub sorted: SortedContacts,
    pub shares: Option<Vec<f64>>,
    residuals: ContactResiduals,
    layout: SumLayout,
}

impl HeldContacts {
    pub(super) fn new(sorted: SortedContacts, degree: [usize; 2]) -> HeldContacts {
        let layout = SumLayout::of(degree, sorted.contacts());
        HeldContacts { sorted, shares: None, residuals: ContactResiduals::default(), layout }
    }

    fn cells<'a>(&'a self, field: &'a HierarchicalField) -> CellContacts<'a> {
        let HeldContacts { sorted, shares, residuals, .. } = self;
        CellContacts { surface: SurfaceCells::of(field), contacts: sorted, residuals, shares: shares.as_deref() }
    }
}

impl ContactPasses for HeldContacts {
    fn columns(&self) -> PassColumns {
        let normals = matches!(self.sorted.contacts().orientation, Orientation::Normals { .. });
        PassColumns { count: self.sorted.len(), layout: self.layout, normals }
    }

    fn about(&mut self, field: &HierarchicalField) -> Result<(), HierarchyError> {
        self.residuals = ContactResiduals::of(&self.sorted, SurfaceCells::of(field));
        Ok(())
    }

    fn weigh(&mut self, field: &HierarchicalField, rule: ShareRule, noise_varies: bool) -> Result<(), HierarchyError> {
        let HeldContacts { sorted, residuals, .. } = self;
        if rule == ShareRule::All && !noise_varies {
            self.shares = None;
            return Ok(());
        }
        let mut made = shares(SurfaceCells::of(field), sorted, residuals, rule);
        if noise_varies {
            let count = sorted.len();
            weigh_by_noise(&mut made, &noise_ratios(&block_scales(sorted, residuals, 0..count, [0, count])), 0);
        }
        self.shares = Some(made);
        Ok(())
    }

    fn sums(&mut self, field: &HierarchicalField) -> Result<CellSums, HierarchyError> {
        let mut sums = CellSums::empty(field.space().leaves().len(), self.layout);
        sums.add(&self.sorted, SurfaceCells::of(field), &self.residuals, self.shares.as_deref());
        Ok(sums)
    }

    fn evidence(
        &mut self,
        field: &HierarchicalField,
        limits: SplitLimits,
    ) -> Result<Vec<CellEvidence>, HierarchyError> {
        let (surface, residuals, contacts) = (SurfaceCells::of(field), &self.residuals, &self.sorted);
        let scales = LocalScales::of(surface, contacts, residuals);
        Ok(SplitTest { surface, contacts, residuals, scales: &scales, limits }.evidence())
    }

    fn left_out(&mut self, field: &HierarchicalField) -> Result<LeftOutContacts, HierarchyError> {
        Ok(LeftOutContacts::of(self.cells(field).left_out()))
    }

    fn outliers(&mut self, field: &HierarchicalField) -> Result<Vec<usize>, HierarchyError> {
        let mut outliers: Vec<usize> = self.cells(field).left_out().collect();
        outliers.sort_unstable();
        Ok(outliers)
    }

    fn plane_moments(&mut self, field: &HierarchicalField) -> Result<PlaneMoments, HierarchyError> {
        Ok(added(self.cells(field).plane_moments()))
    }

    fn plane_squares(&mut self, field: &HierarchicalField, plane: [f64; 3]) -> Result<PlaneSquares, HierarchyError> {
        Ok(added(self.cells(field).plane_squares(plane)))
    }
}
