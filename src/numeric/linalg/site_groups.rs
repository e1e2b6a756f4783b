//! Sites in groups of eight, one site in each SIMD lane, as the kernels over sites take them.
//!
//! ```text
//! group   up to eight sites of one knot cell     x[k][a][lane] = N_a^(k), y[k][b][lane] = M_b^(k)     k = 0, 1
//!         with their weights z, a, b, d and targets
//! ```
//!
//! All sites of a group lie in the same cell, so they share its coefficients. Lanes without a site have weight zero.

use super::sites::{RowWeights, Sites};
use crate::simd::{CellSites, SITES, SiteLanes};

/// Up to this many sites the groups made at the first visit are kept for the next (0.8 MB at degree 3). Transposing rows
/// into lanes takes longer than the arithmetic on them, so keeping them pays as long as the caches hold them.
pub const KEPT: usize = 1 << 12;

/// Up to eight sites of one cell.
#[derive(Clone, Copy, Debug)]
pub struct SiteGroup<'a> {
    /// First basis function in x and in y.
    pub first: [usize; 2],
    /// Basis values and weights in the layout of the kernels.
    pub sites: CellSites<'a>,
    /// Weighted right-hand sides.
    pub targets: [&'a SiteLanes; 3],
}

/// Sites, their weights and their right-hand sides; they must be the same at every visit.
#[derive(Clone, Copy, Debug)]
pub struct SiteRows<'a, S> {
    /// Basis rows.
    pub sites: &'a S,
    /// Weights.
    pub row_weights: &'a RowWeights,
    /// Weighted right-hand sides, in the user's order.
    pub targets: &'a [[f64; 3]],
}

/// Buffers for groups of sites: for all groups if the sites are few, otherwise for the current group only.
#[derive(Clone, Debug)]
pub struct SiteGroups {
    widths: [usize; 2],
    /// First basis functions of every group.
    first: Vec<[usize; 2]>,
    /// Group after group: N, N', M, M', weights, targets.
    values: Vec<SiteLanes>,
    is_complete: bool,
}

/// Rows of a group besides its basis values: z, a, b, d and the three targets.
const BESIDES: usize = 7;

/// Transposes eight slices: item k holds entry k of each. Each item is eight loads and one store.
fn transposed([a, b, c, d, e, f, g, h]: [&[f64]; SITES]) -> impl Iterator<Item = SiteLanes> {
    let of = a.iter().zip(b).zip(c).zip(d).zip(e).zip(f).zip(g).zip(h);
    of.map(|(((((((a, b), c), d), e), f), g), h)| [*a, *b, *c, *d, *e, *f, *g, *h])
}

/// Up to eight sites of one cell that wait to become a group, in the order of the visit.
#[derive(Default)]
struct Waiting {
    first: [usize; 2],
    numbers: Vec<u32>,
    rows: Vec<f64>,
}

impl SiteGroups {
    /// Room for the sites of one fit.
    pub fn new(sites: &impl Sites) -> SiteGroups {
        let widths = sites.shape().degree.map(|d| d + 1);
        let room = if sites.len() <= KEPT { sites.len().div_ceil(SITES) } else { 1 };
        let values = Vec::with_capacity(room * (2 * (widths[0] + widths[1]) + BESIDES));
        SiteGroups { widths, first: Vec::with_capacity(room), values, is_complete: false }
    }

    /// Number of rows of a group.
    fn each(&self) -> usize {
        2 * (self.widths[0] + self.widths[1]) + BESIDES
    }

    /// Visits all sites group by group, in the order of [`Sites::visit`].
    pub fn visit<S: Sites>(&mut self, rows: &SiteRows<S>, mut f: impl FnMut(&SiteGroup)) {
        if !self.is_complete {
            let keep = rows.sites.len() <= KEPT;
            // all kept groups are made before the first is visited, so that no number is read soon after it was written
            self.fill(rows, &mut |groups| {
                if !keep {
                    f(&groups.group(0));
                    groups.first.clear();
                    groups.values.clear();
                }
            });
            self.is_complete = keep;
        }
        (0..self.first.len()).for_each(|k| f(&self.group(k)));
    }

    /// Packs all sites into groups and calls `done` after each group.
    fn fill(&mut self, rows: &SiteRows<impl Sites>, done: &mut dyn FnMut(&mut SiteGroups)) {
        let mut pack = |first: [usize; 2], numbers: &[u32], values: &[f64]| {
            let Some(each) = values.len().checked_div(numbers.len()) else { return };
            for (numbers, values) in numbers.chunks(SITES).zip(values.chunks(SITES * each)) {
                self.pack(first, numbers, values, rows);
                done(self);
            }
        };
        if rows.sites.visit_cells(&mut pack) {
            return;
        }
        let mut waiting = Waiting::default();
        rows.sites.visit(|site| {
            if waiting.numbers.len() == SITES || waiting.first != site.first {
                pack(waiting.first, &waiting.numbers, &waiting.rows);
                waiting.numbers.clear();
                waiting.rows.clear();
            }
            waiting.first = site.first;
            waiting.numbers.push(site.index as u32);
            [site.x, site.dx, site.y, site.dy].iter().for_each(|values| waiting.rows.extend_from_slice(values));
        });
        pack(waiting.first, &waiting.numbers, &waiting.rows);
    }

    /// Adds a group of up to eight sites by transposing their rows, so that the eight values of a row are one store.
    fn pack(&mut self, first: [usize; 2], numbers: &[u32], values: &[f64], rows: &SiteRows<impl Sites>) {
        let each = values.len() / numbers.len();
        // lanes without a site repeat the last site, with weight and target zero
        let last = numbers.len() - 1;
        self.values.extend(transposed(std::array::from_fn(|lane| &values[lane.min(last) * each..][..each])));
        let mut of = [[0.0; BESIDES]; SITES];
        for (of, &number) in of.iter_mut().zip(numbers) {
            let (w, [z, x, y]) = (rows.row_weights.at(number as usize), rows.targets[number as usize]);
            *of = [w.z, w.a, w.b, w.d, z, x, y];
        }
        self.values.extend(transposed(of.each_ref().map(|of| &of[..])));
        self.first.push(first);
    }

    fn group(&self, k: usize) -> SiteGroup<'_> {
        let (each, [p, q]) = (self.each(), self.widths);
        let (x, rest) = self.values[k * each..(k + 1) * each].split_at(2 * p);
        let (y, rest) = rest.split_at(2 * q);
        let (weights, targets) = rest.split_at(4);
        let sites = CellSites { x: [&x[..p], &x[p..]], y: [&y[..q], &y[q..]], weights };
        SiteGroup { first: self.first[k], sites, targets: [&targets[0], &targets[1], &targets[2]] }
    }
}
