//! Sites by eights, one a lane: what the kernels over sites take.
//!
//! ```text
//! block   up to eight sites of one knot cell     x[k][a][lane] = N_a^(k), y[k][b][lane] = M_b^(k)     k = 0, 1
//! ```
//!
//! A block never crosses a cell, so its coefficients are the cell's; lanes without a site have no weight.

use super::sites::{Metric, Site, Sites};
use crate::simd::{CellSites, SITES, SiteLanes};

/// Up to this many sites the blocks of the first visit are kept for the next (0.7 MB at degree 3); turning rows into
/// lanes takes longer than the arithmetic on them, but more than that no cache holds.
const KEPT: usize = 1 << 12;

/// Up to eight sites of one cell.
#[derive(Clone, Copy, Debug)]
pub struct SiteBlock<'a> {
    /// First basis function in x and in y.
    pub first: [usize; 2],
    /// Numbers of the data in the user's order, lane by lane.
    pub indices: &'a [usize],
    /// As the kernels want them.
    pub lanes: CellSites<'a>,
}

/// Sites put into lanes: all of them where they are few, the latest eight otherwise.
#[derive(Clone, Debug)]
pub struct SiteBlocks {
    widths: [usize; 2],
    heads: Vec<Head>,
    /// Block after block: N, N', M, M'.
    values: Vec<SiteLanes>,
    is_complete: bool,
}

#[derive(Clone, Debug)]
struct Head {
    first: [usize; 2],
    count: usize,
    index: [usize; SITES],
    weights: [SiteLanes; 4],
}

impl SiteBlocks {
    /// Room for the sites of one fit.
    pub fn new(sites: &impl Sites) -> SiteBlocks {
        let widths = sites.shape().degree.map(|d| d + 1);
        let room = if sites.len() <= KEPT { sites.len().div_ceil(SITES) } else { 1 };
        let values = Vec::with_capacity(room * 2 * (widths[0] + widths[1]));
        SiteBlocks { widths, heads: Vec::with_capacity(room), values, is_complete: false }
    }

    /// Visits all sites block by block, in the order of [`Sites::visit`]. Sites and metric are the same at every visit.
    pub fn visit(&mut self, sites: &impl Sites, metric: &Metric, mut f: impl FnMut(&SiteBlock)) {
        if self.is_complete {
            return (0..self.heads.len()).for_each(|k| f(&self.block(k)));
        }
        let keep = sites.len() <= KEPT;
        sites.visit(|site| {
            if self.heads.last().is_none_or(|head| head.count == SITES || head.first != site.first) {
                self.hand_over(&mut f);
                self.open(site.first, keep);
            }
            site.unrolled(|site| self.put(site, metric));
        });
        self.hand_over(&mut f);
        self.is_complete = keep;
        if !keep {
            self.heads.clear();
        }
    }

    fn block(&self, k: usize) -> SiteBlock<'_> {
        let (head, each) = (&self.heads[k], 2 * (self.widths[0] + self.widths[1]));
        let (x, y) = self.values[k * each..(k + 1) * each].split_at(2 * self.widths[0]);
        let ((x, dx), (y, dy)) = (x.split_at(self.widths[0]), y.split_at(self.widths[1]));
        let lanes = CellSites { x: [x, dx], y: [y, dy], weights: &head.weights };
        SiteBlock { first: head.first, indices: &head.index[..head.count], lanes }
    }

    fn hand_over(&self, f: &mut impl FnMut(&SiteBlock)) {
        if let Some(last) = self.heads.len().checked_sub(1) {
            f(&self.block(last));
        }
    }

    /// An empty block, without weights: a new one, or in place of the last.
    fn open(&mut self, first: [usize; 2], keep: bool) {
        let head = Head { first, count: 0, index: [0; SITES], weights: [[0.0; SITES]; 4] };
        if !keep {
            self.heads.clear();
        }
        self.heads.push(head);
        self.values.resize(self.heads.len() * 2 * (self.widths[0] + self.widths[1]), [0.0; SITES]);
    }

    #[inline(always)]
    fn put(&mut self, site: &Site, metric: &Metric) {
        let Some(head) = self.heads.last_mut() else { return };
        let lane = head.count;
        let m = metric.at(site.index);
        for (row, weight) in head.weights.iter_mut().zip([m.z, m.a, m.b, m.d]) {
            row[lane] = weight;
        }
        head.index[lane] = site.index;
        head.count += 1;
        let start = self.values.len() - 2 * (site.x.len() + site.y.len());
        let (x, y) = self.values[start..].split_at_mut(2 * site.x.len());
        let ((x, dx), (y, dy)) = (x.split_at_mut(site.x.len()), y.split_at_mut(site.y.len()));
        for a in 0..site.x.len() {
            (x[a][lane], dx[a][lane]) = (site.x[a], site.dx[a]);
        }
        for b in 0..site.y.len() {
            (y[b][lane], dy[b][lane]) = (site.y[b], site.dy[b]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bspline::Knots;
    use crate::linalg::RowMetric;
    use crate::observation::ScatteredSites;

    /// Every site once, in the order of the plain visit and with its numbers, at the first visit and at the next.
    #[test]
    fn blocks_hold_every_site_in_order() {
        for count in [1, 8, 37, KEPT + 3] {
            let knots = [Knots::uniform(2, 3, 0.0, 1.0).unwrap(), Knots::uniform(3, 2, 0.0, 1.0).unwrap()];
            let place = |k: usize| [(k as f64 * 0.618).fract(), (k as f64 * 0.414).fract()];
            let sites = ScatteredSites::new(knots, (0..count).map(place).collect());
            let weigh = |k: usize| RowMetric { z: 1.0 + k as f64, a: 2.0, b: 3.0, d: 4.0 };
            let metric = Metric::PerSite((0..count).map(weigh).collect());
            let mut expected = Vec::new();
            sites
                .visit(|s| expected.push((s.index, s.first, s.x.to_vec(), s.dx.to_vec(), s.y.to_vec(), s.dy.to_vec())));
            let mut blocks = SiteBlocks::new(&sites);
            for _ in 0..2 {
                let mut found = Vec::new();
                blocks.visit(&sites, &metric, |block| {
                    let column = |rows: &[SiteLanes], l: usize| rows.iter().map(|row| row[l]).collect::<Vec<f64>>();
                    let CellSites { x, y, weights } = block.lanes;
                    for (l, &index) in block.indices.iter().enumerate() {
                        let rows = (column(x[0], l), column(x[1], l), column(y[0], l), column(y[1], l));
                        found.push((index, block.first, rows.0, rows.1, rows.2, rows.3));
                        assert_eq!(weights.map(|w| w[l]), [1.0 + index as f64, 2.0, 3.0, 4.0]);
                    }
                    assert!((block.indices.len()..SITES).all(|l| weights.map(|w| w[l]) == [0.0; 4]));
                });
                assert_eq!(found, expected);
            }
        }
    }
}
