//! How large residuals are near every cell, and what share of a contact counts by it.
//!
//! ```text
//! s_Q = mad of r over the contacts of Q, at least 64 of them with those nearest in the order of the cells
//! share = min(1, clip s_Q / |r|) while cells are split (P. J. Huber), 1 or 0 in the last fits
//! ```
//!
//! Scattered outliers are few everywhere and leave the median alone. A feature that the surface cannot follow yet fills cells, so that
//! their scale grows and nothing of it is left out.

use std::ops::Range;

use crate::equations::{ContactResiduals, SortedContacts, SurfaceCells};
use palpate_numeric::statistics::{RAYLEIGH_TO_SD, mad, median};
use palpate_numeric::threads;

/// Contacts that a scale is taken from at least: its own error is then 10 %.
const FEWEST_OF_SCALE: usize = 64;
/// Contacts that a scale is taken from at most, evenly chosen: more narrow its error below 4 % and cost time.
const MOST_OF_SCALE: usize = 400;
/// Leaves that one thread takes at a time.
const PIECE: usize = 64;

/// Local scales of heights and of slopes or normals, leaf by leaf; 0 where residuals are rounding.
#[derive(Clone, Debug)]
pub(crate) struct LocalScales {
    pub heights: Vec<f64>,
    pub slopes: Vec<f64>,
}

impl LocalScales {
    pub(crate) fn of(
        surface: SurfaceCells<'_>,
        contacts: &SortedContacts,
        residuals: &ContactResiduals,
    ) -> LocalScales {
        let leaves = surface.cells;
        let weights = contacts.contacts().weights.z.as_deref();
        let pairs = threads::map(leaves.len(), PIECE, |leaf| {
            let range = contacts.of_cell(surface.mesh, leaves[leaf]);
            if range.is_empty() {
                return [0.0; 2];
            }
            let missing = FEWEST_OF_SCALE.saturating_sub(range.len()).div_ceil(2);
            let from = range.start.saturating_sub(missing);
            let to = contacts.len().min(range.end + missing);
            let step = (to - from).div_ceil(MOST_OF_SCALE);
            let counted = |r: &usize| weights.is_none_or(|w| w[*r] > 0.0);
            let heights = mad((from..to)
                .step_by(step)
                .filter(counted)
                .map(|r| residuals.heights[r] * weights.map_or(1.0, |w| w[r])));
            if residuals.slopes.is_empty() {
                return [heights, 0.0];
            }
            let lengths: Vec<f64> =
                (from..to).step_by(step).map(|r| residuals.slopes[r][0].hypot(residuals.slopes[r][1])).collect();
            [heights, RAYLEIGH_TO_SD * median(lengths).unwrap_or(0.0)]
        });
        let (heights, slopes) = pairs.into_iter().map(|[z, s]| (z, s)).unzip();
        LocalScales { heights, slopes }
    }
}

/// Deviation of a contact in local scales: that of its height or of its slope, whichever is larger; 0 where residuals are rounding.
#[inline]
pub(crate) fn deviation(residual: f64, slope: Option<[f64; 2]>, scales: [f64; 2]) -> f64 {
    let over = |value: f64, scale: f64| if scale > 0.0 { value / scale } else { 0.0 };
    let height = over(residual.abs(), scales[0]);
    // the length of a plane vector of unit variances exceeds t as rarely as one number exceeds about t - 0.4
    slope.map_or(height, |s| height.max(over(s[0].hypot(s[1]), scales[1]) - 0.4))
}

/// Contacts of a block whose noise is taken for one; neighbours in the order of the cells are neighbours in the plane.
pub(crate) const CONTACTS_OF_BLOCK: usize = 2000;
/// Fewer blocks do not tell noise that varies from chance.
const FEWEST_BLOCKS: usize = 4;
/// Of a block so many residuals are looked at: the scale is then off by 4 %, which costs the fit 1 % of its efficiency.
const LOOKED_AT: usize = 1000;
/// Ratios of variances beyond this are of residuals that are rounding.
const LARGEST_RATIO: f64 = 1e6;

