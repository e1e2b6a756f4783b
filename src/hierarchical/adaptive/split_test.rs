//! Does a cell hold more than noise? Residuals of neighbouring contacts against each other, box by box inside of the cell.
//!
//! ```text
//! F = [ sum_b n_b mean_b^2 / B ] / [ sum_b sum_(r in b) (r - mean_b)^2 / (n - B) ]      B boxes with contacts, of 2 x 2, 4 x 4, .. 32 x 32
//! ```
//!
//! Under noise alone F is Fisher's with B and n - B degrees of freedom whatever the noise of the cell is; the fit has taken part of the
//! numerator, which makes the test careful. Where the surface cannot follow, neighbours lie off together and F is large: in wide boxes
//! where a whole cell bends otherwise, in small ones where something small stands in it. The smallest significance counts, times the
//! number of grids. Residuals are clipped at a few local scales, so that outliers neither cause a split nor hide one.
//!
//! Cells are chosen by the step-up rule of Y. Benjamini and Y. Hochberg, *J. R. Stat. Soc. B* 57 (1995) 289: of those split, the expected
//! share that is noise is bounded. The children of a cell that was chosen are held to a significance of their own, because something is
//! there (D. Yekutieli, *J. Am. Stat. Assoc.* 103 (2008) 309).

use std::collections::BTreeSet;

use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use super::local_scale::LocalScales;
use super::rules::SplitRule;
use crate::equations::{ContactResiduals, SortedContacts, SurfaceCells};
use crate::mesh::CellId;
use crate::space::HierarchicalSpace;
use palpate_numeric::threads;

/// Leaves that one thread takes at a time.
const PIECE: usize = 64;

/// What is tested, and how.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SplitTest<'a> {
    pub surface: SurfaceCells<'a>,
    pub contacts: &'a SortedContacts,
    pub residuals: &'a ContactResiduals,
    pub scales: &'a LocalScales,
    pub limits: SplitLimits,
}

/// Which cells may be split, and what is seen of far residuals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SplitLimits {
    /// Residuals are clipped at so many local scales.
    pub clip: f64,
    pub least_contacts: usize,
    pub deepest_level: usize,
    pub rule: SplitRule,
}

/// What the residuals of a cell say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CellEvidence {
    /// How rarely noise alone gives as much; 1 where a cell cannot be split.
    pub significance: f64,
    /// Sum of squares beyond noise, in squares of residuals.
    pub excess: f64,
}

impl CellEvidence {
    const NONE: CellEvidence = CellEvidence { significance: 1.0, excess: 0.0 };
}

/// Count, sum and sum of squares of a box.
type BoxSums = [f64; 3];

impl SplitTest<'_> {
    /// Evidence in every leaf.
    pub(crate) fn evidence(&self) -> Vec<CellEvidence> {
        threads::map(self.surface.cells.len(), PIECE, |leaf| self.of_leaf(leaf))
    }

    fn of_leaf(&self, leaf: usize) -> CellEvidence {
        let cell = self.surface.cells[leaf];
        let range = self.contacts.of_cell(self.surface.mesh, cell);
        if range.len() < self.limits.least_contacts || usize::from(cell.level) >= self.limits.deepest_level {
            return CellEvidence::NONE;
        }
        let heights = self.of_kind(leaf, self.scales.heights[leaf], |r| self.residuals.heights[r]);
        if self.residuals.slopes.is_empty() {
            return heights;
        }
        let slopes = [0, 1].map(|k| self.of_kind(leaf, self.scales.slopes[leaf], |r| self.residuals.slopes[r][k]));
        // Bonferroni: three tests of one cell
        let least = slopes.iter().fold(heights.significance, |least, slope| least.min(slope.significance));
        // slopes count by their own scale, in squares of heights
        let ratio = (self.scales.heights[leaf] / self.scales.slopes[leaf].max(f64::MIN_POSITIVE)).powi(2);
        let excess = heights.excess + ratio * (slopes[0].excess + slopes[1].excess);
        CellEvidence { significance: (3.0 * least).min(1.0), excess }
    }

    /// Significance of one kind of residuals.
    fn of_kind(&self, leaf: usize, scale: f64, residual: impl Fn(usize) -> f64) -> CellEvidence {
        if scale.is_nan() || scale <= 0.0 {
            return CellEvidence::NONE;
        }
        let cell = self.surface.cells[leaf];
        let range = self.contacts.of_cell(self.surface.mesh, cell);
        let [centre, half] = self.surface.mesh.centre_and_half(cell);
        let columns = self.contacts.contacts();
        let mut side = finest_side(range.len(), &self.limits.rule);
        let place = |x: f64, axis: usize| {
            let along = ((x - centre[axis]) / half[axis] + 1.0) * 0.5 * side as f64;
            (along as usize).min(side - 1)
        };
        let limit = self.limits.clip * scale;
        let mut boxes = vec![[0.0; 3]; side * side];
        for r in range {
            if columns.weights.z.as_ref().is_some_and(|w| w[r] == 0.0) {
                continue;
            }
            let value = residual(r).clamp(-limit, limit);
            add(&mut boxes[place(columns.x[r], 0) * side + place(columns.y[r], 1)], [1.0, value, value * value]);
        }
        let finest = fisher(&boxes);
        let (mut least, mut grids) = (finest.significance, 1.0);
        while side > 2 {
            boxes = merged(&boxes, side);
            side /= 2;
            least = fisher(&boxes).significance.min(least);
            grids += 1.0;
        }
        CellEvidence { significance: (grids * least).min(1.0), excess: finest.excess }
    }
}

