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
    /// Block after block: N, N', M, M', weights.
    values: Vec<SiteLanes>,
    is_complete: bool,
}

#[derive(Clone, Debug)]
struct Head {
    first: [usize; 2],
    count: usize,
    index: [usize; SITES],
}

/// Rows of a block besides its basis values: z, a, b, d.
const WEIGHTS: usize = 4;

impl SiteBlocks {
    /// Room for the sites of one fit.
    pub fn new(sites: &impl Sites) -> SiteBlocks {
        let widths = sites.shape().degree.map(|d| d + 1);
        let room = if sites.len() <= KEPT { sites.len().div_ceil(SITES) } else { 1 };
        let values = Vec::with_capacity(room * (2 * (widths[0] + widths[1]) + WEIGHTS));
        SiteBlocks { widths, heads: Vec::with_capacity(room), values, is_complete: false }
    }

    /// Rows of a block.
    fn each(&self) -> usize {
        2 * (self.widths[0] + self.widths[1]) + WEIGHTS
    }

    /// Visits all sites block by block, in the order of [`Sites::visit`]. Sites and metric are the same at every visit.
    pub fn visit(&mut self, sites: &impl Sites, metric: &Metric, mut f: impl FnMut(&SiteBlock)) {
        if self.is_complete {
            return (0..self.heads.len()).for_each(|k| f(&self.block(k)));
        }
        // loops of known length for the usual degrees: putting a site is little else than its stores
        match self.widths {
            [3, 3] => self.fill::<3>(sites, metric, &mut f),
            [4, 4] => self.fill::<4>(sites, metric, &mut f),
            [5, 5] => self.fill::<5>(sites, metric, &mut f),
            _ => self.fill::<0>(sites, metric, &mut f),
        }
        let keep = sites.len() <= KEPT;
        self.is_complete = keep;
        if !keep {
            self.heads.clear();
        }
    }

    /// The first visit. WIDTH is that of both axes, or 0 for widths that only the sites know.
    fn fill<const WIDTH: usize>(&mut self, sites: &impl Sites, metric: &Metric, f: &mut dyn FnMut(&SiteBlock)) {
        let (keep, columns) = (sites.len() <= KEPT, sites.shape().basis[1]);
        // one number a cell: two at once are read before they are written, where the visit is as fast as its stores
        let mut cell = usize::MAX;
        sites.visit(|site| {
            let own = site.first[0] * columns + site.first[1];
            if own != cell || self.heads.last().is_none_or(|head| head.count == SITES) {
                self.hand_over(f);
                self.open(site.first, keep);
                cell = own;
            }
            self.put(&if WIDTH == 0 { *site } else { site.cut(WIDTH) }, metric);
        });
        self.hand_over(f);
    }

    fn block(&self, k: usize) -> SiteBlock<'_> {
        let (head, each, [p, q]) = (&self.heads[k], self.each(), self.widths);
        let (x, rest) = self.values[k * each..(k + 1) * each].split_at(2 * p);
        let (y, weights) = rest.split_at(2 * q);
        let lanes = CellSites { x: [&x[..p], &x[p..]], y: [&y[..q], &y[q..]], weights };
        SiteBlock { first: head.first, indices: &head.index[..head.count], lanes }
    }

    fn hand_over(&self, f: &mut dyn FnMut(&SiteBlock)) {
        if let Some(last) = self.heads.len().checked_sub(1) {
            f(&self.block(last));
        }
    }

    /// An empty block, without weights: a new one, or in place of the last.
    fn open(&mut self, first: [usize; 2], keep: bool) {
        if !keep {
            self.heads.clear();
            self.values.clear();
        }
        self.heads.push(Head { first, count: 0, index: [0; SITES] });
        self.values.resize(self.values.len() + self.each(), [0.0; SITES]);
    }

    #[inline(always)]
    fn put(&mut self, site: &Site, metric: &Metric) {
        let Some(head) = self.heads.last_mut() else { return };
        // a full block is handed over before the next site comes: the remainder only tells the compiler so
        let lane = head.count % SITES;
        head.index[lane] = site.index;
        head.count += 1;
        let (p, q, m) = (site.x.len(), site.y.len(), metric.at(site.index));
        let start = self.values.len() - (2 * (p + q) + WEIGHTS);
        let rows = &mut self.values[start..][..2 * (p + q) + WEIGHTS];
        for a in 0..p {
            (rows[a][lane], rows[p + a][lane]) = (site.x[a], site.dx[a]);
        }
        for b in 0..q {
            (rows[2 * p + b][lane], rows[2 * p + q + b][lane]) = (site.y[b], site.dy[b]);
        }
        for (k, weight) in [m.z, m.a, m.b, m.d].into_iter().enumerate() {
            rows[2 * (p + q) + k][lane] = weight;
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
                        assert_eq!(column(weights, l), [1.0 + index as f64, 2.0, 3.0, 4.0]);
                    }
                    assert!((block.indices.len()..SITES).all(|l| column(weights, l) == [0.0; 4]));
                });
                assert_eq!(found, expected);
            }
        }
    }
}
