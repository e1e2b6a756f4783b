//! Where contacts support the surface: inside their outline and near enough to one of them.
//!
//! ```text
//! inside the convex hull of the contacts' chart positions (the outline counts, and a little more), and
//! nearest contact within max(3 x 95 % quantile of nearest-neighbour distances, 1.1 x widest gap between cells)
//! ```
//!
//! The widest gap is the largest edge of the cells' minimum spanning tree, at most four times its median edge: the paths of
//! a few fingers are far apart, and what lies between two of them is still the touched surface.

use crate::bodies::Tuning;
use crate::recognition::contacts::Cells;
use crate::recognition::start::thinned;
use palpate_geometry::convex_hull::{convex_hull, turn};
use palpate_geometry::neighbours::Neighbours;
use palpate_numeric::statistics::{median, order_statistic};
use palpate_numeric::vector::{Vector, dot, minus, norm};

/// Contacts whose nearest neighbours are looked up.
const SAMPLE: usize = 4000;

/// The region that contacts support.
#[derive(Clone, Debug)]
pub(super) struct Support<'a> {
    hull: Vec<[f64; 2]>,
    tree: Neighbours<'a>,
    reach: f64,
    beyond: f64,
}

impl<'a> Support<'a> {
    /// Of contacts, by their feet, with their chart positions.
    pub(crate) fn new(feet: &'a [Vector], charts: &[[f64; 2]], cells: &Cells, tuning: &Tuning) -> Support<'a> {
        let tree = Neighbours::new(feet);
        let sample = thinned(feet, SAMPLE);
        let nearest: Vec<f64> = sample.iter().filter_map(|&i| tree.nearest_other(i).map(|(d, _)| d)).collect();
        let rank = nearest.len() * 95 / 100;
        let quantile = order_statistic(nearest, rank).unwrap_or(0.0);
        let reach = (3.0 * quantile).max(1.1 * widest_gap(&cells.feet, tuning.site_from_repeats));
        Support { hull: convex_hull(charts), tree, reach, beyond: tuning.beyond_outline * reach }
    }

    /// The same region, independent of the contacts' lifetime.
    pub(super) fn into_owned(self) -> Support<'static> {
        Support { hull: self.hull, tree: self.tree.into_owned(), reach: self.reach, beyond: self.beyond }
    }

    /// Range of the chart that the contacts cover.
    pub(super) fn range(&self, side: usize) -> [f64; 2] {
        let lo = self.hull.iter().map(|p| p[side]).fold(f64::INFINITY, f64::min);
        let hi = self.hull.iter().map(|p| p[side]).fold(f64::NEG_INFINITY, f64::max);
        [lo, hi]
    }

    /// Whether a chart position, at this place of the surface, is supported.
    pub(super) fn holds(&self, chart: [f64; 2], place: Vector) -> bool {
        let inside = (0..self.hull.len()).all(|i| {
            let (a, b) = (self.hull[i], self.hull[(i + 1) % self.hull.len()]);
            turn(a, b, chart) >= -self.beyond * (b[0] - a[0]).hypot(b[1] - a[1])
        });
        inside && self.tree.nearest(place, 1).first().is_some_and(|(squared, _)| squared.sqrt() <= self.reach)
    }
}

/// Largest edge of the minimum spanning tree (R. C. Prim, 1957), at most four times the median edge, without those of repeats
/// ([`repeats`]).
fn widest_gap(points: &[Vector], sudden: f64) -> f64 {
    let n = points.len();
    let mut nearest = vec![f64::INFINITY; n];
    let mut inside = vec![false; n];
    let mut edges = Vec::with_capacity(n);
    let mut now = 0;
    for _ in 1..n {
        inside[now] = true;
        for i in 0..n {
            let offset = minus(points[i], points[now]);
            nearest[i] = nearest[i].min(dot(offset, offset));
        }
        let outside = (0..n).filter(|&i| !inside[i]);
        let Some(next) = outside.min_by(|&i, &j| nearest[i].total_cmp(&nearest[j])) else { break };
        edges.push(norm([nearest[next].sqrt(), 0.0, 0.0]));
        now = next;
    }
    edges.sort_unstable_by(f64::total_cmp);
    let largest = edges.last().copied().unwrap_or(0.0);
    let between_sites = edges.split_off(repeats(&edges, sudden));
    largest.min(4.0 * median(between_sites).unwrap_or(0.0))
}

/// How many of the edges, shortest first, join touches of one and the same site: those below a growth by more than `sudden`, if they are
/// a third of all and not nearly all.
fn repeats(edges: &[f64], sudden: f64) -> usize {
    let n = edges.len();
    let grows = |k: &usize| edges[*k] > sudden * edges[*k - 1];
    (n.div_ceil(3).max(1)..=n * 9 / 10).filter(|k| *k < n).find(grows).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gap_is_that_between_fingers() {
        let fingers: Vec<Vector> = (0..30).map(|i| [(i % 10) as f64, 3.0 * (i / 10) as f64, 0.0]).collect();
        assert_eq!(widest_gap(&fingers, Tuning::default().site_from_repeats), 3.0);
    }

    /// Every place touched twice, once as exactly as can be and once with noise.
    #[test]
    fn repeats_of_a_site_do_not_narrow_the_gap() {
        let sudden = Tuning::default().site_from_repeats;
        for noise in [0.0, 0.02] {
            let twice: Vec<Vector> =
                (0..36).map(|i| [(i / 2 % 6) as f64 + noise * (i % 2) as f64, 4.0 * (i / 12) as f64, 0.0]).collect();
            assert!((widest_gap(&twice, sudden) - 4.0).abs() < 0.1, "{noise}");
        }
        assert_eq!(repeats(&[1.0; 12], sudden), 0);
    }
}
