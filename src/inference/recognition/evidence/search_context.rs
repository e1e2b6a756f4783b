//! What every hypothesis is asked about: the contacts and their cells, how they may err, and what decides.

use crate::bodies::Tuning;
use crate::recognition::contacts::Cells;
use crate::recognition::noise::Limit;
use palpate_numeric::vector::Vector;

use super::linearised::FactorPair;

/// What every look is at.
#[derive(Clone, Copy)]
pub(crate) struct SearchContext<'a> {
    pub(crate) cells: &'a Cells,
    pub(crate) contacts: &'a [Vector],
    pub(crate) factors: &'a FactorPair<'a>,
    pub(crate) limit: Limit,
    pub(crate) tuning: &'a Tuning,
}
