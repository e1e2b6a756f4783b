//! Sites by eights, one a lane: what the kernels over sites take.
//!
//! ```text
//! block   up to eight sites of one knot cell     x[k][a][lane] = N_a^(k), y[k][b][lane] = M_b^(k)     k = 0, 1
//!         with their weights z, a, b, d and targets
//! ```
//!
//! A block never crosses a cell, so its coefficients are the cell's; lanes without a site have no weight.

use super::sites::{RowWeights, Sites};
use crate::simd::{CellSites, SITES, SiteLanes};

/// Up to this many sites the blocks of the first visit are kept for the next (0.8 MB at degree 3); turning rows into
/// lanes takes longer than the arithmetic on them, but more than that no cache holds.
const KEPT: usize = 1 << 12;

/// Up to eight sites of one cell.
#[derive(Clone, Copy, Debug)]
pub struct SiteBlock<'a> {
    /// First basis function in x and in y.
    pub first: [usize; 2],
    /// As the kernels want them.
    pub lanes: CellSites<'a>,
    /// Weighted right-hand sides.
    pub targets: [&'a SiteLanes; 3],
}

/// Where the sites are, how they are weighted, towards what: the same at every visit.
#[derive(Clone, Copy, Debug)]
pub struct SiteRows<'a, S> {
    /// Basis rows.
    pub sites: &'a S,
    /// Weights.
    pub row_weights: &'a RowWeights,
    /// Weighted right-hand sides, in the user's order.
    pub targets: &'a [[f64; 3]],
}

/// Sites put into lanes: all of them where they are few, the latest eight otherwise.
#[derive(Clone, Debug)]
pub struct SiteBlocks {
    widths: [usize; 2],
    /// First basis functions, block after block.
    first: Vec<[usize; 2]>,
    /// Block after block: N, N', M, M', weights, targets.
    values: Vec<SiteLanes>,
    is_complete: bool,
}

/// Rows of a block besides its basis values: z, a, b, d and the three targets.
const BESIDES: usize = 7;

/// Numbers of eight sites, number by number: eight loads and one store at a time.
fn turned([a, b, c, d, e, f, g, h]: [&[f64]; SITES]) -> impl Iterator<Item = SiteLanes> {
    let of = a.iter().zip(b).zip(c).zip(d).zip(e).zip(f).zip(g).zip(h);
    of.map(|(((((((a, b), c), d), e), f), g), h)| [*a, *b, *c, *d, *e, *f, *g, *h])
}

/// Up to eight sites of one cell as they come, site after site.
#[derive(Default)]
struct Waiting {
    first: [usize; 2],
    numbers: Vec<u32>,
    rows: Vec<f64>,
}

impl SiteBlocks {
    /// Room for the sites of one fit.
    pub fn new(sites: &impl Sites) -> SiteBlocks {
        let widths = sites.shape().degree.map(|d| d + 1);
        let room = if sites.len() <= KEPT { sites.len().div_ceil(SITES) } else { 1 };
        let values = Vec::with_capacity(room * (2 * (widths[0] + widths[1]) + BESIDES));
        SiteBlocks { widths, first: Vec::with_capacity(room), values, is_complete: false }
    }

    /// Rows of a block.
    fn each(&self) -> usize {
        2 * (self.widths[0] + self.widths[1]) + BESIDES
    }

    /// Visits all sites block by block, in the order of [`Sites::visit`].
    pub fn visit<S: Sites>(&mut self, rows: &SiteRows<S>, mut f: impl FnMut(&SiteBlock)) {
        if !self.is_complete {
            let keep = rows.sites.len() <= KEPT;
            // blocks that are kept are all put before the first is visited: a number is not read while it is written
            self.fill(rows, &mut |blocks| {
                if !keep {
                    f(&blocks.block(0));
                    blocks.first.clear();
                    blocks.values.clear();
                }
            });
            self.is_complete = keep;
        }
        (0..self.first.len()).for_each(|k| f(&self.block(k)));
    }

    /// Puts all sites into blocks and says so after each.
    fn fill(&mut self, rows: &SiteRows<impl Sites>, done: &mut dyn FnMut(&mut SiteBlocks)) {
        let mut turn = |first: [usize; 2], numbers: &[u32], values: &[f64]| {
            let Some(each) = values.len().checked_div(numbers.len()) else { return };
            for (numbers, values) in numbers.chunks(SITES).zip(values.chunks(SITES * each)) {
                self.turn(first, numbers, values, rows);
                done(self);
            }
        };
        if rows.sites.visit_cells(&mut turn) {
            return;
        }
        let mut waiting = Waiting::default();
        rows.sites.visit(|site| {
            if waiting.numbers.len() == SITES || waiting.first != site.first {
                turn(waiting.first, &waiting.numbers, &waiting.rows);
                waiting.numbers.clear();
                waiting.rows.clear();
            }
            waiting.first = site.first;
            waiting.numbers.push(site.index as u32);
            [site.x, site.dx, site.y, site.dy].iter().for_each(|values| waiting.rows.extend_from_slice(values));
        });
        turn(waiting.first, &waiting.numbers, &waiting.rows);
    }