/// Scales of the blocks that begin among the contacts `own` of a run of contacts, the first of which is the `before`-th of all `total`
/// ones. A block reaches as far beyond as it has contacts.
pub(crate) fn block_scales(
    contacts: &SortedContacts,
    residuals: &ContactResiduals,
    own: Range<usize>,
    [before, total]: [usize; 2],
) -> Vec<f64> {
    let weights = contacts.contacts().weights.z.as_deref();
    let last = total / CONTACTS_OF_BLOCK;
    let blocks = [own.start, own.end].map(|r| (before + r).div_ceil(CONTACTS_OF_BLOCK).min(last));
    threads::map(blocks[1] - blocks[0], 1, |k| {
        let from = (blocks[0] + k) * CONTACTS_OF_BLOCK - before;
        let step = CONTACTS_OF_BLOCK / LOOKED_AT;
        let looked_at = (from..from + CONTACTS_OF_BLOCK).step_by(step);
        mad(looked_at.map(|r| residuals.heights[r] * weights.map_or(1.0, |w| w[r])).filter(|r| *r != 0.0))
    })
}

/// How much a contact's squares count by the noise near it: the inverse of the block's variance, of mean 1. Empty where the contacts are
/// too few to tell.
pub(crate) fn noise_ratios(scales: &[f64]) -> Vec<f64> {
    if scales.len() < FEWEST_BLOCKS {
        return Vec::new();
    }
    let typical = median(scales.to_vec()).unwrap_or(0.0);
    let ratio = |scale: &f64| {
        let ratio = (typical / scale).powi(2);
        if ratio.is_finite() { ratio.clamp(1.0 / LARGEST_RATIO, LARGEST_RATIO) } else { 1.0 }
    };
    let ratios: Vec<f64> = scales.iter().map(ratio).collect();
    // of mean 1, so that their sum counts the contacts
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    ratios.into_iter().map(|ratio| ratio / mean).collect()
}

/// Multiplies every contact's share by its block's ratio, the first contact being the `before`-th of all; the contacts beyond the last
/// block count as part of it.
pub(crate) fn weigh_by_noise(shares: &mut [f64], ratios: &[f64], before: usize) {
    let Some(last) = ratios.len().checked_sub(1) else { return };
    for (r, share) in shares.iter_mut().enumerate() {
        *share *= ratios[((before + r) / CONTACTS_OF_BLOCK).min(last)];
    }
}

/// What becomes of a contact by its deviation in local scales.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ShareRule {
    /// All count alike.
    All,
    /// Beyond so many it counts as if it stood there.
    Clip(f64),
    /// Beyond so many it is left out.
    Reject(f64),
}

impl ShareRule {
    fn share(self, t: f64) -> f64 {
        match self {
            ShareRule::All => 1.0,
            ShareRule::Clip(clip) => {
                if t > clip {
                    clip / t
                } else {
                    1.0
                }
            }
            ShareRule::Reject(reject) => {
                if t > reject {
                    0.0
                } else {
                    1.0
                }
            }
        }
    }
}

/// Shares of all contacts by a rule of their deviation.
pub(crate) fn shares(
    surface: SurfaceCells<'_>,
    contacts: &SortedContacts,
    residuals: &ContactResiduals,
    rule: ShareRule,
) -> Vec<f64> {
    let weights = contacts.contacts().weights.z.as_deref();
    let scales = LocalScales::of(surface, contacts, residuals);
    let parts = threads::map(surface.cells.len(), PIECE, |leaf| {
        let range = contacts.of_cell(surface.mesh, surface.cells[leaf]);
        let scales = [scales.heights[leaf], scales.slopes[leaf]];
        let share = |r: usize| {
            let residual = residuals.heights[r] * weights.map_or(1.0, |w| w[r]);
            rule.share(deviation(residual, residuals.slopes.get(r).copied(), scales))
        };
        range.map(share).collect::<Vec<f64>>()
    });
    parts.concat()
}