/// Boxes along a side for so many contacts: a power of two.
fn finest_side(contacts: usize, rule: &SplitRule) -> usize {
    let mut side = 2;
    while side < rule.most_boxes && 4 * side * side * rule.contacts_of_box <= contacts {
        side *= 2;
    }
    side
}

fn add(sums: &mut BoxSums, terms: BoxSums) {
    sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
}

/// Four boxes in one.
fn merged(boxes: &[BoxSums], side: usize) -> Vec<BoxSums> {
    let half = side / 2;
    let mut wide = vec![[0.0; 3]; half * half];
    for (k, sums) in boxes.iter().enumerate() {
        add(&mut wide[k / side / 2 * half + k % side / 2], *sums);
    }
    wide
}

/// How rarely noise alone gives means so far from zero.
fn fisher(boxes: &[BoxSums]) -> CellEvidence {
    let (mut count, mut filled, mut between, mut all) = (0.0, 0.0, 0.0, 0.0);
    for [n, sum, squares] in boxes.iter().filter(|sums| sums[0] > 0.0) {
        count += n;
        filled += 1.0;
        between += sum * sum / n;
        all += squares;
    }
    let freedom = count - filled;
    if freedom < 1.0 || all <= 0.0 {
        return CellEvidence::NONE;
    }
    let variance = (all - between).max(f64::EPSILON * all) / freedom;
    let significance = FisherSnedecor::new(filled, freedom).map_or(1.0, |law| law.sf(between / filled / variance));
    CellEvidence { significance, excess: (between - filled * variance).max(0.0) }
}

/// The leaves to split: the largest set in which at most the share `rate` is expected to be chance, and of the leaves of `suspected`
/// parents those that are significant `alone`; the others wait where they are not `unshaded`. None where these are as many as chance gives, and nothing else is to be split.
pub(crate) fn cells_to_split(
    cells: &[CellId],
    significances: &[f64],
    suspected: &BTreeSet<CellId>,
    [rate, alone]: [f64; 2],
    unshaded: impl Fn(usize) -> bool,
) -> Vec<usize> {
    let is_suspected = |k: usize| cells[k].level > 0 && suspected.contains(&cells[k].ancestor(cells[k].level - 1));
    let mut others = significances.to_vec();
    let (mut children, mut tested) = (Vec::new(), 0.0);
    for k in (0..cells.len()).filter(|k| is_suspected(*k)) {
        tested += f64::from(u8::from(significances[k] < 1.0));
        children.extend((significances[k] <= alone).then_some(k));
        others[k] = 1.0;
    }
    let mut chosen = discoveries(&others, rate);
    chosen.retain(|k| unshaded(*k));
    // twice what chance gives: fewer are no reason for another round
    if !chosen.is_empty() || children.len() as f64 > 2.0 * alone * tested {
        chosen.extend(children);
    }
    chosen.sort_unstable();
    chosen
}