    /// Up to eight sites become the lanes of a block, number by number of theirs: eight are one store.
    fn turn(&mut self, first: [usize; 2], numbers: &[u32], values: &[f64], rows: &SiteRows<impl Sites>) {
        let each = values.len() / numbers.len();
        // lanes without a site repeat the last, without weight and target
        let last = numbers.len() - 1;
        self.values.extend(turned(std::array::from_fn(|lane| &values[lane.min(last) * each..][..each])));
        let mut of = [[0.0; BESIDES]; SITES];
        for (of, &number) in of.iter_mut().zip(numbers) {
            let (m, [z, x, y]) = (rows.row_weights.at(number as usize), rows.targets[number as usize]);
            *of = [m.z, m.a, m.b, m.d, z, x, y];
        }
        self.values.extend(turned(of.each_ref().map(|of| &of[..])));
        self.first.push(first);
    }

    fn block(&self, k: usize) -> SiteBlock<'_> {
        let (each, [p, q]) = (self.each(), self.widths);
        let (x, rest) = self.values[k * each..(k + 1) * each].split_at(2 * p);
        let (y, rest) = rest.split_at(2 * q);
        let (weights, targets) = rest.split_at(4);
        let lanes = CellSites { x: [&x[..p], &x[p..]], y: [&y[..q], &y[q..]], weights };
        SiteBlock { first: self.first[k], lanes, targets: [&targets[0], &targets[1], &targets[2]] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bspline::Knots;
    use crate::linalg::{Site, SiteWeights, TensorShape};
    use crate::observation::ScatteredSites;

    /// Sites that come one by one only.
    struct Single(ScatteredSites);

    impl Sites for Single {
        fn shape(&self) -> TensorShape {
            self.0.shape()
        }
        fn len(&self) -> usize {
            self.0.len()
        }
        fn visit(&self, f: impl FnMut(&Site)) {
            self.0.visit(f);
        }
    }

    #[test]
    fn blocks_hold_every_site_in_order() {
        for count in [0, 1, 8, 37, KEPT + 3] {
            let knots = [Knots::uniform(2, 3, 0.0, 1.0).unwrap(), Knots::uniform(3, 2, 0.0, 1.0).unwrap()];
            // none in the first cells
            let place = |k: usize| [0.4 + 0.6 * (k as f64 * 0.618).fract(), (k as f64 * 0.414).fract()];
            let sites = ScatteredSites::new(knots, (0..count).map(place).collect());
            compare(&sites);
            compare(&Single(sites));
        }
    }

    /// Every site once, in the order of the plain visit and with its numbers, at the first visit and at the next.
    fn compare(sites: &impl Sites) {
        let count = sites.len();
        let weigh = |k: usize| SiteWeights { z: 1.0 + k as f64, a: 2.0, b: 3.0, d: 4.0 };
        let row_weights = RowWeights::PerSite((0..count).map(weigh).collect());
        let targets: Vec<[f64; 3]> = (0..count).map(|k| [k as f64, -1.0, k as f64 + 0.5]).collect();
        let rows = SiteRows { sites, row_weights: &row_weights, targets: &targets };
        let mut expected = Vec::new();
        sites.visit(|s| expected.push((s.index, s.first, s.x.to_vec(), s.dx.to_vec(), s.y.to_vec(), s.dy.to_vec())));
        let mut blocks = SiteBlocks::new(sites);
        for _ in 0..2 {
            let mut found = Vec::new();
            blocks.visit(&rows, |block| {
                let column = |rows: &[SiteLanes], l: usize| rows.iter().map(|row| row[l]).collect::<Vec<f64>>();
                let CellSites { x, y, weights } = block.lanes;
                let live = (0..SITES).take_while(|l| weights[0][*l] != 0.0).count();
                for l in 0..live {
                    let index = block.targets[0][l] as usize;
                    let rows = (column(x[0], l), column(x[1], l), column(y[0], l), column(y[1], l));
                    found.push((index, block.first, rows.0, rows.1, rows.2, rows.3));
                    assert_eq!(column(weights, l), [1.0 + index as f64, 2.0, 3.0, 4.0]);
                    assert_eq!(block.targets.map(|target| target[l]), targets[index]);
                }
                assert!((live..SITES).all(|l| column(weights, l) == [0.0; 4] && block.targets[0][l] == 0.0));
            });
            assert_eq!(found, expected);
        }
    }
}
