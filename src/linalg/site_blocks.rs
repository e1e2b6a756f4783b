//! Sites by eights, one a lane: what the kernels over sites take.
//!
//! ```text
//! block   up to eight sites of one knot cell     x[k][a][lane] = N_a^(k), y[k][b][lane] = M_b^(k)     k = 0, 1
//! ```
//!
//! A block never crosses a cell, so its coefficients are the cell's; lanes without a site have no weight.

use super::sites::{Metric, Site, Sites};
use crate::simd::{CellSites, SITES, SiteLanes};

/// Up to eight sites of one cell.
#[derive(Clone, Debug)]
pub struct SiteBlock {
    /// First basis function in x and in y.
    pub first: [usize; 2],
    /// Numbers of the data in the user's order.
    index: [usize; SITES],
    count: usize,
    /// N, N', M, M' one after the other.
    values: Vec<SiteLanes>,
    widths: [usize; 2],
    weights: [SiteLanes; 4],
}

impl SiteBlock {
    /// Room for sites of a spline of these degrees.
    pub fn new(degree: [usize; 2]) -> SiteBlock {
        let widths = degree.map(|d| d + 1);
        SiteBlock {
            first: [0, 0],
            index: [0; SITES],
            count: 0,
            values: vec![[0.0; SITES]; 2 * (widths[0] + widths[1])],
            widths,
            weights: [[0.0; SITES]; 4],
        }
    }

    /// As the kernels want them.
    pub fn lanes(&self) -> CellSites<'_> {
        let (x, y) = self.values.split_at(2 * self.widths[0]);
        let ((x, dx), (y, dy)) = (x.split_at(self.widths[0]), y.split_at(self.widths[1]));
        CellSites { x: [x, dx], y: [y, dy], weights: &self.weights }
    }

    /// Numbers of the block's data in the user's order, lane by lane.
    pub fn indices(&self) -> &[usize] {
        &self.index[..self.count]
    }

    #[inline(always)]
    fn put(&mut self, site: &Site, metric: &Metric) {
        let lane = self.count;
        let m = metric.at(site.index);
        for (row, weight) in self.weights.iter_mut().zip([m.z, m.a, m.b, m.d]) {
            row[lane] = weight;
        }
        let rows = site.x.iter().chain(site.dx).chain(site.y).chain(site.dy);
        self.values.iter_mut().zip(rows).for_each(|(lanes, v)| lanes[lane] = *v);
        (self.index[lane], self.first) = (site.index, site.first);
        self.count += 1;
    }

    fn hand_over(&mut self, f: &mut impl FnMut(&SiteBlock)) {
        if self.count == 0 {
            return;
        }
        self.weights.iter_mut().for_each(|row| row[self.count..].fill(0.0));
        f(self);
        self.count = 0;
    }
}

/// Visits all sites block by block, in the order of [`Sites::visit`]; `block` is what they are put into.
pub fn visit_blocks(sites: &impl Sites, metric: &Metric, block: &mut SiteBlock, mut f: impl FnMut(&SiteBlock)) {
    block.count = 0;
    sites.visit(|site| {
        if block.count == SITES || (block.count > 0 && block.first != site.first) {
            block.hand_over(&mut f);
        }
        site.unrolled(|site| block.put(site, metric));
    });
    block.hand_over(&mut f);
}