/// Whether no much stronger neighbour explains what a leaf shows: a surface that cannot follow a feature swings about it, less from cell
/// to cell, and the swings are gone when the feature is followed.
pub(crate) fn stands_out(space: &HierarchicalSpace, evidence: &[CellEvidence], leaf: usize, rule: &SplitRule) -> bool {
    let cell = space.leaves()[leaf];
    let reach = i64::from(rule.reach_of_swings);
    let base = space.mesh().tree().base();
    let excess_at = |di: i64, dj: i64| {
        let place = [i64::from(cell.place[0]) + di, i64::from(cell.place[1]) + dj];
        let inside = (0..2).all(|axis| place[axis] >= 0 && place[axis] >> cell.level < base[axis] as i64);
        let neighbour = if inside { space.leaf_of(CellId { place: place.map(|k| k as u32), ..cell }) } else { None };
        neighbour.map_or(0.0, |leaf| evidence[leaf].excess)
    };
    let mut near = (-reach..=reach).flat_map(|di| (-reach..=reach).map(move |dj| (di, dj)));
    near.all(|(di, dj)| evidence[leaf].excess >= rule.shade * excess_at(di, dj))
}

/// The largest set in which at most the share `rate` is expected to be chance.
fn discoveries(significances: &[f64], rate: f64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..significances.len()).filter(|k| significances[*k] <= rate).collect();
    order.sort_by(|a, b| significances[*a].total_cmp(&significances[*b]).then(a.cmp(b)));
    let tested = significances.iter().filter(|p| **p < 1.0).count() as f64;
    let passes = |k: &usize| significances[order[*k]] <= rate * (k + 1) as f64 / tested;
    let count = (0..order.len()).rev().find(passes).map_or(0, |k| k + 1);
    order.truncate(count);
    order.sort_unstable();
    order
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_numeric::draws::Lcg;

    #[test]
    fn chance_is_as_rare_as_it_says() {
        let mut draw = Lcg::new(21);
        let (mut below, trials) = (0, 4000);
        for _ in 0..trials {
            let mut boxes = [[0.0; 3]; 16];
            for k in 0..100 {
                let v = draw.normal();
                add(&mut boxes[k % 16], [1.0, v, v * v]);
            }
            below += usize::from(fisher(&boxes).significance < 0.05);
        }
        // 200 expected, standard deviation 14
        assert!((150..=250).contains(&below), "{below}");
    }

    #[test]
    fn discoveries_step_up() {
        assert_eq!(discoveries(&[0.001, 0.5, 0.02, 0.9, 1.0], 0.05), [0, 2]);
        assert_eq!(discoveries(&[0.02, 0.5, 0.04, 0.9], 0.01), [] as [usize; 0]);
        assert_eq!(discoveries(&[], 0.01), [] as [usize; 0]);
    }

    #[test]
    fn merging_boxes_keeps_their_sums() {
        let boxes: Vec<BoxSums> = (0..16).map(|k| [1.0, k as f64, 0.0]).collect();
        let wide = merged(&boxes, 4);
        assert_eq!(wide[0], [4.0, 0.0 + 1.0 + 4.0 + 5.0, 0.0]);
        assert_eq!(wide[3], [4.0, 10.0 + 11.0 + 14.0 + 15.0, 0.0]);
        assert_eq!(
            [16, 79, 80, 319, 320, 1 << 20].map(|count| finest_side(count, &SplitRule::default())),
            [2, 2, 4, 4, 8, 32]
        );
    }

    #[test]
    fn children_of_a_chosen_cell_stand_by_themselves() {
        let parent = CellId { level: 1, place: [2, 3] };
        let cells: Vec<CellId> = parent.children().into_iter().chain([CellId { level: 0, place: [0, 0] }]).collect();
        let significances = [0.04, 0.2, 0.05, 0.9, 0.04];
        let none = BTreeSet::new();
        assert_eq!(cells_to_split(&cells, &significances, &none, [0.01, 0.05], |_| true), [] as [usize; 0]);
        assert_eq!(cells_to_split(&cells, &significances, &BTreeSet::from([parent]), [0.01, 0.05], |_| true), [0, 2]);
        let many: Vec<CellId> = (0..40).flat_map(|_| parent.children()).collect();
        let significances: Vec<f64> = (0..160).map(|k| if k < 16 { 0.04 } else { 0.3 }).collect();
        assert!(cells_to_split(&many, &significances, &BTreeSet::from([parent]), [0.01, 0.05], |_| true).is_empty());
    }
}
